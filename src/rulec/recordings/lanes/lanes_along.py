"""Lanelets along centre lines, and their successors where the source gives none."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Container, Hashable, Iterable, Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any, TypeVar

import numpy as np
import shapely
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.polylines import ends_apart, parallel_line
from rulec.recordings.recording import (
    BUSES_ONLY,
    CYCLES_TOO,
    STRAIGHT_ON,
    TAXIS_TOO,
    Lanelet,
    Points,
)

USUAL_WIDTH_M = 3.5
"""The default width (m) of a lane, which is that of most rural roads and motorways."""

CLOSEST_M = 0.01

MEETING_M = 0.5
Key = TypeVar("Key", bound=Hashable)
_LIKE = np.cos(np.radians(45))

LANE_TYPES = frozenset(
    (
        *("urban", "country", "rural", "highway", "interstate", "ordinary", "driveWay"),
        *("mainCarriageWay", "accessRamp", "exitRamp", "shoulder", "busLane", "busStop"),
        *("bicycleLane", "sidewalk", "crosswalk", "directed", "intersection", "unregulated"),
        *("roundabout", "level_crossing", "rail", "tunnel", "parking", "border"),
        *("restricted_area", BUSES_ONLY, CYCLES_TOO, TAXIS_TOO, STRAIGHT_ON, "unknown"),
    )
)
"""Types of lanelets that rules refer to, and others that maps contain."""


def lanelet_along(
    name: str,
    centre: Points,
    width: NDArray[float64] | float,
    *,
    stops_at_end: bool = False,
    **more: Any,
) -> Lanelet:
    """A lanelet along a line of distinct points; the width (m) is one number, or one per point.

    ``stops_at_end``: whether there is a stop line across its end. ``more``: fields of a
    ``Lanelet``.
    """
    left, right = (parallel_line(centre, way * np.asarray(width) / 2) for way in (1, -1))
    if stops_at_end:
        more["stop_line"] = np.stack((left[-1], right[-1]))
    return Lanelet(id=name, left=left, right=right, centre=centre, **more)


def unknown_references(lanelet: Lanelet, known: Container[str]) -> Iterator[tuple[str, str]]:
    """The fields of a lanelet, each with an id in it that is none of the known ones."""
    for field, names in (
        ("successors", lanelet.successors),
        ("predecessors", lanelet.predecessors),
        ("left_of", () if lanelet.left_of is None else (lanelet.left_of,)),
        ("right_of", () if lanelet.right_of is None else (lanelet.right_of,)),
        ("foes", sorted(lanelet.foes or ())),
        ("first", sorted(lanelet.first or ())),
        ("lights_to", lanelet.lights_to),
    ):
        yield from ((field, name) for name in names if name not in known)


def led_to(
    direct: Mapping[Key, Iterable[Key]], start: Key, is_there: Callable[[Key], bool]
) -> tuple[Key, ...]:
    """What something leads to, past what is not there; ``direct`` are the links of all."""
    found: dict[Key, None] = {}
    passed, waiting = {start}, [*direct.get(start, ())][::-1]
    while waiting:
        key = waiting.pop()
        if is_there(key):
            found[key] = None
        elif key not in passed:
            passed.add(key)
            waiting += [*direct.get(key, ())][::-1]
    return tuple(found)


def reversed_links(direct: Mapping[Key, Iterable[Key]]) -> dict[Key, list[Key]]:
    """What leads to each thing, in the order of the links."""
    before: dict[Key, list[Key]] = defaultdict(list)
    for start, ends in direct.items():
        for end in ends:
            before[end].append(start)
    return before


def linked(lanelets: Mapping[str, Lanelet]) -> dict[str, Lanelet]:
    """The lanelets with successors, predecessors and neighbours made mutual."""
    after: dict[str, list[str]] = defaultdict(list)
    before: dict[str, list[str]] = defaultdict(list)
    left, right = {}, {}
    for lanelet in lanelets.values():
        after[lanelet.id] += lanelet.successors
        before[lanelet.id] += lanelet.predecessors
        for name in lanelet.successors:
            before[name].append(lanelet.id)
        for name in lanelet.predecessors:
            after[name].append(lanelet.id)
        if lanelet.left_of is not None:
            right[lanelet.left_of] = lanelet.id
        if lanelet.right_of is not None:
            left[lanelet.right_of] = lanelet.id
    return {
        lane.id: replace(
            lane,
            successors=tuple(dict.fromkeys(after[lane.id])),
            predecessors=tuple(dict.fromkeys(before[lane.id])),
            left_of=lane.left_of if lane.left_of is not None else left.get(lane.id),
            right_of=lane.right_of if lane.right_of is not None else right.get(lane.id),
        )
        for lane in lanelets.values()
    }


def with_sound_links(lanelets: Iterable[Lanelet]) -> dict[str, Lanelet]:
    """The lanelets by id, linked with others of them only, and with neighbours of their direction.

    Predecessors are also those of which a lanelet is a successor. Maps of data sets are sections,
    and name any lane beside another one its neighbour.
    """
    known = {lane.id: lane for lane in lanelets}
    before = {name: dict.fromkeys(lane.predecessors) for name, lane in known.items()}
    for name, lane in known.items():
        for after in known.keys() & lane.successors:
            before[after][name] = None
    return {
        name: replace(
            lane,
            successors=tuple([x for x in dict.fromkeys(lane.successors) if x in known]),
            predecessors=tuple([x for x in before[name] if x in known]),
            left_of=_beside(lane, known.get(lane.left_of or ""), left=True),
            right_of=_beside(lane, known.get(lane.right_of or ""), left=False),
        )
        for name, lane in known.items()
    }


def _beside(own: Lanelet, other: Lanelet | None, *, left: bool) -> str | None:
    """The id of a neighbour that leads the same way: the common border then does in both."""
    if other is None or other is own:
        return None
    border, same, opposite = (
        (own.left, other.right, other.left) if left else (own.right, other.left, other.right)
    )
    leads_alike = ends_apart(border, same) <= ends_apart(border, opposite[::-1])
    return other.id if leads_alike else None


def with_ends_that_meet(lanelets: Mapping[str, Lanelet]) -> dict[str, Lanelet]:
    """The lanelets, linked where centre lines meet and have the same direction.

    Lines meet if one's end is within ``MEETING_M`` of the other's start.
    """
    names = list(lanelets)
    after: dict[str, list[str]] = defaultdict(list)
    for own, other in lines_that_meet([lanelets[name].centre for name in names], MEETING_M, _LIKE):
        after[names[own]].append(names[other])
    return linked(
        {
            name: replace(lanelet, successors=tuple(after[name]))
            for name, lanelet in lanelets.items()
        }
    )


def lines_that_meet(
    lines: Sequence[Points], within_m: float, cosine: float
) -> Iterator[tuple[int, int]]:
    """The pairs of lines of which the second begins where the first ends, and leads its way.

    It does so if the cosine of the angle between their ends is no less than this.
    """
    begins, ends = (shapely.points([line[at] for line in lines]) for at in (0, -1))
    pairs = shapely.STRtree(begins).query(ends, predicate="dwithin", distance=within_m)
    for own, other in pairs.T.tolist():
        ahead, onward = _direction(lines[own][-2:]), _direction(lines[other][:2])
        if own != other and float(ahead @ onward) >= cosine:
            yield own, other


def _direction(ends: Points) -> NDArray[float64]:
    step: NDArray[float64] = ends[1] - ends[0]
    direction: NDArray[float64] = step / np.hypot(*step)
    return direction
