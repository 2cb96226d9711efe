"""Roads cut into pieces, on each of which a lane is one lanelet.

A lanelet has one limit, one mark on each side and one kind of surroundings. Lane sections are
therefore cut where these change, and at signs that apply from there on.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import NamedTuple

import numpy as np

from rulec.recordings.opendrive.content.elements import LaneSection, MapRoad
from rulec.recordings.opendrive.lane_types import BOTH_WAYS, marks_of

SHORTEST_M = 1.0
"""Changes closer than this to another cut or an end of the section get no cut of their own."""

NO_LENGTH_M = 0.01
"""Shorter lane sections have no lanelets; their lanes lead on to the next ones."""

LONGEST_PIECE_M = 5_000.0
"""Longer lane sections are cut."""


@dataclass(frozen=True, slots=True, eq=False)
class RoadPiece:
    """A part of a lane section from ``start`` to ``end``, with its number on the road."""

    road: MapRoad
    number: int
    section: LaneSection
    start: float
    end: float

    @property
    def middle(self) -> float:
        """The middle of the piece; properties of the piece are taken from there."""
        return (self.start + self.end) / 2

    @property
    def is_short(self) -> bool:
        """Whether the piece is too short for lanelets."""
        return self.end - self.start < NO_LENGTH_M

    def directions(self, lane: int) -> tuple[bool, ...]:
        """The driving directions of a lane: True along the road, False against it."""
        own = self.section.lanes[lane]
        usual = (lane < 0) != self.road.left_hand
        if own.direction == "both" or own.type == BOTH_WAYS:
            return usual, not usual
        return (not usual,) if own.direction == "reversed" else (usual,)


Pieces = Mapping[str, Sequence[RoadPiece]]
"""Road -> its pieces in the order of ``s``."""


class LaneKey(NamedTuple):
    """A lane of a piece of a road, in one of its driving directions."""

    piece: RoadPiece
    lane: int
    forward: bool

    @property
    def is_driven(self) -> bool:
        """Whether there is such a lane, and traffic in this direction."""
        there = self.lane in self.piece.section.lanes
        return there and self.forward in self.piece.directions(self.lane)

    @property
    def name(self) -> str:
        """The id of its lanelet: road, piece and lane, with ``.r`` for its other direction."""
        usual, *_ = self.piece.directions(self.lane)
        name = f"{self.piece.road.id}.{self.piece.number}.{self.lane}"
        return name + ("" if self.forward == usual else ".r")

    @property
    def back(self) -> LaneKey:
        """The same lane in the other direction."""
        return self._replace(forward=not self.forward)

    @property
    def start(self) -> float:
        """The ``s`` at which traffic enters it."""
        return self.piece.start if self.forward else self.piece.end

    def beside(self, *, left: bool) -> LaneKey:
        """What would be the lane beside it, in its direction."""
        step = 1 if left == self.forward else -1
        return self._replace(lane=self.lane + step or step)


def pieces_of(road: MapRoad, signs: Iterable[float]) -> list[RoadPiece]:
    """The pieces of a road; ``signs`` are the places of signals at which it is cut."""
    pieces: list[RoadPiece] = []
    wanted = [x for ends in road.tunnels for x in (ends.start, ends.end)]
    wanted += [kind.start for kind in road.types] + list(signs)
    for section in road.sections:
        cuts = sorted({*wanted, *_changes(section)})
        places = [section.start]
        for cut in cuts:
            if places[-1] + SHORTEST_M <= cut <= section.end - SHORTEST_M:
                places.append(cut)
        places.append(section.end)
        for start, end in pairwise(places):
            count = max(1, int(np.ceil((end - start) / LONGEST_PIECE_M)))
            for low, high in pairwise(np.linspace(start, end, count + 1).tolist()):
                pieces.append(RoadPiece(road, len(pieces), section, low, high))
    return pieces


def _changes(section: LaneSection) -> Iterator[float]:
    for lane in section.lanes.values():
        before = None
        for mark in lane.marks:
            if (own := marks_of(mark)) != before:
                yield section.start + mark.start
            before = own
        yield from (section.start + speed.start for speed in lane.speeds)
        yield from (section.start + access.start for access in lane.access)
