"""A recording of traffic as data: lanelets, participants, planning problems.

Places are in the file's own frame, x and y in metres; angles are radians, counter-clockwise.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal, NamedTuple

from numpy import float64
from numpy.typing import NDArray

from rulec.value_display import short_repr

Points = NDArray[float64]
"""Places: one row each, x and y."""

LONGEST_M = 20_000.0
"""Lanelets are shorter; a slip of the pen that makes one much longer would take all memory."""

MOST_STEPS = 1_000_000
"""A recording has fewer, which is more than a day of tenths of a second."""

SPARSEST = 1000
"""One in so many time steps is in the file at least; else one of its times is a slip."""

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
    "dipped_beam",
    "main_beam",
    "front_fog_lamp",
    "rear_fog_lamp",
]
"""What a vehicle shows others: its lamps, its horn, and open doors."""


def id_order(identifier: str) -> tuple[int, str]:
    """A sort key for ids that puts numbers in their order."""
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
"""Types of participants -> object types of vocabularies, the most specific word first.

They are CommonRoad's obstacle types, a vehicle, a rider and an object of no more specific one.

A rulebook that does not tell cars from other vehicles judges a car as a vehicle. What is not a road
user is an obstacle at most; a rulebook without that word has no rule about it, but it is in the way
all the same.
"""


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
    """What a traffic light was seen to show, by time step; steps without a colour are missing.

    ``seen``: there is one. Else the file does not tell whether there is.
    """

    __repr__ = short_repr

    colours: Mapping[int, str]
    seen: bool = True

    def colour_at(self, step: int) -> str:
        """Its colour at a time step, empty where that is not known."""
        return self.colours.get(step, "")


def is_there(light: Light | ObservedLight) -> bool:
    """False if the file does not tell whether there is such a light."""
    return isinstance(light, Light) or light.seen


@dataclass(frozen=True, slots=True, kw_only=True)
class Lanelet:
    """A piece of a lane, with its bounds in the direction of travel.

    ``left_of`` and ``right_of`` are the lanelets beside it that lead the same way. ``signs`` are
    the names of those that hold here, ``untold_signs`` of those of which the file does not tell
    whether they do; ``lights`` are those that have a programme or were seen,
    ``lights_to`` that for each lanelet that follows, where it has its own. Marks are those
    of its bounds, ``stop_line`` (two ends) the one that the map has drawn, None where the file does
    not say. ``junction`` is the one that it lies in. Of the ways through that, ``foes`` are those
    whose traffic is in the way of its own, ``first`` those of them that go first; None: not told.
    ``minimum_mps`` is the least speed that signs ask for.
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


CROSSWALK = "crosswalk"
NO_LANES = frozenset({"sidewalk", CROSSWALK, "border", "parking", "restricted_area"})
"""Types of lanelets that are no part of the carriageway."""

ALL_STOP = "STOP_4_WAY"
STOP_SIGNS = frozenset({"STOP", ALL_STOP})
REGULATING = STOP_SIGNS | {"YIELD", "PRIORITY", "RIGHT_OF_WAY"}
"""Signs that say who goes first."""

CYCLES_TOO = "cyclesAllowed"
"""The type of a lane that is reserved for others, and cycles may use as well."""

TAXIS_TOO = "taxisAllowed"
"""The type of a lane for buses that taxis may use as well."""

STRAIGHT_ON = "straightOn"
"""The type of a way through a junction that the map calls straight on, however it bends."""

JOINING = "accessRamp"
"""The type of a lane that ends beside others, to join them."""

RAMPS = frozenset({JOINING, "exitRamp"})
"""The types of lanes that join others, or leave them."""

BROAD_LEFT, BROAD_RIGHT = "broadLineLeft", "broadLineRight"
"""Types of lanes with a broad broken line on a side, as begins where lanes leave the road."""


def is_lane(lanelet: Lanelet) -> bool:
    """True if a lanelet is a part of the carriageway."""
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

    ``standing``: it is there all the time, in its only state. ``lamps``: by time step those that
    are lit; steps that the file says nothing about are missing. ``shows`` are those that the file
    speaks of. ``stated_error`` is how far the file itself says that states may be wrong, or a usual
    size in place of one that it does not say.
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
    """The weather of a recording, and whether it is night; None where the file does not say.

    ``raining``: something falls, be it snow or hail.
    """

    wet: bool | None = None
    icy: bool | None = None
    visibility_m: float | None = None
    raining: bool | None = None
    night: bool | None = None


HEADINGS = "headings"
"""What a recording is complete in if ego's headings are known apart from the way that it moves."""

MENDED = "mended"
"""And what it is complete in if its tracks have been mended: a plan among them is meant so."""


class StatedError(NamedTuple):
    """The radius of the areas (m), and half the intervals of speeds (m/s), that a file says."""

    place_m: float
    speed_mps: float


class Rounding(NamedTuple):
    """The units of the last decimals in which places (m) and speeds (m/s) are written."""

    place_m: float
    speed_mps: float


@dataclass(frozen=True, slots=True)
class WholeRecording:
    """What is to be known of a recording as a whole where a part of it is looked at.

    ``first`` and ``last`` are its time steps, ``stated_error`` the median of what it says itself,
    ``noise_m`` the standard deviation of its places from smooth motion, as they themselves show.
    ``arrivals``: is some vehicle there from later on than the first step? ``shows`` are the lamps
    that it speaks of for anybody.
    """

    first: int
    last: int
    stated_error: StatedError | None
    noise_m: float
    arrivals: bool
    shows: frozenset[Lamp]


@dataclass(frozen=True, slots=True)
class Recording:
    """A file: one time step takes ``step_s`` seconds.

    ``form`` is what such a file is called, ``side`` the one on which traffic keeps, None if the
    file does not say, ``country`` its code (ISO 3166) or empty. ``complete`` names kinds of things,
    signs for one, that the file would have if they were there, ``lacks`` those that no such file
    has, crosswalks for one. ``remarks``: what the file leaves open, and is taken to be.
    ``rounding`` is that of a file that is exact otherwise. ``ego`` is the participant that the file
    says to be it, empty if it does not say. ``whole`` is what a part of a recording knows of all of
    it.
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
