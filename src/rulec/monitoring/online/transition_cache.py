"""Where states have led before, so that the same need not be worked out again."""

from __future__ import annotations

from collections.abc import Hashable
from typing import TYPE_CHECKING, Any

from rulec.monitoring.online.encoded_values import Told
from rulec.monitoring.online.state_shape import Key, StateShape

if TYPE_CHECKING:
    from rulec.monitoring.online.monitor_state import Change, MonitorState
    from rulec.monitoring.online.rule_group import Node

MOST = 1 << 12
"""So many states are remembered before all are forgotten again."""

TRIAL = 1 << 9
"""After so many it is asked whether that was of any help; another outline counts as a sixteenth."""

REST = 16
"""If it was of little help, nothing more is remembered for so many times as many states."""


class TransitionCache:
    """Remembers where states lead while the same objects are there.

    At any time there is one outline whose states are known again; ``key`` is theirs. Others may
    come between them.
    """

    def __init__(self) -> None:
        self._outline: StateShape | None = None
        self._rests_until = 0
        self._stranger = -1
        self._standings: dict[tuple[Node, ...], MonitorState] = {}
        self._n_learned = 0
        self._n_tried = 0
        self._tried_since = 0
        self.key: Key = _of_none

    def learn(
        self,
        known: tuple[StateShape, tuple[Told, ...]],
        number: int,
        here: MonitorState,
        after: MonitorState,
        changes: tuple[Change, ...],
    ) -> MonitorState:
        """Remember where a state has led, which has this number and is known by this.

        It has led nowhere else than a standing with the same nodes that is known from before; to
        know what follows there, go on from the one that is returned.
        """
        if number < self._rests_until:
            return after
        if self._n_tried >= TRIAL:
            helpful = number - self._tried_since >= 2 * TRIAL
            self._n_tried, self._tried_since = 0, number
            if not helpful:
                self._rests_until = self._tried_since = number + REST * TRIAL
                self.key = _of_none
                return after
        outline, told = known
        if outline is not self._outline:
            # One stranger changes nothing, two in a row do.
            if self._outline is not None and self._stranger != number - 1:
                self._stranger = number
                return self._standings.setdefault(after.nodes, after)
            self._forget(here)
            self._n_tried += TRIAL // 16
            self._outline = outline
        elif self._n_learned >= MOST:
            self._forget(here)
        self.key = outline.key
        after = self._standings.setdefault(after.nodes, after)
        here.after[outline.key_of(told)] = after, changes
        self._n_learned += 1
        self._n_tried += 1
        return after

    def _forget(self, here: MonitorState) -> None:
        self.key = _of_none
        here.after.clear()
        self._standings = {here.nodes: here}
        self._n_learned = 0


def _of_none(_: Any) -> Hashable:
    """The key of no state."""
    return None
