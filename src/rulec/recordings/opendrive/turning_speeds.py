"""Recognises limits within junctions that are only turning speeds, not posted limits.

SUMO's netconvert writes the speed for driving a bend within a junction as its limit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Set
from dataclasses import replace

from rulec.recordings.recording import Lanelet


def without_turning_speeds(
    lanelets: Mapping[str, Lanelet], inside: Set[str]
) -> tuple[dict[str, Lanelet], int]:
    """The lanelets, and how many of them ``inside`` junctions got the limit of the road before.

    No sign applies only within a junction. A way through a junction whose limit is below those of
    all roads before and after it therefore gets the lowest limit of the roads before it.
    """
    changed = dict(lanelets)
    count = 0
    for name in inside:
        own = lanelets[name]
        if own.limit_mps is None:
            continue
        before = _limits(lanelets, name, inside, lambda lanelet: lanelet.predecessors)
        after = _limits(lanelets, name, inside, lambda lanelet: lanelet.successors)
        if not before or not after or None in before | after:
            continue
        lowest = min(limit for limit in before if limit is not None)
        if own.limit_mps < min(lowest, *(limit for limit in after if limit is not None)):
            changed[name] = replace(own, limit_mps=lowest)
            count += 1
    return changed, count


def _limits(
    lanelets: Mapping[str, Lanelet],
    name: str,
    inside: Set[str],
    onward: Callable[[Lanelet], tuple[str, ...]],
) -> set[float | None]:
    """The limits of the roads at one end of a way through a junction of one or several lanelets."""
    limits: set[float | None] = set()
    seen, waiting = {name}, [name]
    while waiting:
        for other in onward(lanelets[waiting.pop()]):
            if other in seen or other not in lanelets:
                continue
            seen.add(other)
            if other in inside:
                waiting.append(other)
            else:
                limits.add(lanelets[other].limit_mps)
    return limits
