"""A scenario as data: the road, ego, obstacles and their prediction.

Lengths are metres, times seconds, speeds m/s, accelerations m/s². ``s`` runs along the road in
ego's direction, ``d`` across it, positive to the left.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Literal, get_args

from rulec.diagnostics import SourceLocation
from rulec.diagnostics.argument_kinds import expected_fields, finite
from rulec.scenario.geometry import Box, centred
from rulec.scenario.motion_bounds import MotionBounds
from rulec.value_display import short_repr
from rulec.vocabulary.partial_values import PartialValue

if TYPE_CHECKING:
    # NumPy, 80 ms: scenarios in TOML do without.
    from rulec.recordings.recording import Recording

Surface = Literal["carriageway", "crossing"]
SURFACES: tuple[Surface, ...] = get_args(Surface)

Interval = tuple[float, float]
SignalValue = PartialValue
"""A value, an interval, or the mark of an unknown value."""

PEDESTRIAN = "pedestrian"

Prediction = Literal["recorded", "constant"]
PREDICTIONS: tuple[Prediction, ...] = get_args(Prediction)

CONGESTED_BELOW_KMH = 30.0
"""Traffic counts as congested if the median speed (km/h) of its vehicles is below this."""


@dataclass(frozen=True, slots=True)
class Stretch:
    """A surface that covers the whole width of the road from ``s[0]`` to ``s[1]``."""

    surface: Surface
    s: Interval


@dataclass(frozen=True, slots=True)
class MissingLane:
    """A stretch on which a lane (numbered from the right from 1) does not exist."""

    lane: int
    s: Interval


@dataclass(frozen=True, slots=True)
class Road:
    """A road of lanes side by side.

    ``s`` is its extent, ``lanes`` are the bounds of its lanes in ``d`` from right to left: one more
    than there are lanes. Where no stretch names a surface it is carriageway.
    """

    s: Interval
    lanes: tuple[float, ...]
    surfaces: tuple[Stretch, ...] = ()
    missing: tuple[MissingLane, ...] = ()

    @property
    def outline(self) -> Box:
        """The rectangle from end to end, between the outer bounds."""
        return Box(*self.s, self.lanes[0], self.lanes[-1])

    def holes(self) -> tuple[Box, ...]:
        """The rectangles between the outer bounds that are not road."""
        return tuple(
            Box(*gap.s, self.lanes[gap.lane - 1], self.lanes[gap.lane]) for gap in self.missing
        )


@dataclass(frozen=True, slots=True)
class ConstantAcceleration:
    """Motion of a centre with constant acceleration along the road, from time 0 on.

    A negative ``speed`` is oncoming traffic. An obstacle that brakes to a standstill stays there
    and does not reverse; that ends its sideways motion too. From standstill it sets off only with a
    positive acceleration. ``lateral_speed`` is constant, up to ``until_d`` if that is given.
    """

    s: float
    d: float
    speed: float = 0.0
    acceleration: float = 0.0
    lateral_speed: float = 0.0
    until_d: float | None = None


@dataclass(frozen=True, slots=True)
class Trajectory:
    """Timed positions ``(t, s, d)`` of a centre, with straight lines in between.

    The obstacle does not exist before the first and after the last one.
    """

    points: tuple[tuple[float, float, float], ...]


@dataclass(frozen=True, slots=True)
class Footprints:
    """Bounding boxes at ascending times, interpolated linearly in between.

    None where the obstacle is not near the road. It does not exist before the first time and after
    the last one. Unlike a trajectory's, its extent may change, as when a vehicle turns.
    """

    times: tuple[float, ...]
    boxes: tuple[Box | None, ...]


Motion = ConstantAcceleration | Trajectory | Footprints


@dataclass(frozen=True, slots=True)
class Alternative:
    """A less likely motion of an obstacle, with its probability."""

    weight: Fraction
    motion: Motion


@dataclass(frozen=True, slots=True)
class Obstacle:
    """Another traffic participant: a rectangle along the road that moves by a prediction.

    ``motion`` is the likeliest one, with probability ``weight``; the ``alternatives`` have the
    rest. ``broader`` are increasingly general words for its type, for rulebooks that lack it.
    ``length`` and ``width`` are used where the motion is that of a centre. ``walking_direction`` is
    in degrees from ego's direction, counter-clockwise: 90 is to the left.
    """

    id: str
    type: str
    length: float
    width: float
    motion: Motion
    walking_direction: float | None = None
    signals: Mapping[str, SignalValue] = field(default_factory=dict)
    broader: tuple[str, ...] = ()
    weight: Fraction = Fraction(1)
    alternatives: tuple[Alternative, ...] = ()

    @property
    def walks(self) -> bool:
        """Whether its regions are in its own frame, like pedestrians' (the paper, II-B)."""
        return self.type == PEDESTRIAN or self.walking_direction is not None


@dataclass(frozen=True, slots=True)
class Ego:
    """Ego's centre at time 0, with its size, speed (m/s) and the bounds of its motion.

    The size only decides whether ego starts inside an obstacle; where a body is needed and the size
    is 0, that of the bounds is used. ``speed`` None is unknown; without ``bounds`` ego may be
    anywhere at any moment.
    """

    s: float
    d: float
    length: float = 0.0
    width: float = 0.0
    speed: float | None = None
    lateral_speed: float = 0.0
    bounds: MotionBounds | None = None

    @property
    def body(self) -> Box:
        """The rectangle of ego at time 0, a point if its size is unknown."""
        return centred(self.s, self.d, self.length, self.width)


@dataclass(frozen=True, slots=True)
class Account:
    """How a scenario was made from a recorded scene.

    ``left_out`` of the file's ``recorded`` obstacles are never on the road of ``reference``, the
    lanelet ego starts from. ``until_s`` is when the recording ends; participants present then
    continue as before. ``derived`` explains each derived signal, ``remarks`` what the file leaves
    open and what is assumed. ``map_ends``: whether the map ends ahead of ego, and ego gets there at
    its speed at the end of the horizon or soon after. A ``mirrored`` scene has left and right
    exchanged. ``source`` is the recording that it was read from, ``origin`` its road in that
    recording (``recorded.scene_origin.SceneOrigin``), None unless the others move as recorded.
    """

    reference: str
    recorded: int
    left_out: int
    until_s: float
    derived: Mapping[str, str]
    remarks: tuple[str, ...] = ()
    map_ends: bool = False
    mirrored: bool = False
    source: SceneSource | None = field(default=None, compare=False, repr=False)
    origin: object = field(default=None, compare=False, repr=False)


USUAL_HORIZON_S = 4.0


@dataclass(frozen=True, slots=True)
class Scenario:
    """A scene and its prediction: everything that a partition is computed from.

    ``signals`` hold in every state. ``goal`` is a region that a maneuver has to reach; None allows
    every cell of the last layer. ``account`` is given if the scene was recorded: then signals and
    types that a rulebook does not know are no mistake, ``step_s`` is only an upper limit, and, if
    the map ends, so is ``horizon_s``. ``places`` maps (signal, obstacle id) to its place in the
    file, with an empty signal for the obstacle's type and an empty id for signals of the scene.
    """

    __repr__ = short_repr

    name: str
    road: Road
    ego: Ego
    obstacles: tuple[Obstacle, ...] = ()
    signals: Mapping[str, SignalValue] = field(default_factory=dict)
    goal: Box | None = None
    horizon_s: float = USUAL_HORIZON_S
    step_s: float = 1.0
    about: str = ""
    account: Account | None = None
    places: Mapping[tuple[str, str], SourceLocation] = field(
        default_factory=dict, compare=False, repr=False
    )


@dataclass(frozen=True, slots=True)
class Choice:
    """A choice of ego, time, road and prediction in a recorded scene.

    ``ego``: a planning problem or a participant; None is the first planning problem. ``at_s``: the
    time of the file that becomes time 0; None is the planning problem's, or the participant's
    first. ``reference``: the lanelet whose centre line is the reference line; None is the one ego
    is on. ``prediction``: others move as recorded, or from time 0 on with constant acceleration; a
    mapping gives each of these two a probability. ``congested_below_kmh`` is the median speed below
    which traffic is congested. ``ego_width_m``: None is the width of the participant that ego
    replaces, if any; else ego is a point. ``map_path``, ``input_format``, ``scenario_id`` and
    ``frame_rate`` are those of a ``RecordingSource``. Ids are those of the file, or numbers.
    """

    ego: str | int | None = None
    at_s: float | None = None
    reference: str | int | None = None
    prediction: Prediction | Mapping[Prediction, Fraction] = "recorded"
    congested_below_kmh: float = CONGESTED_BELOW_KMH
    map_path: Path | None = None
    input_format: str | None = None
    scenario_id: str | None = None
    ego_width_m: float | None = None
    frame_rate: float | None = None

    def __post_init__(self) -> None:
        expected_fields(self)
        for name in ("at_s", "congested_below_kmh", "ego_width_m"):
            finite(name, getattr(self, name))


@dataclass(frozen=True, eq=False, slots=True)
class SceneSource:
    """The recording that a scene is read from, with what was chosen in it and its file's name."""

    recording: Recording
    choice: Choice
    file: str


_ROUNDING = Fraction(1, 1000)


def weighted(motions: Iterable[Alternative]) -> list[Alternative]:
    """Motions by descending weight, normalised to probabilities, equal ones merged.

    Equally likely ones keep their order.
    """
    together: dict[Motion, Fraction] = {}
    for alternative in motions:
        weight = together.get(alternative.motion, Fraction(0))
        together[alternative.motion] = weight + alternative.weight
    whole = sum(together.values(), Fraction(0))
    by_weight = sorted(together.items(), key=lambda item: -item[1])
    return [Alternative(weight / whole, motion) for motion, weight in by_weight]


def is_distribution(total: Fraction) -> bool:
    """Whether weights add up to 1 within rounding, as three times 0.333 does."""
    return abs(total - 1) <= _ROUNDING
