"""A map as data: lanelets, and facts about all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import shapely

from rulec.recordings.recording import Lanelet, Points, Side
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True, kw_only=True)
class RoadMap:
    """A map, for recordings without roads; fields are those of a ``Recording``.

    Programmes of its lights count in the time steps of that recording, from its step 0 on.
    """

    __repr__ = short_repr

    form: str
    lanelets: Mapping[str, Lanelet]
    side: Side | None = None
    country: str = ""
    complete: frozenset[str] = frozenset()
    remarks: tuple[str, ...] = ()


def crosswalk(name: str, left: Points, right: Points, *, directed: bool = False) -> Lanelet:
    """A crosswalk between two bounds that lead across the road; ``directed`` by lights."""
    return Lanelet(
        id=name,
        left=left,
        right=right,
        centre=(left + right) / 2,
        types=frozenset({"crosswalk", "directed"} if directed else {"crosswalk"}),
    )


def crosswalk_with_outline(name: str, outline: Points) -> Lanelet:
    """A crosswalk as a lanelet along which people walk: the longer way of its outline."""
    corners = outline
    if len(corners) > 2 and (corners[0] == corners[-1]).all():
        corners = corners[:-1]
    if len(corners) != 4:
        box = shapely.minimum_rotated_rectangle(shapely.MultiPoint(outline))
        corners = shapely.get_coordinates(box)[:4]
    sides = np.hypot(*(np.roll(corners, -1, axis=0) - corners).T)
    if sides[0] + sides[2] < sides[1] + sides[3]:
        corners = np.roll(corners, -1, axis=0)
    first, second = corners[:2], corners[:1:-1]
    middle = (first + second) / 2
    ahead, aside = middle[1] - middle[0], first[0] - second[0]
    if ahead[0] * aside[1] - ahead[1] * aside[0] < 0:
        first, second = second, first
    return crosswalk(name, first, second)
