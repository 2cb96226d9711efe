"""A recording of traffic as data: lanelets, participants, planning problems.

Positions are in the file's own frame, x and y in metres; angles are radians, counter-clockwise.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from decimal import Decimal
from types import MappingProxyType
from typing import Literal, NamedTuple

from numpy import float64
from numpy.typing import NDArray

from rulec.value_display import short_repr

Points = NDArray[float64]
"""Positions: one row each, x and y."""

_RATES = 1000
"""The most frames per second of which a step is taken to be one."""

_FEWEST_DIGITS = 5
"""Steps with fewer digits are taken as they are written."""

_NOISE = 4
"""By how many neighbouring floats a sum or a quotient of a few floats may be off."""

LONGEST_M = 20_000.0
"""The longest lanelet; a typing error that makes one much longer would exhaust memory."""

MOST_STEPS = 1_000_000
"""The most time steps of a recording: more than a day at 0.1 s."""

SPARSEST = 1000
"""A file has at least one in so many time steps; otherwise one of its times is wrong."""

Side = Literal["left", "right"]
LaneMark = Literal["solid", "double_solid", "broken", "none"]
Lamp = Literal[
    "left_indicator",
    "right_indicator",
    "hazard_lights",
    "brake_light",
    "blue_light",
    "horn",
    "doors",
    "left_doors",
    "right_doors",
    "dipped_beam",
    "main_beam",
    "front_fog_lamp",
    "rear_fog_lamp",
]
"""What a vehicle shows to others: its lamps, its horn, and open doors.

``doors`` are open on any side; where a source tells on which, also those of that side are.
"""


def id_order(identifier: str) -> tuple[int, str]:
    """A sort key for ids that sorts numbers numerically."""
    return len(identifier), identifier


_VEHICLE = ("vehicle", "road_user", "obstacle")
_RIDER = ("light_rider", "vulnerable_user", "road_user", "obstacle")
OBSTACLE_TYPES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        **dict.fromkeys(("car", "taxi"), ("car", *_VEHICLE)),
        "truck": ("truck", *_VEHICLE),
        "bus": ("bus", *_VEHICLE),
        "motorcycle": ("motorcycle", *_VEHICLE),
        "priorityVehicle": ("emergency_vehicle", *_VEHICLE),
        **dict.fromkeys(("vehicle", "parkedVehicle"), _VEHICLE),
        "bicycle": ("cyclist", *_RIDER),
        "rider": _RIDER,
        "pedestrian": ("pedestrian", "vulnerable_user", "road_user", "obstacle"),
        "train": ("train", "rail_vehicle", "rail_borne", "road_user", "obstacle"),
        "unknown": ("road_user", "obstacle"),
        **dict.fromkeys(("constructionZone", "roadBoundary", "building"), ("obstacle",)),
        **dict.fromkeys(("pillar", "median_strip", "object"), ("obstacle",)),
    }
)
"""Types of participants -> object types of vocabularies, the most specific one first.

They are CommonRoad's obstacle types, and a vehicle, a rider and an object of unknown type.

A rulebook that does not distinguish cars from other vehicles judges a car as a vehicle. What is not
a road user is at most an obstacle; a rulebook without that type has no rule about it, but it is in
the way nevertheless.
"""


LIGHT_COLOURS = ("red", "redYellow", "yellow", "green", "inactive")
"""What a traffic light can show, in CommonRoad's words."""


@dataclass(frozen=True, slots=True)
class Light:
    """A traffic light's programme from a step on: colours with durations in time steps."""

    begin: int
    phases: tuple[tuple[str, int], ...]

    def colour_at(self, step: int) -> str:
        """Its colour at a time step."""
        left = (step - self.begin) % sum(duration for _, duration in self.phases)
        for colour, duration in self.phases:
            if left < duration:
                return colour
            left -= duration
        raise AssertionError("a remainder is smaller than what it is the remainder of")


@dataclass(frozen=True, slots=True)
class ObservedLight:
    """The observed colours of a traffic light by time step; steps without a colour are missing.

    ``seen``: it exists. Otherwise the file does not say whether it does.
    """

    __repr__ = short_repr

    colours: Mapping[int, str]
    seen: bool = True

    def colour_at(self, step: int) -> str:
        """Its colour at a time step; empty if unknown."""
        return self.colours.get(step, "")


def is_there(light: Light | ObservedLight) -> bool:
    """False if the file does not say whether such a light exists."""
    return isinstance(light, Light) or light.seen


@dataclass(frozen=True, slots=True, kw_only=True)
class Lanelet:
    """A piece of a lane, with its bounds in the direction of travel.

    ``left_of`` and ``right_of`` are the lanelets beside it that lead the same way. ``signs`` are
    the names of those that apply here, ``untold_signs`` of those that may apply; ``lights`` are
    those with a programme or an observation, ``lights_to`` the light for each successor that has
    its own. Marks are those of its bounds; ``stop_line`` (two ends) is the one drawn in the map;
    None if the file does not say. ``junction`` is the one that it lies in. Of the paths through
    that junction, ``foes`` are those whose traffic conflicts with its own, and ``first`` those of
    them that have priority; None if unknown. ``minimum_mps`` is the minimum speed required by
    signs.
    """

    __repr__ = short_repr

    id: str
    left: Points
    right: Points
    centre: Points
    successors: tuple[str, ...] = ()
    predecessors: tuple[str, ...] = ()
    left_of: str | None = None
    right_of: str | None = None
    types: frozenset[str] = frozenset()
    signs: frozenset[str] = frozenset()
    limit_mps: float | None = None
    untold_signs: frozenset[str] = frozenset()
    lights: tuple[Light | ObservedLight, ...] = ()
    lights_to: Mapping[str, Light | ObservedLight] = field(default_factory=dict)
    left_mark: LaneMark | None = None
    right_mark: LaneMark | None = None
    stop_line: Points | None = None
    junction: str = ""
    minimum_mps: float | None = None
    foes: frozenset[str] | None = None
    first: frozenset[str] | None = None


LIMIT_SIGN, LEAST_SPEED_SIGN = "MAX_SPEED", "MIN_SPEED"
"""Among ``untold_signs`` they leave the limit, or the minimum speed, unknown: it is not None there
because no sign stands, but because the file does not tell what stands or for whom it holds."""

CROSSWALK = "crosswalk"
NO_LANES = frozenset({"sidewalk", CROSSWALK, "border", "parking", "restricted_area"})
"""Types of lanelets that are not part of the carriageway."""

ALL_STOP = "STOP_4_WAY"
STOP_SIGNS = frozenset({"STOP", ALL_STOP})
GIVE_WAY_SIGNS = STOP_SIGNS | {"YIELD"}
REGULATING = GIVE_WAY_SIGNS | {"PRIORITY", "RIGHT_OF_WAY"}
"""Signs that regulate priority."""

CYCLES_TOO = "cyclesAllowed"
"""The type of a reserved lane that cycles may use as well."""

TAXIS_TOO = "taxisAllowed"
"""The type of a bus lane that taxis may use as well."""

BUSES_ONLY = "busesOnly"
"""The type of a bus lane whose users the map names: nobody but those uses it."""

STRAIGHT_ON = "straightOn"
"""The type of a path through a junction that the map calls straight on, even if it bends."""

JOINING = "accessRamp"
"""The type of a lane that ends beside others, to merge into them."""

RAMPS = frozenset({JOINING, "exitRamp"})
"""The types of lanes that merge into others, or leave them."""

BROAD_LEFT, BROAD_RIGHT = "broadLineLeft", "broadLineRight"
"""Types of lanes with a broad broken line on a side, as where lanes leave the road."""


def is_lane(lanelet: Lanelet) -> bool:
    """Whether a lanelet is part of the carriageway."""
    return not lanelet.types & NO_LANES


@dataclass(frozen=True, slots=True)
class TrackState:
    """A centre (m), its heading (rad), and its motion along that heading."""

    x: float
    y: float
    heading: float
    speed: float
    acceleration: float


@dataclass(frozen=True, slots=True)
class Participant:
    """An obstacle of the file, with its outlines (corners of polygons) by time step.

    ``standing``: it is present all the time, in its only state. ``lamps``: the lit ones by time
    step; steps without information are missing. ``shows`` are the lamps for which the file has
    information. ``stated_error`` is the error of states that the file itself states, or that of an
    assumed size. ``resumes``: the last time step of the track that this one goes on with, after a
    cut; None if it begins by itself. ``heads_as_it_moves``: the file has no heading, only the
    directions of motion.
    """

    __repr__ = short_repr

    id: str
    type: str
    standing: bool
    states: Mapping[int, TrackState]
    outlines: Mapping[int, Points]
    lamps: Mapping[int, frozenset[Lamp]] = field(default_factory=dict)
    shows: frozenset[Lamp] = frozenset({"left_indicator", "right_indicator", "brake_light"})
    stated_error: StatedError | None = None
    resumes: int | None = None
    heads_as_it_moves: bool = False

    @property
    def object_types(self) -> tuple[str, ...]:
        """Its types in vocabularies, the most specific first."""
        return OBSTACLE_TYPES.get(self.type, OBSTACLE_TYPES["unknown"])


@dataclass(frozen=True, slots=True)
class PlanningProblem:
    """A planning problem: ego's state at a time step, and its goals."""

    id: str
    step: int
    start: TrackState
    goals: Points


@dataclass(frozen=True, slots=True)
class Weather:
    """The weather of a recording, and whether it is night; None if the file does not say.

    ``raining`` includes any precipitation, such as snow or hail.
    """

    wet: bool | None = None
    icy: bool | None = None
    visibility_m: float | None = None
    raining: bool | None = None
    night: bool | None = None


HEADINGS = "headings"
"""``complete`` contains this if ego's headings are known independently of its motion."""

MENDED = "mended"
"""``complete`` contains this if tracks have been repaired; a plan among them is meant as it is."""


class StatedError(NamedTuple):
    """The radius of position areas (m), and half the speed intervals (m/s), stated in a file."""

    place_m: float
    speed_mps: float


class Rounding(NamedTuple):
    """The units of the last decimals in which positions (m) and speeds (m/s) are written.

    Speeds follow from positions where they are not written (None).
    """

    place_m: float
    speed_mps: float | None


@dataclass(frozen=True, slots=True)
class WholeRecording:
    """Facts about a whole recording that are needed when a part of it is evaluated.

    ``first`` and ``last`` are its time steps, ``stated_error`` the median of the errors that it
    states, ``noise_m`` and ``noise_rad`` the standard deviations of its positions and headings from
    smooth motion. ``arrivals``: some vehicle appears after the first step. ``shows`` are the lamps
    for which it has information about any participant. ``ids`` are those of all participants.
    """

    first: int
    last: int
    stated_error: StatedError | None
    noise_m: float
    noise_rad: float
    arrivals: bool
    shows: frozenset[Lamp]
    ids: frozenset[str]


@dataclass(frozen=True, slots=True)
class Recording:
    """A recording: one time step takes ``step_s`` seconds, not rounded if of a frame rate.

    ``form`` is the name of its format. ``side`` is the side of traffic, None if unknown;
    ``country`` is its code (ISO 3166) or empty. ``complete`` names kinds of things, such as signs,
    that the file would contain if they existed; ``lacks`` those that no such file contains, such as
    crosswalks. ``remarks`` say what the file leaves open and what is assumed instead. ``rounding``
    is that of an otherwise exact file. ``ego`` is the participant that the file declares as ego, or
    empty. ``whole`` has the facts about the whole recording, for a part of one.
    """

    __repr__ = short_repr

    name: str
    step_s: float
    lanelets: Mapping[str, Lanelet]
    participants: tuple[Participant, ...]
    problems: tuple[PlanningProblem, ...] = ()
    form: str = "CommonRoad scenario"
    side: Side | None = None
    remarks: tuple[str, ...] = ()
    country: str = ""
    complete: frozenset[str] = frozenset()
    lacks: frozenset[str] = frozenset()
    weather: Weather = Weather()
    rounding: Rounding | None = None
    ego: str = ""
    whole: WholeRecording | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "step_s", frame_step(self.step_s))

    @property
    def ids(self) -> frozenset[str]:
        """The participants' ids; for a part, those of the whole recording."""
        if self.whole is not None:
            return self.whole.ids
        return frozenset([body.id for body in self.participants])


def frame_step(step_s: float) -> float:
    """The step (s) that a recording's step stands for: that of a frame rate which it rounds.

    Frame rates are 1 to 1000 per second, or a thousand of those in 1001 s, as in video. A number of
    five or more digits rounds a step from which it is off by half a unit of its last digit at most;
    any number may be off by the noise of floats. All other steps stay as they are.
    """
    if not 0 < step_s < math.inf:
        return step_s
    rates = ((1, _rate(1.0, step_s)), (1001, 1000 * _rate(1.001, step_s)))
    # The quotient of two whole numbers is the float nearest to it.
    steps = [duration / count for duration, count in rates if count]
    near = min(steps, key=lambda step: abs(step - step_s), default=step_s)
    return near if abs(near - step_s) <= _rounding(step_s) else step_s


def _rate(duration_s: float, step_s: float) -> int:
    """The usual number of steps that is nearest to how many a duration has; 0 for none."""
    steps = duration_s / step_s
    return round(steps) if steps < _RATES + 0.5 else 0


def _rounding(step_s: float) -> float:
    """By how much a step (s) may differ from what it stands for, as it is written."""
    noise = _NOISE * math.ulp(step_s)
    written = Decimal(repr(float(step_s))).normalize().as_tuple()
    if len(written.digits) < _FEWEST_DIGITS:
        return noise
    return noise + 0.5 * 10.0 ** int(written.exponent)
