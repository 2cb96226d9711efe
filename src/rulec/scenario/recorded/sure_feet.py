"""Feet that are provably a place's only ones, found by testing one guessed piece instead of all.

The fans of two neighbouring pieces are separated by a line through their common corner. Where no
two of these lines have met yet, a place is in one fan only, so a guessed piece whose fan contains
the place is the answer. Two tests prove that: the place is nearer to all pieces than any two lines
meet, or it is no farther aside than the two lines of its fan meet any other. Other places are left
to the full search.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy import bool_, intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.recording import Points
from rulec.scenario.recorded.borders import Borders

_INSIDE = 1e-3
"""Nearer to a piece's end (a part of its length) a foot is not sure to be the only one."""

_AT_ONCE = 1 << 13
"""Places processed per batch, so that intermediate arrays stay in the processor's cache."""

MANY = 256
"""For fewer places, trying all pieces is faster than computing ``PieceFans.alone``."""

_MOST_PIECES = 512
_HAIR_M = 1e-6
_ROUNDS = 2


@dataclass(frozen=True, eq=False)
class PieceFans:
    """Pieces of a line, one column each.

    Rows: direction (2), start (2) and length (m), the slope of the interpolated direction at the
    beginning and how much it changes, and the place along the line (m).
    """

    columns: Floats

    @cached_property
    def room(self) -> Floats:
        """How far (m) from a piece its fan has half the piece's length at least, minus that length.

        With the length subtracted, the distance can be measured from the piece's start.
        """
        lengths, change = self.columns[4], np.abs(self.columns[6])
        with np.errstate(divide="ignore", over="ignore"):
            room: Floats = lengths / (2 * change) - lengths
        return room

    @cached_property
    def alone(self) -> Floats:
        """How far (m) aside a piece's fan overlaps no other fan; 0 if there are many pieces.

        That is as far as both bounding lines of the fan meet none of the others.
        """
        lengths, first, change = self.columns[4:7]
        if len(lengths) > _MOST_PIECES:
            return np.zeros(len(lengths))
        # One bounding line through each corner
        ahead = self.columns[:2, [*range(len(lengths)), -1]]
        corners = self.columns[2:4, [*range(len(lengths)), -1]]
        corners[:, -1] += lengths[-1] * ahead[:, -1]
        slope = np.append(first, first[-1] + change[-1])
        across = np.hypot(1.0, slope)
        normals = (ahead + slope * np.array((-ahead[1], ahead[0]))) / across
        # How far each corner (row) is beyond each line, and its change along the corner's own line
        beyond = corners.T @ normals - (corners * normals).sum(axis=0)
        gained = np.abs(np.outer(normals[0], normals[1]) - np.outer(normals[1], normals[0]))
        beyond[np.triu_indices(len(slope), 1)] *= -1
        np.fill_diagonal(beyond, np.inf)
        with np.errstate(divide="ignore", over="ignore"):
            room: Floats = ((beyond - _HAIR_M) / gained).min(axis=1) / across
        alone: Floats = np.minimum(room[:-1], room[1:])
        return alone

    def at(self, s: Floats) -> NDArray[intp]:
        """The numbers of the pieces at places (m) along the line."""
        return self._borders.before(s)

    @cached_property
    def _borders(self) -> Borders:
        return Borders(self.columns[7])


def sure_feet(fans: PieceFans, places: Points) -> tuple[Points, NDArray[intp]]:
    """Frenet coordinates of the places whose only foot on the line is found, and their pieces.

    The number of a piece is -1 for other places.
    """
    coordinates = np.full(places.shape, np.nan)
    found = np.full(len(places), -1)
    # The first and last pieces are the straight extensions, so these are the line's own corners
    corners = fans.columns[2:4, 1:].T
    middle, room = corners.mean(axis=0), float(fans.room.min())
    farthest = float(np.abs(corners - middle).sum(axis=1).max())
    chord = corners[-1] - corners[0]
    length = float(np.hypot(*chord))
    # No guess for a line that ends where it begins: it has no chord
    if not length or (farthest >= room and len(places) < MANY):
        return coordinates, found
    ux, uy = (chord / length).tolist()
    first = float(fans.columns[7, 1])
    for begin in range(0, len(places), _AT_ONCE):
        part = slice(begin, begin + _AT_ONCE)
        x, y = places[part].T
        near = np.abs(x - middle[0]) + np.abs(y - middle[1]) < room - farthest
        s = first + (x - corners[0, 0]) * ux + (y - corners[0, 1]) * uy
        for _ in range(_ROUNDS):
            pieces = fans.at(s)
            s, d, inside = _on(fans, x, y, pieces)
        safe = inside & (near | (np.abs(d) < fans.alone.take(pieces)))
        np.copyto(coordinates[part, 0], s, where=safe)
        np.copyto(coordinates[part, 1], d, where=safe)
        np.copyto(found[part], pieces, where=safe)
    return coordinates, found


def _on(
    fans: PieceFans, x: Floats, y: Floats, pieces: NDArray[intp]
) -> tuple[Floats, Floats, NDArray[bool_]]:
    """Frenet coordinates of places on a given piece each, and a mask of those well in its fan."""
    own = fans.columns.take(pieces, axis=1, mode="clip")
    ux, uy, x0, y0, lengths, slope, change, arc = own
    dx, dy = x - x0, y - y0
    along = dx * ux + dy * uy
    across = ux * dy - uy * dx
    with np.errstate(divide="ignore", invalid="ignore"):
        part = (along + across * slope) / (lengths - across * change)
    inside = (part > _INSIDE) & (part < 1 - _INSIDE)
    part *= lengths
    # Faster than hypot, whose protection from overflow is not needed
    distance = np.sqrt(np.square(along - part) + np.square(across))
    return arc + part, np.copysign(distance, across), inside
