"""The fields of a scenario file: names, types, bounds and descriptions.

The descriptions become the "expected" part of messages; ``docs/scenarios.md`` has the same at
length. The bounds also exclude NaN and infinity.
"""

from __future__ import annotations

from typing import Annotated, Any

from msgspec import Meta, Struct

from rulec.scenario.scenario_model import SURFACES, Surface

FARTHEST_M = 1_000_000
MOST_OBSTACLES = 500
MOST_STRETCHES = 500
"""The most surfaces of a road, and missing stretches: each is compared with all others."""
_Metres = Annotated[float, Meta(ge=-FARTHEST_M, le=FARTHEST_M)]
_Speed = Annotated[float, Meta(ge=-1000, le=1000)]
_PRINTABLE = r"^[^\x00-\x1f\x7f]+$"
_IDENTIFIER = r"^[A-Za-z_][A-Za-z0-9_]*$"

NameField = Annotated[
    str, Meta(max_length=200, pattern=_PRINTABLE, description="a name in quotes, on one line")
]
TextField = Annotated[str, Meta(description="a text in quotes")]
TypeField = Annotated[
    str,
    Meta(
        max_length=200,
        pattern=_IDENTIFIER,
        description='a type of traffic participant in quotes, such as `"vehicle"`',
    ),
]
Seconds = Annotated[
    float, Meta(gt=0, le=100_000, description="seconds, above 0 and at most 100000")
]
PositionField = Annotated[_Metres, Meta(description="a place along the road, in metres")]
OffsetField = Annotated[_Metres, Meta(description="an offset in metres, positive to the left")]
IntervalField = Annotated[
    tuple[_Metres, _Metres],
    Meta(description="two numbers in metres, from and to, such as `[30.0, 34.0]`"),
]
SizeField = Annotated[float, Meta(ge=0.01, le=1000, description="metres, from 0.01 to 1000")]
AlongSpeed = Annotated[
    _Speed, Meta(description="m/s along the road, negative for oncoming traffic, at most 1000")
]
EgoSpeed = Annotated[float, Meta(ge=0, le=1000, description="m/s along the road, from 0 to 1000")]
Acceleration = Annotated[_Speed, Meta(description="m/s² along the road, at most 1000")]
SidewaysSpeed = Annotated[_Speed, Meta(description="m/s to the left, at most 1000")]
Degrees = Annotated[
    float, Meta(ge=-360, le=360, description="degrees from ego's direction, 90 being to the left")
]
LaneNumber = Annotated[
    int, Meta(ge=1, le=100, description="a lane's number, counted from the right, from 1")
]
LaneBounds = Annotated[
    list[_Metres],
    Meta(
        min_length=2,
        max_length=101,
        description="the lanes' bounds in d (metres) from right to left, one number more than "
        "there are lanes, such as `[-1.75, 1.75, 5.25]`",
    ),
]
SurfaceName = Annotated[Surface, Meta(description=f"one of {', '.join(SURFACES)}, in quotes")]
TimedPositions = Annotated[
    list[tuple[Annotated[float, Meta(ge=-100_000, le=100_000)], _Metres, _Metres]],
    Meta(min_length=1, description="a list of `[t, s, d]` in seconds and metres"),
]
TableField = Annotated[dict[str, Any], Meta(description="a table")]
StretchesField = Annotated[
    list[Any],
    Meta(max_length=MOST_STRETCHES, description=f"at most {MOST_STRETCHES} tables of a kind"),
]
ObstaclesField = Annotated[
    list[Any],
    Meta(max_length=MOST_OBSTACLES, description=f"at most {MOST_OBSTACLES} `[[obstacle]]`"),
]
WeightField = Annotated[
    float, Meta(gt=0, le=1, description="a probability, above 0 and at most 1, such as `0.7`")
]
MOST_PREDICTIONS = 10
PredictionsField = Annotated[
    list[Any],
    Meta(
        max_length=MOST_PREDICTIONS,
        description=f"at most {MOST_PREDICTIONS} `[[obstacle.prediction]]`",
    ),
]


class RawScenario(Struct):
    """The top of the file; its tables are read one by one."""

    road: TableField
    ego: TableField
    name: NameField = ""
    about: TextField = ""
    horizon_s: Seconds = 4.0
    step_s: Seconds = 1.0
    obstacle: ObstaclesField = []
    signals: TableField = {}
    goal: TableField | None = None


class RawRoad(Struct):
    """``[road]``."""

    s: IntervalField
    lanes: LaneBounds
    surface: StretchesField = []
    missing: StretchesField = []


class RawSurface(Struct):
    """``[[road.surface]]``."""

    type: SurfaceName
    s: IntervalField


class RawMissing(Struct):
    """``[[road.missing]]``."""

    lane: LaneNumber
    s: IntervalField


class RawEgo(Struct):
    """``[ego]``."""

    s: PositionField
    d: OffsetField
    length: SizeField | None = None
    width: SizeField | None = None
    speed: EgoSpeed | None = None
    lateral_speed: SidewaysSpeed = 0.0
    bounds: TextField | None = None


class RawGoal(Struct):
    """``[goal]``."""

    s: IntervalField | None = None
    d: IntervalField | None = None


class RawObstacle(Struct):
    """``[[obstacle]]``."""

    id: NameField
    type: TypeField
    length: SizeField
    width: SizeField
    s: PositionField | None = None
    d: OffsetField | None = None
    speed: AlongSpeed = 0.0
    acceleration: Acceleration = 0.0
    lateral_speed: SidewaysSpeed = 0.0
    until_d: OffsetField | None = None
    trajectory: TimedPositions | None = None
    walking_direction: Degrees | None = None
    signals: TableField = {}
    prediction: PredictionsField = []


class RawPrediction(Struct):
    """``[[obstacle.prediction]]``: fields that are left out are taken from the obstacle."""

    weight: WeightField
    speed: AlongSpeed | None = None
    acceleration: Acceleration | None = None
    lateral_speed: SidewaysSpeed | None = None
    until_d: OffsetField | None = None
    trajectory: TimedPositions | None = None
