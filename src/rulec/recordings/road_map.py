"""A map as data: lanelets, and what it says of all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rulec.recordings.recording import Lanelet, Points, Side
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True, kw_only=True)
class RoadMap:
    """A map, for recordings that have no roads of their own; fields are those of a ``Recording``.

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
        successors=(),
        predecessors=(),
        left_of=None,
        right_of=None,
        types=frozenset({"crosswalk", "directed"} if directed else {"crosswalk"}),
        signs=frozenset(),
        limit_mps=None,
    )
