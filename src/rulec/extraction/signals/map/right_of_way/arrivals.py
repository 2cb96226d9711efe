"""Who of those in conflict with ego arrived at the junction together with it, or earlier."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

import numpy as np

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.map.right_of_way.conflicts import FROM_SIDES, Encounter
from rulec.extraction.signals.signal_columns import SignalColumns
from rulec.extraction.tracks.tracks import Flags

ARRIVALS = ("arrived_together", "other_arrived_first", "other_in_junction")


def arrivals(
    context: DriveContext, encounters: Iterable[Encounter], strangers: Mapping[str, Flags]
) -> SignalColumns:
    """Whether one in conflict with ego arrived together with it or earlier, or is in the junction.

    Rules ask this of those who come from the sides, in ``encounters`` or maybe as ``strangers``; so
    it is told of those who come towards ego, on a ring or on rails only if nobody does. Of those
    who arrive together, some laws let only one from the right go first: where one comes from there,
    but only one from the left arrived together with ego, it is unknown, as the two would seem one.
    """
    known, perhaps = _by_side(context, encounters)
    beside = [flags for name, flags in strangers.items() if name not in FROM_SIDES]
    perhaps |= np.array([*(strangers[name] for name in FROM_SIDES), np.any(beside, axis=0)])
    nobody_from_side: Flags = ~np.any(known[-1, :2] | perhaps[-1, :2], axis=0)
    known[:-1, 2] &= nobody_from_side
    perhaps[:-1, 2] &= nobody_from_side
    found: Flags = np.any(known, axis=1)
    unknown: Flags = np.any(perhaps, axis=1) & ~found
    right = FROM_SIDES.index("conflict_from_right")
    unknown[0] |= found[0] & known[-1, right] & ~known[0, right]
    return SignalColumns(
        {word: found[number] for number, word in enumerate(ARRIVALS)},
        unknown={word: unknown[number] for number, word in enumerate(ARRIVALS)},
    )


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
            met[int(not one.known), word, side, begins[word] : one.last + 1] |= holds
    return met[0], met[1]
