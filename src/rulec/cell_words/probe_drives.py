"""Drives that probe extraction for its words: along every lane, and at several speeds."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from itertools import pairwise
from math import ceil, inf
from typing import Any, TypeAlias

import numpy as np

from rulec.array_types import Floats
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.cell_words.ego_boxes import body_size
from rulec.diagnostics import RulecError
from rulec.extraction.candidate_drives import CandidateDrives
from rulec.extraction.presences import participant_called
from rulec.extraction.recording_verdicts import names_read
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.extraction.traces.to_trace import TraceWriter
from rulec.extraction.traffic_thresholds import USUAL
from rulec.partition import NavigationGraph
from rulec.recordings.recording import HEADINGS, Participant, Recording, Side
from rulec.recordings.track import Track, TrackOutlines, TrackStates
from rulec.scenario.recorded.lane_coordinates import borders_along
from rulec.scenario.recorded.route import lanes_beside, turns_back
from rulec.scenario.recorded.scene_origin import SceneOrigin

EVERY_M = 1.0
"""Distance (m) of probed places along a lane; less where something on it is shorter."""

_BEFORE_M, _BEYOND_M = 30.0, 30.0
_SPEEDS_MPS = (0.0, -10.0, 10.0)
"""Speeds of the drives, relative to ego's."""

_ON_S, _ON_MPS, _ON_MPS2 = 8.0, 10.0, 3.0
"""How long drives go on, how fast, and their greatest acceleration meanwhile."""

Row: TypeAlias = tuple[Floats, Floats, Floats]
"""s and d (m) in the scene, and the direction relative to the road's (rad), by state."""


@dataclass(frozen=True, slots=True, eq=False)
class LaneProbe:
    """The extracted words of a drive along the middle of a lane, and requested ones about others.

    ``s`` (m) are the scene's coordinates of its ``states``, ascending.
    """

    lane: int
    s: Floats
    states: Sequence[Mapping[str, Any]]


@dataclass(frozen=True, slots=True, eq=False)
class TimedProbe:
    """The extracted words of a drive through the time of the graph.

    ``first`` is the recording's time step of the first of its ``states``.
    """

    first: int
    states: Sequence[Mapping[str, Any]]


@dataclass(frozen=True, slots=True, eq=False)
class ProbeDrives:
    """The drives of a scene, and what they are made in.

    ``told`` are the names that the recording supplies, ``faults`` those that a fault of rulec has
    cost. ``stretches`` are those of the lanes that
    were probed: the lane, and from where to where (m) it exists.
    """

    among: CandidateDrives
    origin: SceneOrigin
    lanes: tuple[LaneProbe, ...]
    timed: tuple[TimedProbe, ...]
    told: frozenset[str]
    faults: Mapping[str, RulecError]
    stretches: tuple[tuple[int, float, float], ...]

    @property
    def recording(self) -> Recording:
        """The recording."""
        return self.origin.recording

    def column(self, seconds: float) -> float:
        """The column of a scene's time in arrays of all steps, possibly between two."""
        step = self.origin.start.step + seconds / self.recording.step_s
        return step - self.among.span[0]


def driver(origin: SceneOrigin) -> Participant:
    """Ego as a participant without states: the one that it replaces, else a car with a new name."""
    for body in origin.recording.participants:
        if body.id == origin.start.participant:
            return replace(body, states={}, outlines={}, lamps={})
    taken = {body.id for body in origin.recording.participants}
    name = "ego"
    while name in taken:
        name += "_"
    return Participant(name, "car", False, {}, {})


def body_along(graph: NavigationGraph, origin: SceneOrigin, row: Row, speed: Floats) -> Participant:
    """Ego's body at places of the scene, with a state for each time step from time 0 on."""
    s, d, turned = row
    places, directions = origin.places(s, d)
    rows = np.column_stack((places, directions + turned, speed, np.zeros(len(s))))
    first = origin.start.step
    steps = np.arange(first, first + len(s), dtype=np.int64)
    track = Track(steps, rows, *body_size(graph))
    ego = driver(origin)
    return replace(ego, states=TrackStates(track), outlines=TrackOutlines(track))


def world_of(origin: SceneOrigin, ego: Participant, side: Side, steps: int) -> CandidateDrives:
    """The others of the recording, for drives of ego with this number of steps."""
    recording, first = origin.recording, origin.start.step
    others = tuple(body for body in recording.participants if body.id != origin.start.participant)
    own = [list(body.outlines) for body in others if not body.standing]
    ends = [(min(there), max(there)) for there in own if there]
    span = (
        min([first, *(low for low, _ in ends)]),
        max([first + steps, *(high for _, high in ends)]),
    )
    complete = recording.complete | {HEADINGS}
    among = replace(recording, participants=(*others, ego), complete=complete)
    return CandidateDrives(among, side, USUAL, span)


def probe_drives(
    graph: NavigationGraph,
    origin: SceneOrigin,
    rules: CompiledRulebook,
    side: Side,
    of_others: frozenset[str],
    *,
    in_time: frozenset[str] = frozenset(),
    measured: frozenset[str] = frozenset(),
) -> ProbeDrives:
    """Probe extraction for all the words that rules read.

    ``of_others`` are the words about others that are kept from drives along lanes; ``in_time`` are
    those that are also probed along the roads of lanes that ego may change to. Bounds of
    ``measured`` words are not kept.
    """
    step_s = origin.recording.step_s
    reach = [own.s for row in graph.reach for own in row if own is not None]
    low = min((s for s, _ in reach), default=graph.scenario.road.s[0]) - _BEFORE_M
    high = max((s for _, s in reach), default=graph.scenario.road.s[1]) + _BEYOND_M
    between = _between(origin)
    rows = list(_along_lanes(origin, _places(graph, origin, (low, high), between)))
    lanes = [lane for lane, _ in rows]
    bodies = [
        body_along(graph, origin, row, np.full(len(row[0]), EVERY_M / step_s)) for _, row in rows
    ]
    count = ceil((len(graph.layers) - 1) * graph.step_s / step_s - 1e-9) + 1
    beside = _lanes_beside(graph, origin) if in_time else ()
    n_timed = len(rows) + len(_SPEEDS_MPS)
    for row, speed in _through_time(graph, count, step_s, beside):
        # At least two states make a drive
        kept = max(int(np.searchsorted(row[0], between[1], side="right")), 2)
        row, speed = (row[0][:kept], row[1][:kept], row[2][:kept]), speed[:kept]
        bodies.append(body_along(graph, origin, row, speed))
    longest = max(len(body.states) for body in bodies)
    among = world_of(origin, bodies[0], side, longest)
    writer = TraceWriter(rules.vocabulary, names_read(rules))
    found = among.of(bodies, writer)
    lane_probes, timed, told = [], [], set[str]()
    faults: dict[str, RulecError] = {}
    ids = among.recording.ids
    for number, drives in enumerate(found):
        own = [drive for drive in drives if isinstance(drive, Drive)]
        for lost in drives:
            if isinstance(lost, NoDrive) and lost.fault is not None:
                raise lost.fault  # nobody knows what its words would have said
        for drive in own:
            faults |= drive.arrays.faults
            told |= drive.arrays.told or drive.words
            begins = drive.first_step - origin.start.step
            if number < len(lanes):
                s = rows[number][1][0][begins : begins + drive.arrays.n_states]
                # Writing all words about others takes long
                names = drive.arrays.world.keys() | (of_others & drive.arrays.about.keys())
                of_lane = drive.arrays.part(names, drive.arrays.objects.keys())
                lane_probes.append(LaneProbe(lanes[number], s, of_lane.trace().states))
            elif len(own) == 1:
                about = drive.arrays.about.keys()
                # Writing the bounds of numbers about others takes long, too
                bounded = measured & drive.arrays.bounds.keys()
                whole = drive.arrays.world.keys() | about - bounded
                part = drive.arrays.part(
                    whole if number < n_timed else in_time & about, drive.arrays.objects.keys()
                )
                timed.append(_timed(drive, part.trace().states, ids))
    return ProbeDrives(
        among=among,
        origin=origin,
        lanes=tuple(lane_probes),
        timed=tuple(timed),
        told=frozenset(told.difference(faults)),
        faults=faults,
        stretches=tuple((lane, float(row[0][0]), float(row[0][-1])) for lane, row in rows),
    )


def _timed(drive: Drive, states: Sequence[Mapping[str, Any]], ids: Set[str]) -> TimedProbe:
    """The probe with objects called by their ids: who comes again has another name in a drive."""
    id_of = {name: participant_called(name, ids) for name in drive.arrays.objects}
    if not id_of.keys() <= ids:
        states = [
            {
                word: {id_of[name]: own for name, own in value.items()}
                if isinstance(value, Mapping)
                else value
                for word, value in state.items()
            }
            for state in states
        ]
    return TimedProbe(drive.first_step, states)


def _between(origin: SceneOrigin) -> tuple[float, float]:
    """Places (m) between which vehicles can go on or come from; infinite where the road goes on.

    Beyond them they can only turn around: a body there is on its way back, along another road than
    the scene's.
    """
    recording = origin.recording

    def turns(name: str, way: int) -> bool:
        right, left = (lanes_beside(recording, name, left=left) for left in (False, True))
        lanes = [recording.lanelets[lane] for lane in (name, *right, *left)]
        return any(
            turns_back(lane, recording.lanelets[other], backwards=way < 0)
            for lane in lanes
            for other in (lane.successors if way > 0 else lane.predecessors)
            if other in recording.lanelets
        )

    return (
        -origin.ego_s if turns(origin.way[0], -1) else -inf,
        origin.line.length - origin.ego_s if turns(origin.way[-1], 1) else inf,
    )


def _places(
    graph: NavigationGraph,
    origin: SceneOrigin,
    reach: tuple[float, float],
    between: tuple[float, float],
) -> Floats:
    """Places within ``reach``, plus one in everything shorter than the distance between two.

    None lies outside ``between``.
    """
    low, high = reach
    lanelets = [origin.recording.lanelets[name] for name in origin.way]
    borders = borders_along(lanelets, origin.line) - origin.ego_s
    crossings = np.array([surface.s for surface in graph.scenario.road.surfaces]).ravel()
    # A vehicle with any part on a crossing is on it
    half = body_size(graph)[0] / 2
    there = origin.lanes.there
    begin_or_end = origin.lanes.s[1:-1][np.any(there[1:] != there[:-1], axis=1)] - origin.ego_s
    ends = np.concatenate((borders, begin_or_end, crossings, crossings - half, crossings + half))
    ends.sort()
    middles = ((ends[1:] + ends[:-1]) / 2)[np.diff(ends) <= EVERY_M]
    even = np.arange(low, high + EVERY_M, EVERY_M)
    begin, end = between
    last = [place for place in (begin, end) if low < place < high]
    places = np.unique(np.concatenate((even, middles[(middles > low) & (middles < high)], last)))
    return places[(places >= begin) & (places <= end)]


def _along_lanes(origin: SceneOrigin, s: Floats) -> Iterator[tuple[int, Row]]:
    """Along the middle of each lane, wherever it exists, in runs."""
    straight = origin.lanes.straight
    existing = origin.lanes.existing_at(s + origin.ego_s)
    for lane in range(len(straight) - 1):
        edges = np.flatnonzero(np.diff(existing[:, lane], prepend=False, append=False))
        for first, end in edges.reshape(-1, 2).tolist():
            if end - first > 2:
                middle = np.full(end - first, float(straight[lane] + straight[lane + 1]) / 2)
                yield lane, (s[first:end], middle, np.zeros(end - first))


def _lanes_beside(graph: NavigationGraph, origin: SceneOrigin) -> Iterator[float]:
    """The middles of lanes beside ego's, at its place, that it may change to."""
    reach = [own.d for row in graph.reach for own in row if own is not None]
    existing = origin.lanes.existing_at(np.array(origin.ego_s)).tolist()
    ego_d = graph.scenario.ego.d
    for (low, high), there in zip(pairwise(origin.lanes.straight.tolist()), existing, strict=True):
        is_own = low <= ego_d < high
        if there and not is_own and any(d[0] < high and d[1] > low for d in reach):
            yield (low + high) / 2


def _through_time(
    graph: NavigationGraph, count: int, step_s: float, beside: Iterable[float]
) -> Iterator[tuple[Row, Floats]]:
    """Along ego's lateral place, at its speed, slower and faster, and in lanes ``beside``.

    And then on along the road: only a drive that goes on shows which road it is on.
    """
    ego = graph.scenario.ego
    last = max(graph.scenario.road.s[1] - _BEYOND_M, 0.0)
    times: Floats = np.arange(count, dtype=np.float64) * step_s
    after: Floats = np.arange(1.0, round(_ON_S / step_s) + 1.0) * step_s
    for d, more in [*((ego.d, more) for more in _SPEEDS_MPS), *((d, 0.0) for d in beside)]:
        speed = max((ego.speed or 0.0) + more, 0.0)
        fast = max(speed, _ON_MPS)
        for_s: Floats = np.minimum(after, (fast - speed) / _ON_MPS2)
        on = speed * for_s + _ON_MPS2 * for_s**2 / 2 + fast * (after - for_s)
        s: Floats = np.concatenate((speed * times, speed * times[-1] + on)) + ego.s
        speeds = np.concatenate((np.full(count, speed), speed + _ON_MPS2 * for_s))
        kept = max(count, int(np.searchsorted(s, last)))
        yield (s[:kept], np.full(kept, d), np.zeros(kept)), speeds[:kept]
