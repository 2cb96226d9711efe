"""Lanes cut where neighbours or markings begin or end, so that pieces are beside whole pieces."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import pairwise

from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.lane_centres.road_features import (
    CentreLane,
    LaneSide,
    NeighbourPart,
)
from rulec.recordings.polylines import arc_lengths
from rulec.recordings.recording import LaneMark

SHORTEST_BESIDE_M = 8.0
"""Lanes that run side by side for less (m), as at forks, are not cut there."""

SHORTEST_PIECE_M = 5.0
WHOLE = 0.75
"""Pieces that run side by side for at least this share of both are neighbours."""


@dataclass(frozen=True, slots=True)
class LanePiece:
    """A part of a lane between two points of its centre line."""

    id: str
    start: int
    end: int


def pieces_of_lanes(
    lanes: Mapping[str, CentreLane], stretches: Mapping[str, tuple[int, int]]
) -> dict[str, tuple[LanePiece, ...]]:
    """The pieces of each lane, from its start on; an uncut lane keeps its id.

    ``stretches``: parts of lanes that must be pieces, too.
    """
    reach = {name: arc_lengths(lane.centre[:, :2]) for name, lane in lanes.items()}
    cuts: dict[str, set[int]] = defaultdict(set)
    waiting = [(name, index) for name, lane in lanes.items() for index in _ends(lane, reach[name])]
    waiting += [(name, index) for name, stretch in stretches.items() for index in stretch]
    while waiting:
        name, index = waiting.pop()
        along, own = reach[name], cuts[name]
        ends = (0, len(along) - 1, *own)
        if min(abs(along[index] - along[other]) for other in ends) < SHORTEST_PIECE_M:
            continue
        own.add(index)
        waiting += [pair for pair in _beside(lanes[name], index) if pair[0] in lanes]
    return {name: tuple(_pieces(name, cuts[name], len(reach[name]))) for name in lanes}


def _ends(lane: CentreLane, along: NDArray[float64]) -> Iterator[int]:
    """The indices where neighbours of a lane, or kinds of markings, begin and end."""
    for side in (lane.left, lane.right):
        for part in side.neighbours:
            if along[part.end] - along[part.start] >= SHORTEST_BESIDE_M:
                yield from (part.start, part.end)
        for before, after in pairwise(sorted(side.boundaries, key=lambda part: part.start)):
            if before.mark != after.mark:
                yield after.start


def _beside(lane: CentreLane, index: int) -> Iterator[tuple[str, int]]:
    for part in (*lane.left.neighbours, *lane.right.neighbours):
        if part.start < index < part.end:
            yield part.lane, _point_beside(part, index)


def _point_beside(part: NeighbourPart, index: int) -> int:
    """The index on a neighbour's centre line that is beside the lane's point ``index``."""
    share = (index - part.start) / max(part.end - part.start, 1)
    return round(part.other_start + share * (part.other_end - part.other_start))


def _pieces(name: str, cuts: set[int], count: int) -> Iterator[LanePiece]:
    ends = [0, *sorted(cuts), count - 1]
    for number, (start, end) in enumerate(pairwise(ends), 1):
        yield LanePiece(name if len(ends) == 2 else f"{name}.{number}", start, end)


def neighbours_of_pieces(
    lanes: Mapping[str, CentreLane], pieces: Mapping[str, tuple[LanePiece, ...]]
) -> dict[str, str]:
    """Piece -> the piece to its left; each is the left neighbour of at most one piece."""
    shares: dict[tuple[str, str], float] = {}
    for name, lane in lanes.items():
        for side, is_left in ((lane.left, True), (lane.right, False)):
            for part in side.neighbours:
                for piece in pieces[name]:
                    for other, share in _shares(piece, part, pieces.get(part.lane, ())):
                        pair = (piece.id, other.id) if is_left else (other.id, piece.id)
                        shares[pair] = max(share, shares.get(pair, 0.0))
    left_of: dict[str, str] = {}
    taken: set[str] = set()
    for (right, left), _ in sorted(shares.items(), key=lambda item: (-item[1], item[0])):
        if right not in left_of and left not in taken and left_of.get(left) != right:
            left_of[right] = left
            taken.add(left)
    return left_of


def _shares(
    piece: LanePiece, part: NeighbourPart, others: tuple[LanePiece, ...]
) -> Iterator[tuple[LanePiece, float]]:
    """The pieces of a neighbour beside a piece, with the lesser share of both that is shared."""
    start, end = max(piece.start, part.start), min(piece.end, part.end)
    own = (end - start) / (piece.end - piece.start)
    if own < WHOLE:
        return
    low, high = sorted((_point_beside(part, start), _point_beside(part, end)))
    for other in others:
        both = min(other.end, high) - max(other.start, low)
        share = both / (other.end - other.start)
        if share >= WHOLE and both >= WHOLE * (high - low):
            yield other, min(own, share)


def mark_of(side: LaneSide, piece: LanePiece) -> LaneMark | None:
    """The mark of a piece's side; None unless one kind covers nearly all of it."""
    lengths: dict[LaneMark | None, int] = defaultdict(int)
    for part in side.boundaries:
        lengths[part.mark] += max(0, min(part.end, piece.end) - max(part.start, piece.start))
    mark = max(lengths, key=lambda kind: lengths[kind], default=None)
    return mark if lengths[mark] >= WHOLE * (piece.end - piece.start) else None
