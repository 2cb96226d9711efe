"""A cache of a monitor's steps, filled by the states of earlier traces."""

from __future__ import annotations

from collections.abc import Hashable
from typing import Any

from rulec.monitoring.online.bound_rules import KnownState
from rulec.monitoring.online.encoding.state_shape import StateKey, StateShape
from rulec.monitoring.online.monitor_state import MonitorState, StepResult
from rulec.monitoring.online.rule_group import GroupNode

MOST = 1 << 12
"""How many steps are kept before all are discarded."""

TRIAL = 1 << 9
"""After so many look-ups the cache's usefulness is checked; another shape counts a sixteenth.

It is useful if one state in four is found, since a look-up costs a third of a step.
"""

REST = 16
"""If the cache was of little use, nothing is kept for this many times as many states."""


class TransitionCache:
    """The steps taken while the same objects are present.

    At any time there is one shape whose states are looked up; ``key`` gives their keys. States of
    other shapes may occur in between.
    """

    def __init__(self) -> None:
        self._shape: StateShape | None = None
        self._rests_until = 0
        self._last_stranger = -1
        self._by_nodes: dict[tuple[tuple[GroupNode, ...], frozenset[str]], MonitorState] = {}
        self._n_kept = 0
        self._n_tried = 0
        self._tried_since = 0
        self.key: StateKey = _key_of_none

    def remember(
        self, known: KnownState, number: int, current: MonitorState, step: StepResult
    ) -> MonitorState:
        """Keep the step from ``current`` for the state with this number.

        To profit from the steps cached after it, continue from the returned state, which has equal
        nodes.
        """
        after, changes = step
        if number < self._rests_until:
            return after
        if self._n_tried >= TRIAL:
            helpful = 3 * (number - self._tried_since) >= 4 * TRIAL
            self._n_tried, self._tried_since = 0, number
            if not helpful:
                self._rests_until = self._tried_since = number + REST * TRIAL
                self.key = _key_of_none
                return after
        shape, encoded = known
        if shape is not self._shape:
            # A single state of another shape changes nothing, two in a row do.
            if self._shape is not None and self._last_stranger != number - 1:
                self._last_stranger = number
                return self._by_nodes.setdefault((after.nodes, after.inexact), after)
            self._forget(current)
            self._n_tried += TRIAL // 16
            self._shape = shape
        elif self._n_kept >= MOST:
            self._forget(current)
        self.key = shape.key
        after = self._by_nodes.setdefault((after.nodes, after.inexact), after)
        current.after[shape.key_of(encoded)] = after, changes
        self._n_kept += 1
        self._n_tried += 1
        return after

    def _forget(self, current: MonitorState) -> None:
        self.key = _key_of_none
        current.after.clear()
        self._by_nodes = {(current.nodes, current.inexact): current}
        self._n_kept = 0


def _key_of_none(_: Any) -> Hashable:
    return None
