"""A map as data: lanelets, and what it says of all of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rulec.recordings.recording import Lanelet, Side
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
