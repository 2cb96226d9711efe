"""Moving and stationary objects of an ASAM OSI trace as participants."""

from __future__ import annotations

from array import array
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from math import cos, sin

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.recordings.encodings.wire_format import Fields, WireFile
from rulec.recordings.osi.message_fields import number, part, places
from rulec.recordings.osi.message_times import TimeGrid
from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import Lamp, Participant, Points
from rulec.recordings.track import Track, tracked

_CARS = ("small_car", "compact_car", "car", "luxury_car", "van")
_KINDS: Mapping[str, str] = {
    **dict.fromkeys(_CARS, "car"),
    **dict.fromkeys(("heavy_truck", "semitractor"), "truck"),
    **dict.fromkeys(("bicycle", "standup_scooter", "micromobility_device"), "bicycle"),
    **dict.fromkeys(("tram", "train"), "train"),
    "motorbike": "motorcycle",
    "bus": "bus",
    "wheelchair": "pedestrian",
}
"""Vehicle type -> kind of participant; trailers are left out, other types are unknown."""

_ON_CALL = frozenset({"ambulance", "fire", "police"})
_DRIVEN = frozenset({"car", "truck", "bus", "motorcycle", "unknown"})

USUAL_SIZES: Mapping[str, tuple[float, float]] = {
    "truck": (7.1, 2.4),
    "bus": (12.0, 2.5),
    "motorcycle": (2.2, 0.9),
    "bicycle": (1.8, 0.65),
    "pedestrian": (0.5, 0.5),
    "train": (30.0, 2.65),
}
"""Length and width (m) by kind, used if a trace gives none; ``USUAL_SIZE`` for other kinds."""

USUAL_SIZE = (4.5, 1.8)

_STANDING: Mapping[str, str] = {
    "building": "building",
    **dict.fromkeys(("barrier", "curbstone", "wall"), "roadBoundary"),
    "construction_site_element": "constructionZone",
    **dict.fromkeys(("pole", "pylon", "delineator", "tree", "vegetation"), "pillar"),
    **dict.fromkeys(("vertical_structure", "rectangular_structure"), "pillar"),
    **dict.fromkeys(("reflective_structure", "emitting_structure"), "pillar"),
    **dict.fromkeys(("unknown", "other"), "pillar"),
}
"""Kinds of stationary objects that block the way; bridges and bumps do not."""

_MOTION, _NUMBERS = 7, 9
_CREEPING_MPS = 0.1

_INDICATORS: Mapping[str, frozenset[Lamp]] = {
    "off": frozenset(),
    "left": frozenset({"left_indicator"}),
    "right": frozenset({"right_indicator"}),
    "warning": frozenset({"hazard_lights"}),
}
_BRAKES: Mapping[str, frozenset[Lamp]] = {
    "off": frozenset(),
    **dict.fromkeys(("normal", "strong"), frozenset({"brake_light"})),
}
_BLUE: Mapping[str, frozenset[Lamp]] = {
    "off": frozenset(),
    **dict.fromkeys(("flashing_blue", "flashing_blue_and_red", "on"), frozenset({"blue_light"})),
}
_BEAMS: tuple[tuple[str, Lamp], ...] = (
    ("head_light", "dipped_beam"),
    ("high_beam", "main_beam"),
    ("front_fog_light", "front_fog_lamp"),
    ("rear_fog_light", "rear_fog_lamp"),
)
_LAMPS: tuple[tuple[str, frozenset[Lamp], Mapping[str, frozenset[Lamp]]], ...] = (
    (
        "indicator_state",
        frozenset({"left_indicator", "right_indicator", "hazard_lights"}),
        _INDICATORS,
    ),
    ("brake_light_state", frozenset({"brake_light"}), _BRAKES),
    ("emergency_vehicle_illumination", frozenset({"blue_light"}), _BLUE),
    *(
        (name, frozenset({lamp}), {"off": frozenset[Lamp](), "on": frozenset({lamp})})
        for name, lamp in _BEAMS
    ),
)
"""Field, the lamps that it describes, and the lamps that are lit for each of its values."""

_Shown = tuple[frozenset[Lamp], frozenset[Lamp]]


@dataclass(slots=True)
class MovingObject:
    """A moving object read so far; it takes 80 bytes per moment."""

    kinds: Counter[str] = field(default_factory=Counter)
    moments: array[int] = field(default_factory=lambda: array("q"))
    rows: array[float] = field(default_factory=lambda: array("d"))
    # At moments from which on it has others lit, or tells of others
    shown: dict[int, _Shown] = field(default_factory=dict)
    _last: _Shown | None = None

    def add(self, moment: int, fields: Fields, file: WireFile) -> None:
        """Note its state at a moment. Raises RulecError R0610."""
        base = part(fields, "base")
        place, size = part(base, "position"), part(base, "dimension")
        if self.moments and self.moments[-1] == moment:
            return
        self.moments.append(moment)
        self.kinds[_kind_of(fields)] += 1
        self.rows.extend((number(place, "x", file), number(place, "y", file)))
        self.rows.append(
            number(base["orientation"], "yaw", file) if "orientation" in base else np.nan
        )
        for name in ("velocity", "acceleration"):
            vector = base.get(name)
            for axis in ("x", "y"):
                self.rows.append(np.nan if vector is None else number(vector, axis, file))
        self.rows.extend(abs(number(size, name, file)) for name in ("length", "width"))
        shown = _lamps(part(fields, "vehicle_classification", "light_state"))
        if shown != self._last:
            self.shown[moment] = self._last = shown

    @property
    def kind(self) -> str:
        """Its most frequent type."""
        return max(self.kinds, key=self.kinds.__getitem__, default="unknown")

    @property
    def size(self) -> tuple[float, float] | None:
        """The medians of the lengths and widths in its messages; None if no message has both."""
        sizes = np.array(self.rows).reshape(-1, _NUMBERS)[:, _MOTION:]
        known = sizes[sizes.min(axis=1) > 0]
        return (
            (float(np.median(known[:, 0])), float(np.median(known[:, 1]))) if len(known) else None
        )


def _kind_of(fields: Fields) -> str:
    """A moving object's type, in the words of recordings."""
    vehicle = part(fields, "vehicle_classification")
    return kind_of(fields.get("type", "unknown"), vehicle.get("type"), vehicle.get("role"))


def kind_of(kind: str, vehicle: str | None, role: str | None) -> str:
    """A moving object's type in the words of recordings, from OSI's type, subtype and role.

    The latter two are None where they are missing.
    """
    if kind == "pedestrian":
        return "pedestrian"
    if kind == "animal" or vehicle is None:
        return "unknown"
    kind_name = _KINDS.get(vehicle, "unknown")
    if role in _ON_CALL and kind_name in _DRIVEN and vehicle != "trailer":
        return "priorityVehicle"
    return kind_name


def _lamps(state: Fields) -> _Shown:
    """The lamps that a state describes, and those of them that are lit."""
    known: frozenset[Lamp] = frozenset()
    lit: frozenset[Lamp] = frozenset()
    for name, lamps, by_value in _LAMPS:
        if state.get(name) in by_value:
            known, lit = known | lamps, lit | by_value[state[name]]
    return known, lit


def participants(objects: Mapping[str, MovingObject], grid: TimeGrid) -> Iterator[Participant]:
    """The moving objects of a trace on its time steps."""
    for key, body in objects.items():
        moments = np.array(body.moments, dtype=int64)
        steps = grid.steps[moments]
        rows = _track_rows(
            np.array(body.rows).reshape(-1, _NUMBERS)[:, :_MOTION],
            (steps * grid.step_s).astype(float64),
        )
        size = body.size or USUAL_SIZES.get(body.kind, USUAL_SIZE)
        track = Track(steps, rows, *size)
        shows = frozenset().union(*(known for known, _ in body.shown.values()))
        lamps = _lamps_by_step(body, grid, shows)
        yield tracked(key, body.kind, track, lamps=lamps, shows=shows)


def _lamps_by_step(
    body: MovingObject, grid: TimeGrid, shows: frozenset[Lamp]
) -> dict[int, frozenset[Lamp]]:
    """The lit lamps by step, for the steps that describe every lamp in ``shows``."""
    lamps = {}
    now: _Shown = (frozenset(), frozenset())
    for moment in body.moments if shows else ():
        now = body.shown.get(moment, now)
        if now[0] == shows:
            lamps[int(grid.steps[moment])] = now[1]
    return lamps


def _track_rows(rows: NDArray[float64], times: NDArray[float64]) -> NDArray[float64]:
    """x, y, heading, and speed and acceleration along it; missing values come from positions."""
    x, y, heading, *motion = rows.T
    if len(x) < 2:
        velocity = np.nan_to_num(np.stack(motion[:2]))
    elif np.isnan(motion[0]).any():
        velocity = np.stack([np.gradient(axis, times) for axis in (x, y)])
    else:
        velocity = np.stack(motion[:2])
    if np.isnan(heading).any():
        heading = np.where(np.isnan(heading), _directions(velocity), heading)
    ahead = np.stack((np.cos(heading), np.sin(heading)))
    speed = (velocity * ahead).sum(axis=0)
    acceleration = (np.stack(motion[2:]) * ahead).sum(axis=0)
    if np.isnan(acceleration).any():
        acceleration = np.gradient(speed, times) if len(x) > 1 else np.zeros(len(x))
    return np.column_stack((x, y, wrapped(heading), speed, acceleration))


def _directions(velocity: NDArray[float64]) -> NDArray[float64]:
    """The directions of motion.

    At standstill the last direction is kept, or the next one is used.
    """
    moves = np.hypot(*velocity) > _CREEPING_MPS
    if not moves.any():
        return np.zeros(velocity.shape[1])
    latest = np.maximum.accumulate(np.where(moves, np.arange(len(moves)), -1))
    latest[latest < 0] = int(np.argmax(moves))
    directions: NDArray[float64] = np.arctan2(velocity[1], velocity[0])[latest]
    return directions


def standing(objects: Iterable[tuple[str, Fields]], file: WireFile) -> Iterator[Participant]:
    """Stationary objects on the ground, from ids and messages. Raises RulecError R0610."""
    for key, fields in objects:
        kind = _STANDING.get(part(fields, "classification").get("type", "unknown"))
        if kind is not None and (outline := _outline(part(fields, "base"), file)) is not None:
            yield Participant(key, kind, True, {}, {0: outline})


def _outline(base: Fields, file: WireFile) -> Points | None:
    """The outline of a stationary object; None if it has no size."""
    size = part(base, "dimension")
    length, width = (abs(number(size, name, file)) / 2 for name in ("length", "width"))
    corners = places(base.get("base_polygon", ()), file)
    if len(corners) < 3:
        corners = np.array([(1, 1), (1, -1), (-1, -1), (-1, 1)]) * (length, width)
        if not min(length, width) > 0:
            return None
    yaw = number(part(base, "orientation"), "yaw", file)
    turned = np.array([(cos(yaw), sin(yaw)), (-sin(yaw), cos(yaw))])
    middle = places([part(base, "position")], file)
    outline: Points = corners @ turned + middle
    return outline
