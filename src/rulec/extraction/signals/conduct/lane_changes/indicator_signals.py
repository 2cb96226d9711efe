"""The signal of ego's indicator, which announces lane changes."""

from __future__ import annotations

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.conduct.lamp_signals import ego_lamps
from rulec.extraction.signals.signal_columns import Measured
from rulec.extraction.signals.words import word

_INDICATORS = frozenset({"left_indicator", "right_indicator"})

_INDICATIONS = ("no_indicator", "near_indicator", "far_indicator")

_JUMP_MPS = 5.0
"""No vehicle moves sideways faster: simulators change lanes in a step, with or without a signal."""

_JUMP_S = 0.5
"""Changes of lanes this long (s) before or after a jump are due to it."""

_ABRUPT_MPS, _ABRUPT_S = 2.5, 2.0
"""Who changes lanes faster than anybody drives began to at most this long (s) before."""


@word("indicator")
def indicator(context: DriveContext) -> Measured | None:
    """Ego's indicator, if the recording contains its lamps.

    Both sides at once are no indication, like hazard lights; if a file states that hazard lights
    are off then, it contradicts itself, and both sides are unknown in the whole drive. A vehicle
    that changes lanes has indicated it if it did up to the state before, or while it lay across the
    mark; what it showed until then is as much later as the change is known later, since it may
    switch off once its middle is over the mark. If it jumps at that time, or off the road's edge,
    that is unknown. So is whether it did before a change that takes one step, as in simulators, in
    which nobody can announce it.
    """
    egos = context.ego.participants
    if not context.spans.agreed([ego.lamps and ego.shows >= _INDICATORS for ego in egos]):
        return None
    far = "left_indicator" if context.side == "right" else "right_indicator"
    steps = ego_lamps(context)
    lit = [(lamps or frozenset()) & _INDICATORS for lamps in steps]
    codes = np.array([0 if len(lamps) != 1 else 2 if far in lamps else 1 for lamps in lit])
    tells_hazards = context.spans.spread(["hazard_lights" in ego.shows for ego in egos]).tolist()
    both = np.array([lamps is not None and lamps >= _INDICATORS for lamps in steps])
    no_hazards = [
        tells and "hazard_lights" not in (lamps or ())
        for lamps, tells in zip(steps, tells_hazards, strict=True)
    ]
    doubtful = both & context.spans.any(both & np.array(no_hazards))
    doubtful |= np.array([lamps is None for lamps in steps])
    is_dark = np.array([lamps is not None and not lamps & _INDICATORS for lamps in steps])
    spans, across_mps = context.spans, _speed_across(context)
    changed = spans.changes(context.steady_lane)
    changes = (changed & is_dark).nonzero()[0]
    shown, longest = codes.copy(), context.steps_in(context.thresholds.signalling_s)
    for change in changes.tolist():
        last = _lit_across(context, shown, change)
        # What it showed until then is as much later as the change is known later
        first = max(int(spans.first[change]), change - longest)
        if last < change:
            codes[first + change - last : change + 1] = shown[first : last + 1]
    jumps = across_mps > _JUMP_MPS
    # A jump may end short of the mark, or begin just behind it
    about = spans.within(jumps, context.steps_in(_JUMP_S), around=True)
    doubtful[changes] |= (codes[changes] == 0) & about[changes]
    off_the_edge = jumps & ~changed
    doubtful |= is_dark & (off_the_edge | spans.after(off_the_edge))
    abrupt = changed & (across_mps > _ABRUPT_MPS)
    abrupt = spans.within(abrupt, context.steps_in(_ABRUPT_S))
    doubtful |= is_dark & abrupt & ~changed
    return Measured(codes, doubtful, texts=_INDICATIONS)


def _lit_across(context: DriveContext, codes: NDArray[intp], change: int) -> int:
    """The last state before a change of lanes, since ego's body reached the mark, with a light.

    The change itself if there is none.
    """
    lane, own = context.steady_lane, context.ego_extents
    mark = max(lane[change - 1], lane[change])
    longest = context.steps_in(context.thresholds.signalling_s)
    first = max(int(context.spans.first[change]), change - longest)
    low, high = (
        left_of[first:change, mark] for left_of in (own.left_of_min[0], own.left_of_max[0])
    )
    clear = ((low > 0.0) | (high < 0.0)).nonzero()[0]
    since = min(first + int(clear[-1]) + 1 if len(clear) else first, change - 1)
    lit = codes[since:change].nonzero()[0]
    return since + int(lit[-1]) if len(lit) else change


def _speed_across(context: DriveContext) -> Floats:
    """How fast (m/s) ego has moved sideways from the state before, by state."""
    left_of = context.ego_extents.left_of[0]
    moved = np.abs(left_of - context.spans.before(left_of.T).T).min(axis=1)
    across: Floats = moved / context.recording.step_s
    return across
