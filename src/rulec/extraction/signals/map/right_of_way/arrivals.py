"""Who of those in conflict with ego arrived at the junction together with it, or earlier."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from rulec.array_types import Flags
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.right_of_way.conflicts import DRIVES_MPS, FROM_SIDES, Encounter
from rulec.extraction.signals.map.right_of_way.oncoming_priority import SLOWEST_MPS
from rulec.extraction.tracks.at_junctions.junction_passages import Passage
from rulec.trace.partly_known.partly_known_values import Truth

ARRIVALS = ("arrived_together", "other_arrived_first", "other_in_junction")

_STOPS_M = 10.0
"""Who stood no farther (m) from where its middle is in a junction has stopped at its line."""


def order_of_arrival(
    context: DriveContext, own: Passage, other: Passage
) -> tuple[bool | None, bool | None]:
    """Whether another one arrives at a junction together with ego, and whether earlier.

    Where all have to stop they arrive at its line, and enter it when it is their turn. None if both
    do not tell the same: one that creeps up to a line may have arrived later than it seems.
    """
    step_s, together_s = context.recording.step_s, context.thresholds.together_s
    leads_s = [(own.first - other.first) * step_s]
    if context.surroundings.passages.junctions[own.junction].all_have_to_stop:
        leads_s.append((_stops(context, own) - _stops(context, other)) * step_s)
    together = {abs(lead_s) <= together_s for lead_s in leads_s}
    earlier = {lead_s > together_s for lead_s in leads_s}
    return (
        None if len(together) > 1 else together.pop(),
        None if len(earlier) > 1 else earlier.pop(),
    )


def _stops(context: DriveContext, passage: Passage) -> int:
    """The column in which one arrives where it stops before a junction; enters it, if nowhere."""
    passages = context.surroundings.passages
    speed = passages.tracks.speed[passage.row, : passage.first + 1]
    travelled = passages.travelled[passage.row]
    stands = (speed < SLOWEST_MPS).nonzero()[0]
    if not len(stands) or travelled[passage.first] - travelled[stands[-1]] > _STOPS_M:
        return passage.first
    drives = (speed[: stands[-1]] > DRIVES_MPS).nonzero()[0]
    return int(drives[-1]) + 1 if len(drives) else int(stands[0])


def arrivals(
    context: DriveContext, encounters: Iterable[Encounter], strangers: Mapping[str, Flags]
) -> dict[str, Truth]:
    """Whether one in conflict with ego arrived together with it or earlier, or is in the junction.

    Rules ask this of those who come from the sides, in ``encounters`` or maybe as ``strangers``; so
    it is told of those who come towards ego, on a ring or on rails only if nobody does. Of those
    who arrive together, some laws let only one from the right go first: where one comes from there,
    but only one from the left arrived together with ego, it is unknown, as the two would seem one.
    """
    known, others = _by_side(context, encounters)
    beside = [flags for name, flags in strangers.items() if name not in FROM_SIDES]
    others |= np.array([*(strangers[name] for name in FROM_SIDES), np.any(beside, axis=0)])
    nobody_from_side: Flags = ~np.any(known[-1, :2] | others[-1, :2], axis=0)
    known[:-1, 2] &= nobody_from_side
    others[:-1, 2] &= nobody_from_side
    found: Flags = np.any(known, axis=1)
    possible: Flags = found | np.any(others, axis=1)
    right = FROM_SIDES.index("conflict_from_right")
    found[0] &= ~known[-1, right] | known[0, right]
    return {word: Truth(found[k], possible[k]) for k, word in enumerate(ARRIVALS)}


def _by_side(context: DriveContext, encounters: Iterable[Encounter]) -> tuple[Flags, Flags]:
    """Where ``ARRIVALS`` are true of encounters that are known, and of others.

    By word, after which come the encounters themselves; by side, after which come all others; and
    by state.
    """
    met: Flags = np.zeros((2, len(ARRIVALS) + 1, len(FROM_SIDES) + 1, context.states), dtype=bool)
    for one in encounters:
        side = FROM_SIDES.index(one.kinds[0]) if one.kinds[0] in FROM_SIDES else len(FROM_SIDES)
        inside = max(one.first, one.other.first - context.first_column)
        begins = (one.first, one.first, inside, one.first)
        for word, holds in enumerate((one.together, one.comes_first, True, True)):
            sure = one.known and holds is not None
            met[int(not sure), word, side, begins[word] : one.last + 1] |= holds is not False
    return met[0], met[1]
