"""The tracks of all participants as arrays: places, headings, velocities.

Rows are participants, in the order of the file; columns are time steps, from ``first`` on.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from copy import copy
from dataclasses import dataclass, fields, replace
from functools import cached_property
from operator import itemgetter
from typing import Any, cast

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags, Floats
from rulec.extraction.computed_once import KeepsResults, kept
from rulec.extraction.recording_parts import looked_at
from rulec.extraction.tracks.source_tolerances import Tolerances, tolerances_of
from rulec.extraction.tracks.track_motion import Poses, motion_of
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.recordings.polylines import places_in
from rulec.recordings.recording import (
    OBSTACLE_TYPES,
    Lanelet,
    Participant,
    Points,
    Recording,
    is_lane,
)
from rulec.recordings.track import TrackOutlines, outlines_on_track
from rulec.scenario.recorded.joined_outlines import JoinedOutlines
from rulec.scenario.recorded.route import lanelet_area
from rulec.trace.laid_out import LaidOut
from rulec.trace.plain_arrays import zero_if_nan


class ObjectTypes(KeepsResults):
    """The object types of a recording's participants, as masks that are built once."""

    def __init__(self, participants: Iterable[Participant]) -> None:
        self._types = [body.object_types for body in participants]

    @kept
    def of(self, name: str) -> Flags:
        """Mask of the participants that have a type or one of its subtypes."""
        return np.array([name in types for types in self._types], dtype=bool)

    def of_unknown(self) -> Flags:
        """Mask of the participants of which only a road user is known."""
        unknown = OBSTACLE_TYPES["unknown"]
        return np.array([types == unknown for types in self._types], dtype=bool)

    def unknown_as_vehicles(self) -> ObjectTypes:
        """The types if all participants of unknown type were vehicles."""
        other, unknown = ObjectTypes(()), OBSTACLE_TYPES["unknown"]
        vehicle = OBSTACLE_TYPES["vehicle"]
        other._types = [vehicle if types == unknown else types for types in self._types]
        return other


@dataclass(frozen=True, eq=False, slots=True)
class Bodies:
    """Outlines of participants, with the row and the column of each."""

    rows: NDArray[intp]
    columns: NDArray[intp]
    outlines: JoinedOutlines


@dataclass(frozen=True, eq=False, kw_only=True)
class Tracks:
    """Arrays of participants by steps, NaN where a participant is absent.

    ``rows`` are the participants' rows in the whole recording, as in ``types``. ``x`` and ``y`` are
    centres (m), ``heading`` is in rad. Velocities (m/s) and accelerations (m/s²) are those of
    ``motion_of``, with their errors.

    ``on_lane`` and ``on_crosswalk``: whether the middle of a vulnerable road user is on a lane, of
    any direction, or on a pedestrian crossing. Pedestrians on the pavement are on no lane.
    """

    participants: tuple[Participant, ...]
    types: ObjectTypes
    rows: NDArray[intp]
    first: int
    present: Flags
    x: Floats
    y: Floats
    heading: Floats
    vx: Floats
    vy: Floats
    speed: Floats
    speed_error: Floats
    acceleration: Floats
    acceleration_error: Floats
    scale_error: Floats
    on_lane: Flags
    on_crosswalk: Flags

    @cached_property
    def bodies(self) -> Bodies:
        """The outlines of all participants; a single one, in the first column, if static."""
        return _bodies(self, repeated=False)

    @cached_property
    def repeated_bodies(self) -> Bodies:
        """The outlines of all participants, one in each column."""
        return _bodies(self, repeated=True)

    def outline(self, row: int, column: int) -> Points | None:
        """The outline of a participant in a column; None where it is absent."""
        body = self.participants[row]
        step = next(iter(body.outlines)) if body.standing else self.first + column
        return body.outlines.get(step)

    @cached_property
    def fastest(self) -> Floats:
        """The greatest speed (m/s) of each participant, 0 where none is known."""
        fastest: Floats = zero_if_nan(self.speed).max(axis=1, initial=0.0)
        return fastest

    @cached_property
    def reaches(self) -> Floats:
        """Bound (m) on how far from its centre a participant's corners may have feet on a line.

        Covers the corners' distances from the centre and from each other, whatever the line; 0 for
        participants without a place.
        """
        bodies, found = self.bodies, np.zeros(len(self.participants))
        at = bodies.rows, bodies.columns
        centres = np.array((self.x[at], self.y[at])).T
        outlines = bodies.outlines
        away = np.hypot(*(outlines.corners - centres.repeat(outlines.counts, axis=0)).T)
        most = np.maximum.reduceat(away, outlines.starts) if len(away) else away
        np.maximum.at(found, bodies.rows, 2 * most + 2 * outlines.reach)
        return found

    @cached_property
    def widths(self) -> Floats:
        """The widths (m) of bodies across their headings, 0 where unknown.

        Static bodies have one in the first column only.
        """
        return self._sizes(lambda x, y, cos, sin: y * cos - x * sin)

    @cached_property
    def lengths(self) -> Floats:
        """The greatest length (m) of each participant's body along its headings."""
        along = self._sizes(lambda x, y, cos, sin: x * cos + y * sin)
        longest: Floats = along.max(axis=1, initial=0.0)
        return longest

    def _sizes(self, along: Callable[[Floats, Floats, Floats, Floats], Floats]) -> Floats:
        """The sizes of bodies along an axis, from x, y and their heading's cosine and sine."""
        bodies, sizes = self.bodies, np.zeros(self.present.shape)
        outlines, way = bodies.outlines, self.heading[bodies.rows, bodies.columns]
        x, y = outlines.corners.T
        at = along(x, y, *(own.repeat(outlines.counts) for own in (np.cos(way), np.sin(way))))
        most, least = (
            extreme.reduceat(at, outlines.starts) for extreme in (np.maximum, np.minimum)
        )
        sizes[bodies.rows, bodies.columns] = most - least
        return sizes

    def part(self, rows: NDArray[intp], columns: slice) -> Tracks:
        """The tracks of some participants in a range of steps."""
        return _PartOfTracks(self, rows, columns)

    def where(self, flags: Flags) -> Tracks:
        """The tracks with participants present only where the mask holds.

        Static participants stay present all the time.
        """
        same = copy(self)
        for name in _OF_BODIES.intersection(same.__dict__):
            del same.__dict__[name]
        same.__dict__["present"] = self.present & flags
        return same

    def seen_as(
        self, participants: tuple[Participant, ...], types: ObjectTypes, rows: NDArray[intp]
    ) -> Tracks:
        """The same tracks under other participants, with their rows among ``types``."""
        same = copy(self)
        same.__dict__.update(participants=participants, types=types, rows=rows)
        return same

    def at(self, rows: NDArray[intp], columns: NDArray[intp], members: NDArray[intp]) -> Tracks:
        """The values at rows and columns of the same shape; ``members`` are the participants' rows.

        The columns need not be contiguous, so ``first`` does not describe them.
        """
        return Tracks(
            participants=tuple(self.participants[row] for row in members.tolist()),
            types=self.types,
            rows=self.rows[members],
            first=self.first,
            **{name: getattr(self, name)[rows, columns] for name in _ARRAYS},
        )

    def end_to_end(self, laid: LaidOut) -> Tracks:
        """The tracks of some participants in several ranges of columns, end to end."""
        return _LaidTracks(self, laid.rows, laid)

    def of_type(self, name: str) -> Flags:
        """Mask of participants of an object type or its subtypes."""
        return self.types.of(name)[self.rows]

    def and_one(self, other: Tracks, row: int, types: ObjectTypes) -> Tracks:
        """The tracks of a whole recording, followed by one row of ``other`` in the same steps.

        ``types`` are those of all of them.
        """
        own = slice(row, row + 1)
        return Tracks(
            participants=(*self.participants, other.participants[row]),
            types=types,
            rows=np.arange(len(self.participants) + 1),
            first=self.first,
            **{
                name: np.concatenate((getattr(self, name), getattr(other, name)[own]))
                for name in _ARRAYS
            },
        )


_ARRAYS = tuple(x.name for x in fields(Tracks))[4:]

_OF_BODIES = frozenset({"bodies", "repeated_bodies", "reaches", "widths"})
"""Cached values that depend on outlines."""


class _LaidTracks(Tracks):
    """Some rows of a ``whole``, with each array laid out on first use.

    Most arrays are never used.
    """

    def __init__(
        self,
        whole: Tracks,
        rows: NDArray[intp],
        lay: Callable[[NDArray[Any]], NDArray[Any]],
    ) -> None:
        self.__dict__.update(
            participants=tuple(whole.participants[row] for row in rows.tolist()),
            types=whole.types,
            rows=whole.rows[rows],
            first=whole.first,
            _whole=whole,
            _lay=lay,
        )

    def __getattr__(self, name: str) -> NDArray[Any]:
        if name not in _ARRAYS:
            raise AttributeError(name)
        values = self.__dict__["_lay"](getattr(self.__dict__["_whole"], name))
        self.__dict__[name] = values
        return cast("NDArray[Any]", values)


class _PartOfTracks(_LaidTracks):
    """Some rows and a range of columns of a ``whole``; parts of it refer to that whole directly."""

    def __init__(self, whole: Tracks, rows: NDArray[intp], columns: slice) -> None:
        super().__init__(whole, rows, itemgetter((rows, columns)))
        self.__dict__.update(first=whole.first + columns.start, _rows=rows, _columns=columns)

    def part(self, rows: NDArray[intp], columns: slice) -> Tracks:
        """The tracks of some participants in a range of steps."""
        own = self.__dict__
        before = own["_columns"].start
        later = slice(before + columns.start, before + columns.stop)
        return _PartOfTracks(own["_whole"], own["_rows"][rows], later)


def _bodies(tracks: Tracks, *, repeated: bool) -> Bodies:
    columns: list[NDArray[intp]] = []
    outlines: list[Sequence[Points] | Floats] = []
    there = tracks.present.sum(axis=1).tolist()
    for body, present, count in zip(tracks.participants, tracks.present, there, strict=True):
        at, own = _outlines_of(body, tracks.first, (present, count), repeated=repeated)
        columns.append(at)
        outlines.append(own)
    counts = [len(at) for at in columns]
    if not any(counts):
        none = np.empty(0, dtype=intp)
        return Bodies(none, none, JoinedOutlines(np.empty((0, 2)), none))
    rows = np.arange(len(counts)).repeat(counts)
    return Bodies(rows, np.concatenate(columns), JoinedOutlines.of_bodies(outlines))


def _outlines_of(
    body: Participant, first: int, there: tuple[Flags, int], *, repeated: bool
) -> tuple[NDArray[intp], Sequence[Points] | Floats]:
    """The columns and outlines of a participant; ``there`` is its presence mask and its count."""
    present, count = there
    if body.standing:
        columns = np.arange(len(present) if repeated else 1)
        return columns, [next(iter(body.outlines.values()))] * len(columns)
    if isinstance(body.outlines, TrackOutlines):
        steps = body.outlines.track.steps
        if len(steps) == count:
            return steps - first, body.outlines.laid_out
        columns = present.nonzero()[0]
        return columns, body.outlines.laid_out[steps.searchsorted(columns + first)]
    columns = present.nonzero()[0]
    return columns, [body.outlines[first + column] for column in columns.tolist()]


_STEERED = frozenset({"vehicle", "light_rider", "rail_vehicle"})


def tracks_of(
    recording: Recording,
    thresholds: Thresholds,
    participants: Sequence[Participant] | None = None,
    span: tuple[int, int] | None = None,
    tolerances: Tolerances | None = None,
) -> Tracks:
    """The tracks of all participants of a recording that have outlines.

    ``participants`` may replace the recording's. ``span`` is the first and last step of the arrays,
    if not those of the tracks; ``tolerances`` are the recording's, if already known.
    """
    members = recording.participants if participants is None else participants
    bodies = tuple(body for body in members if body.outlines)
    laid_out = [_poses(body) for body in bodies]
    if span is None:
        own = recording if participants is None else replace(recording, participants=bodies)
        span = looked_at(own)
    first, last = span
    shape = len(bodies), last - first + 1
    every = np.full((4, *shape), np.nan)
    moving = [row for row, body in enumerate(bodies) if not body.standing]
    if moving:
        steps, poses = zip(*[laid_out[row] for row in moving], strict=True)
        rows = np.repeat(moving, [len(own) for own in steps])
        every[:, rows, np.concatenate(steps) - first] = np.concatenate(poses).T
    for row, body in enumerate(bodies):
        if body.standing:
            every[:, row] = laid_out[row][1][0][:, None]
    x, y, heading, stated = every
    present = ~np.isnan(x)
    steers = np.array([bool(_STEERED.intersection(body.object_types)) for body in bodies], bool)
    motion = motion_of(
        Poses(x, y, heading, stated, steers),
        thresholds.smoothing_s,
        recording.step_s,
        tolerances or tolerances_of(recording, thresholds),
    )
    types = ObjectTypes(bodies)
    users = present & types.of("vulnerable_user")[:, None]
    lanelets = recording.lanelets.values()
    crosswalks = (lanelet for lanelet in lanelets if "crosswalk" in lanelet.types)
    on_crosswalk = _inside(users, x, y, crosswalks)
    on_lane = _inside(users, x, y, filter(is_lane, lanelets))
    # Where maps let the ways of turning vehicles overlap corners of the pavement
    walkers = users & on_lane & ~on_crosswalk & types.of("pedestrian")[:, None]
    on_lane &= ~_inside(walkers, x, y, (x for x in lanelets if "sidewalk" in x.types))
    return Tracks(
        participants=bodies,
        types=types,
        rows=np.arange(len(bodies)),
        first=first,
        present=present,
        x=x,
        y=y,
        heading=heading,
        **{field.name: getattr(motion, field.name) for field in fields(motion)},
        on_lane=on_lane,
        on_crosswalk=on_crosswalk,
    )


def _inside(flags: Flags, x: Floats, y: Floats, lanelets: Iterable[Lanelet]) -> Flags:
    inside = np.zeros(flags.shape, dtype=bool)
    rows, columns = flags.nonzero()
    if len(rows) and (areas := [lanelet_area(lanelet) for lanelet in lanelets]):
        at, _ = places_in(areas, x[rows, columns], y[rows, columns])
        inside[rows[at], columns[at]] = True
    return inside


def _poses(body: Participant) -> tuple[NDArray[intp], Floats]:
    """The steps of a participant, and a row with its place, heading and stated speed for each."""
    on_track = outlines_on_track(body)
    if on_track is not None:
        return on_track.track.steps, on_track.track.rows[:, :4]
    states, outlines, poses = body.states, body.outlines, []
    for step, outline in outlines.items():
        state = states.get(step)
        if state is None:
            poses.append((*outline.mean(axis=0).tolist(), 0.0, 0.0))
        else:
            poses.append((state.x, state.y, state.heading, state.speed))
    return np.fromiter(outlines, dtype=intp, count=len(poses)), np.array(poses)
