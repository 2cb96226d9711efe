"""The road under a matched path: lanelets end to end, whose lanes ego may have left.

A change of lanes does not leave the road, so one lanelet is chosen from each row of lanes: those
that lead to each other and from which ego was fewest lanes away. Where lanes merge, the one in
which ego came is chosen: otherwise ego would seem to change lanes there. Where no such lanelets
lead all the way, as after a turn into one lane and before a turn from another, the road itself
changes lanes, in a lanelet as long as possible. It also does where a drive ends that has left a
lane which ends, because it goes on beside that lane, and where one begins in the same way.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise

from rulec.extraction.tracks.matching.lanelet_graph import LaneletGraph
from rulec.extraction.tracks.matching.map_matching import MatchedStretch
from rulec.recordings.recording import Recording

_SHIFT_COST, _SHORT_COST, _OTHER_WAY_COST = 1e6, 1e5, 1e4


@dataclass(frozen=True, slots=True)
class RouteStretch:
    """The states of a drive along one road, and its lanelets, each beside or after the one before.

    ``pieces``: for each of the ``columns`` the number of the row of lanes there. ``against``:
    whether all lanes lead the other way.
    """

    columns: tuple[int, ...]
    route: tuple[str, ...]
    pieces: tuple[int, ...]
    against: bool = False

    @property
    def first(self) -> int:
        """The first column."""
        return self.columns[0]

    @property
    def last(self) -> int:
        """The last column."""
        return self.columns[-1]


@dataclass(frozen=True, slots=True)
class _Row:
    """Lanes beside each other, with their lengths (m).

    ``away`` is, for each lane, the sum over states of how many lanes ego is away from it;
    ``entered`` is the lane in which ego comes there, ``left`` the one from which it goes on.
    """

    lanes: tuple[str, ...]
    away: tuple[int, ...]
    lengths: tuple[float, ...]
    entered: str
    left: str


@dataclass(frozen=True, slots=True)
class _Choice:
    """The cheapest choice of lanelets up to the exit of a row."""

    cost: float
    lanelets: tuple[str, ...]


def pieces_of(
    recording: Recording, route: Sequence[str], beside: Callable[[str, str], bool]
) -> tuple[tuple[str, ...], ...]:
    """A route's lanelets by row: a single one, or those between which it changes lanes.

    ``beside`` tests whether a lane is beside another one.
    """
    pieces: list[tuple[str, ...]] = []
    for lanelet in route:
        last = pieces[-1][-1] if pieces else None
        leads = last is not None and lanelet in recording.lanelets[last].successors
        if last is not None and not leads and lanelet != last and beside(last, lanelet):
            pieces[-1] = (*pieces[-1], lanelet)
        else:
            pieces.append((lanelet,))
    return tuple(pieces)


def route_stretches(
    recording: Recording, matched: MatchedStretch, graph: LaneletGraph
) -> Iterator[RouteStretch]:
    """The roads of a matched stretch: a single one if the map is consistent."""
    pieces = pieces_of(recording, matched.chain, graph.beside)
    piece_of = [k for k, piece in enumerate(pieces) for _ in piece]
    at = matched.places
    if len(pieces) < len(piece_of):
        at = tuple([piece_of[place] for place in at])
    if len(set(at)) == len(pieces) and _leads_on(recording, pieces):
        # If ego was in each piece and changed no lanes, it drove nowhere else
        yield RouteStretch(matched.columns, matched.chain, at)
        return
    counts: Counter[tuple[int, str]] = Counter()
    for place, count in Counter(matched.places).items():
        counts[piece_of[place], matched.chain[place]] += count
    rows = []
    for number, piece in enumerate(pieces):
        lanes = graph.row(piece[0])
        states = [counts[number, lane] for lane in lanes]
        away = [
            sum([count * abs(k - own) for k, count in enumerate(states)])
            for own in range(len(lanes))
        ]
        rows.append(_Row(lanes, tuple(away), tuple(map(graph.length, lanes)), piece[0], piece[-1]))
    start = 0
    while start < len(rows):
        stop, route = _cheapest(recording, rows, start)
        route = _led_over(recording, rows[start:stop], route)
        own = [k for k, piece in enumerate(at) if start <= piece < stop]
        if start == 0 and len(own) == len(at):
            yield RouteStretch(matched.columns, route, at)
        elif own:
            columns = tuple([matched.columns[k] for k in own])
            yield RouteStretch(columns, route, tuple([at[k] - start for k in own]))
        start = stop


def _led_over(
    recording: Recording, rows: Sequence[_Row], route: tuple[str, ...]
) -> tuple[str, ...]:
    """A route, from or to the lane beside that ego drove in where its own has no other beyond it.

    Otherwise the road would begin or end there, as beside the end of a lane that joins others.
    """
    lanelets = recording.lanelets
    before, after = rows[0].entered, rows[-1].left
    begins = not lanelets[route[0]].predecessors and lanelets[before].predecessors
    if begins and before not in route[:2]:
        route = (before, *route)
    ends = not lanelets[route[-1]].successors and lanelets[after].successors
    if ends and after not in route[-2:]:
        route = (*route, after)
    return route


def _leads_on(recording: Recording, pieces: Sequence[Sequence[str]]) -> bool:
    """Whether no piece changes lanes and each leads to the next."""
    if any(len(piece) > 1 for piece in pieces):
        return False
    lanelets = recording.lanelets
    return all(end[0] in lanelets[start[0]].successors for start, end in pairwise(pieces))


def _cheapest(
    recording: Recording, rows: Sequence[_Row], start: int
) -> tuple[int, tuple[str, ...]]:
    """The number of the row after the last one reached, and the lanelets up to there."""
    best: dict[str, _Choice] = {}
    for number in range(start, len(rows)):
        row = rows[number]
        entries = {
            lane: choice
            for lane in row.lanes
            if (choice := _entry(recording, best, lane, rows[start : number + 1][-2:])) is not None
        }
        if not entries:
            return number, _least(best).lanelets
        best = {
            lane: min(
                (_through(row, entry, lane, choice) for entry, choice in entries.items()),
                key=lambda choice: (choice.cost, choice.lanelets),
            )
            for lane in row.lanes
        }
    return len(rows), _least(best).lanelets


def _least(best: dict[str, _Choice]) -> _Choice:
    return min(best.values(), key=lambda choice: (choice.cost, choice.lanelets))


def _entry(
    recording: Recording, best: dict[str, _Choice], lane: str, rows: Sequence[_Row]
) -> _Choice | None:
    """The cheapest entry into a lane of the last row, from the row before if there is one."""
    if len(rows) == 1:
        return _Choice(0.0, ())
    before, row = rows
    leading = []
    for exit_, choice in best.items():
        if lane in recording.lanelets[exit_].successors:
            # Joins the lane in which ego came, but from another lane than ego's
            other_way = lane == row.entered and exit_ != before.left
            cost = choice.cost + _OTHER_WAY_COST * other_way
            leading.append(_Choice(cost, choice.lanelets))
    return min(leading, key=lambda choice: (choice.cost, choice.lanelets), default=None)


def _through(row: _Row, entry: str, lane: str, choice: _Choice) -> _Choice:
    own, other = row.lanes.index(entry), row.lanes.index(lane)
    if entry == lane:
        return _Choice(choice.cost + row.away[own], (*choice.lanelets, lane))
    changes, length = abs(own - other), row.lengths[own]
    shift = changes * (_SHIFT_COST + _SHORT_COST / max(length, 1.0))
    away = min(row.away[own], row.away[other])
    return _Choice(choice.cost + shift + away, (*choice.lanelets, entry, lane))
