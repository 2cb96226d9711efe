"""Passages: which participants went through which junction, on which way, and when.

A participant's way is, of those that begin in its direction, the one whose middle line is nearest
to its places on average; if all are far, the one whose line is, led straight on at its ends. Its
place on the way is the arc length of its middle; its body extends half its length to either side.
Before the way begins, the place is the negative distance to it.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.extraction.computed_once import KeepsResults, kept
from rulec.extraction.tracks.at_junctions.junctions import (
    Interval,
    Junction,
    JunctionWay,
    extended,
    junctions_of,
    places_along,
)
from rulec.extraction.tracks.matching.junction_stays import Stay, body_length, junction_stays
from rulec.extraction.tracks.tracks import Tracks
from rulec.recordings.polylines import line_length
from rulec.recordings.recording import Points, Recording
from rulec.recordings.track import TrackOutlines, outlines_on_track
from rulec.scenario.recorded.reference_line import turn

_FARTHEST_M = 2.5
"""A participant whose average distance (m) from a way's middle line is larger is not on it."""

_SURE_M = 0.4
"""A way is certain if every way that parts from it is farther away by at least this (m)."""

_LARGEST_TURN = np.pi / 3

_ALONG = np.radians(15.0)

_ALIKE = 0.5
"""Ways whose turns differ by less than this (rad) lead to the same road."""


@dataclass(frozen=True, eq=False)
class Passage:
    """A participant's passage of a junction, in columns ``first`` to ``last`` inclusive.

    ``way`` is the number of the way; ``sure`` is False if it may be another one. ``heading`` is the
    direction (rad) of approach when the front got there: the participant may have turned by the
    time its middle is in the junction.
    """

    row: int
    junction: int
    way: int
    sure: bool
    first: int
    last: int
    heading: float


@dataclass(frozen=True, eq=False)
class JunctionPassages(KeepsResults):
    """All passages of a recording, by participant and by junction.

    ``astray``: by junction, row and first and last column of participants in it on no way.
    """

    tracks: Tracks
    junctions: tuple[Junction, ...]
    of_row: Mapping[int, tuple[Passage, ...]]
    through: Mapping[int, tuple[Passage, ...]]
    astray: Mapping[int, tuple[tuple[int, int, int], ...]]

    @cached_property
    def lengths(self) -> Floats:
        """The participants' lengths (m)."""
        bodies = self.tracks.participants
        found = np.empty(len(bodies))
        rigid: dict[int, TrackOutlines] = {}
        for row, body in enumerate(bodies):
            outlines = outlines_on_track(body)
            if outlines is None:
                found[row] = body_length(body)
            else:
                rigid[row] = outlines
        if rigid:
            # Computed one by one they take ten times as long
            way = np.array([own.track.rows[0, 2] for own in rigid.values()])
            corners = np.array([own.laid_out[0] for own in rigid.values()])
            ahead = corners @ np.stack((np.cos(way), np.sin(way)), axis=-1)[:, :, None]
            found[list(rigid)] = np.ptp(ahead[:, :, 0], axis=1)
        return found

    @cached_property
    def travelled(self) -> Floats:
        """The distance (m) that each participant has travelled by each step."""
        steps = np.hypot(np.diff(self.tracks.x, axis=1), np.diff(self.tracks.y, axis=1))
        first = np.zeros((len(steps), 1))
        return np.concatenate((first, np.nancumsum(steps, axis=1)), axis=1)

    @cached_property
    def _areas(self) -> shapely.STRtree:
        return shapely.STRtree([junction.area for junction in self.junctions])

    def and_one(self, other: JunctionPassages, row: int, tracks: Tracks) -> JunctionPassages:
        """These passages, followed by those of one row of ``other``; ``tracks`` are of both."""
        own, last = other.of_row.get(row, ()), len(self.tracks.participants)
        of_row, through = dict(self.of_row), dict(self.through)
        moved = tuple([replace(passage, row=last) for passage in own])
        if moved:
            of_row[last] = moved
        for passage in moved:
            through[passage.junction] = (*through.get(passage.junction, ()), passage)
        astray = dict(self.astray)
        for junction, found in other.astray.items():
            strays = tuple([(last, first, end) for own, first, end in found if own == row])
            if strays:
                astray[junction] = (*astray.get(junction, ()), *strays)
        joined = JunctionPassages(tracks, self.junctions, of_row, through, astray)
        # Facts about the map and about each row need not be derived again
        joined.__dict__["_areas"] = self._areas
        joined.__dict__["_first_meetings"] = self._first_meetings
        fronts = zip(moved, map(other.front_enters.__getitem__, own), strict=True)
        joined.__dict__["front_enters"] = {**self.front_enters, **dict(fronts)}
        for name in ("lengths", "travelled"):
            values = getattr(self, name), getattr(other, name)[row : row + 1]
            joined.__dict__[name] = np.concatenate(values)
        return joined

    def crosses_junction(self, start: tuple[float, float], end: tuple[float, float]) -> bool:
        """Whether a straight line leads through a junction."""
        line = shapely.LineString([start, end])
        return len(self._areas.query(line, predicate="intersects")) > 0

    def touched_by(self, outlines: Sequence[Points | None]) -> list[list[int]]:
        """The numbers of the junctions that each body touches; none where it is absent."""
        touched: list[list[int]] = [[] for _ in outlines]
        there = [(number, own) for number, own in enumerate(outlines) if own is not None]
        if there:
            owners = np.arange(len(there)).repeat([len(own) for _, own in there])
            rings = shapely.linearrings(np.concatenate([own for _, own in there]), indices=owners)
            found = self._areas.query(shapely.polygons(rings), "intersects")
            for at, junction in found.T.tolist():
                touched[there[at][0]].append(junction)
        return touched

    @cached_property
    def _first_meetings(self) -> dict[str, float]:
        """Lanelet -> the first place (m) on it where other ways cross or join it, if any."""
        first: dict[str, float] = {}
        for junction in self.junctions:
            for own, way in enumerate(junction.ways):
                others = range(len(junction.ways))
                met = [x[0][0] for other in others if (x := junction.meeting(own, other))]
                begins = 0.0
                for lanelet in way.lanelets:
                    length = line_length(lanelet.centre)
                    inside = [place - begins for place in met if place - begins < length]
                    if inside:
                        place = max(min(inside), 0.0)
                        first[lanelet.id] = min(first.get(lanelet.id, place), place)
                    begins += length
        return first

    def first_meeting(self, lanelet: str) -> float | None:
        """The first place (m) on a lanelet where other ways cross or join it, or None."""
        return self._first_meetings.get(lanelet)

    def way(self, passage: Passage) -> JunctionWay:
        """The way of a passage."""
        return self.junctions[passage.junction].ways[passage.way]

    @kept
    def occupied(self, passage: Passage, interval: Interval) -> tuple[float | None, float | None]:
        """When (in columns) its front reaches an interval of its way, and its rear has passed it.

        Interpolated between columns; None where the recording ends before.
        """
        low, high = interval
        half = self.lengths[passage.row] / 2
        middle, first = self._places(passage), self.front_enters[passage]
        # The front of a long body gets there long before its middle is in the junction
        travelled = self.travelled[passage.row]
        came = travelled[passage.first] - travelled[first : passage.first]
        middle = np.concatenate((middle[0] - came, middle))
        return tuple(  # type: ignore[return-value]
            None if (at := _gets_to(ends, place)) is None else first + at
            for ends, place in ((middle + half, low), (middle - half, high))
        )

    def left_to(self, passage: Passage, place: float) -> float:
        """How far (m) its front is before a place on its way when its track ends."""
        front = self._places(passage)[-1] + self.lengths[passage.row] / 2
        return max(place - float(front), 0.0)

    @cached_property
    def front_enters(self) -> Mapping[Passage, int]:
        """``front_came`` for the first column of each passage."""
        passages = (passage for own in self.of_row.values() for passage in own)
        return {passage: self.front_came(passage.row, passage.first) for passage in passages}

    def front_came(self, row: int, first: int) -> int:
        """The last column in which one was at least half its length before where it is in another.

        The column in which its track begins, if there is none.
        """
        absent = (~self.tracks.present[row, :first]).nonzero()[0]
        begin = int(absent[-1]) + 1 if len(absent) else 0
        came = self.travelled[row, first] - self.travelled[row, begin:first]
        return begin + max(int((came >= self.lengths[row] / 2).sum()) - 1, 0)

    def _places(self, passage: Passage) -> Floats:
        """Arc lengths (m) along the way, from the passage's first column to the track's end."""
        line = self.way(passage).line
        last = passage.last
        row = self.tracks.present[passage.row]
        own = slice(passage.first, last + 1)
        places = shapely.points(self.tracks.x[passage.row, own], self.tracks.y[passage.row, own])
        inside = np.maximum.accumulate(places_along(line, places))
        end = last + 1 + int((~np.append(row[last + 1 :], False)).argmax())
        beyond = self.travelled[passage.row, last + 1 : end] - self.travelled[passage.row, last]
        return np.concatenate((inside, inside[-1] + beyond))


def _gets_to(places: Floats, place: float) -> float | None:
    """When, in indices of ascending ``places``, a place is reached; None if it never is."""
    beyond = places >= place
    if not beyond.any():
        return None
    after = int(beyond.argmax())
    if after == 0:
        return 0.0
    before, step = places[after - 1], places[after] - places[after - 1]
    return float(after - 1 + (place - before) / step) if step > 0 else float(after)


def junction_passages(
    recording: Recording, tracks: Tracks, junctions: tuple[Junction, ...] | None = None
) -> JunctionPassages:
    """The passages of all participants that move on wheels.

    ``junctions`` are those of the map, if already known.
    """
    if junctions is None:
        junctions = junctions_of(recording)
    of_row: dict[int, list[Passage]] = defaultdict(list)
    through: dict[int, list[Passage]] = defaultdict(list)
    astray: dict[int, list[tuple[int, int, int]]] = defaultdict(list)
    areas = [junction.area for junction in junctions]
    for stay in junction_stays(areas, tracks, recording.step_s):
        passage = _passage(junctions[stay.junction].ways, tracks, stay)
        if passage is None:
            astray[stay.junction].append((stay.row, stay.first, stay.last))
        else:
            of_row[stay.row].append(passage)
            through[stay.junction].append(passage)
    ordered = {
        row: tuple(sorted(passages, key=lambda passage: passage.first))
        for row, passages in of_row.items()
    }
    by_junction = {number: tuple(passages) for number, passages in through.items()}
    strays = {number: tuple(found) for number, found in astray.items()}
    return JunctionPassages(tracks, junctions, ordered, by_junction, strays)


def _is_alike(one: JunctionWay, other: JunctionWay, place: shapely.Point) -> bool:
    """Whether two ways lead to the same road, or are the same up to a place."""
    same_road = abs(one.turned - other.turned) < _ALIKE
    return same_road or _lanelets_until(one, place) == _lanelets_until(other, place)


def _lanelets_until(way: JunctionWay, place: shapely.Point) -> tuple[str, ...]:
    """The lanelets of a way up to the one whose middle line is nearest to a place."""
    away = shapely.distance([shapely.LineString(x.centre) for x in way.lanelets], place)
    return tuple(lanelet.id for lanelet in way.lanelets[: int(np.argmin(away)) + 1])


def _touches(tracks: Tracks, row: int, columns: tuple[int, int]) -> bool:
    """Whether a participant's middle is in a junction too briefly to tell which way it takes.

    The middle of a long vehicle that cuts a corner may be nearer to other ways than to its own.
    """
    first, last = columns
    x, y = tracks.x[row, first : last + 1], tracks.y[row, first : last + 1]
    body = tracks.participants[row]
    return float(np.hypot(np.diff(x), np.diff(y)).sum()) < body_length(body) / 2


def _heading(tracks: Tracks, row: int, first: int, way: JunctionWay) -> float:
    """A participant's direction half its length before its place in column ``first``.

    The direction in which its way begins, if it was not recorded there.
    """
    body, x, y = tracks.participants[row], tracks.x[row], tracks.y[row]
    half = body_length(body) / 2
    for column in range(first, -1, -1):
        if not tracks.present[row, column]:
            break
        if np.hypot(x[column] - x[first], y[column] - y[first]) >= half:
            return float(tracks.heading[row, column])
    return way.headings[0]


def _may_use(way: JunctionWay, tracks: Tracks, row: int) -> bool:
    """Road vehicles stay off ways for rails alone; trams also run on lanes that others share."""
    return not way.on_rails or _on_rails(tracks, row)


def _on_rails(tracks: Tracks, row: int) -> bool:
    return "rail_vehicle" in tracks.participants[row].object_types


def _follows(tracks: Tracks, stay: Stay, way: JunctionWay) -> bool:
    """Whether a rail vehicle is in its way's direction at both ends of it.

    Such a body cuts no corner, however long it is.
    """
    ends = tracks.heading[stay.row, [stay.first, stay.last]]
    return _on_rails(tracks, stay.row) and bool(
        (np.abs(turn(np.array(way.headings), ends)) < _ALONG).all()
    )


def _passage(ways: Sequence[JunctionWay], tracks: Tracks, stay: Stay) -> Passage | None:
    row, first, last = stay.row, stay.first, stay.last
    own = slice(first, last + 1)
    points = shapely.points(tracks.x[row, own], tracks.y[row, own])
    begins, ends = float(tracks.heading[row, first]), float(tracks.heading[row, last])
    away = np.full(len(ways), np.inf)
    present = tracks.present[row]
    whole = first > 0 and last + 1 < len(present) and bool(present[first - 1] and present[last + 1])
    headings = np.reshape([way.headings for way in ways], (-1, 2))
    fits = np.abs(turn(headings, np.array([begins, ends]))) < _LARGEST_TURN
    along = fits[:, 0] & (fits[:, 1] | (not whole))
    fitting = [k for k in along.nonzero()[0].tolist() if _may_use(ways[k], tracks, row)]
    # Where a lane and a track are as near, a train is on the track
    rather = [_SURE_M * (_on_rails(tracks, row) and not way.on_rails) for way in ways]
    for longer in (not stay.seen, True):
        for number in fitting:
            line = ways[number].line
            line = extended(line, points) if longer else line
            away[number] = shapely.distance(line, points).mean()
        best = int(np.argmin(away + rather)) if len(away) else 0
        if fitting and away[best] <= _FARTHEST_M:
            break
    else:
        return None
    close: NDArray[intp] = (away < away[best] + _SURE_M).nonzero()[0]
    sure = whole or all(_is_alike(ways[k], ways[best], points[-1]) for k in close.tolist())
    if whole and _touches(tracks, row, (first - 1, last + 1)):
        sure = _follows(tracks, stay, ways[best])
    return Passage(
        row=row,
        junction=stay.junction,
        way=best,
        # Nobody saw how one turned that was in the junction between two states only
        sure=sure and (stay.seen or abs(turn(begins, ends)) < _ALIKE),
        first=first,
        last=last,
        heading=_heading(tracks, row, first, ways[best]),
    )
