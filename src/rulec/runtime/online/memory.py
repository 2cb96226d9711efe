"""Where states have led before, so that the same need not be worked out again."""

from __future__ import annotations

from collections.abc import Hashable
from typing import TYPE_CHECKING, Any, NoReturn

from rulec.runtime.online.likeness import Floors, Key, key_like
from rulec.vocabulary import Vocabulary

if TYPE_CHECKING:
    from rulec.runtime.online.standing import Change, Standing
    from rulec.runtime.online.team import Node

MOST = 1 << 12
"""So much is remembered before it is forgotten again; a key is worth a sixteenth of it."""

REST = 16
"""If that was of little help, nothing is remembered for so many times as many states."""


class Memory:
    """Remembers where states lead while the same objects are there.

    At any time there is one outline whose states are known again; ``key`` is theirs. Others may
    come between them.
    """

    def __init__(self, vocabulary: Vocabulary, floors: Floors) -> None:
        self._vocabulary = vocabulary
        self._floors = floors
        self._rests_until = 0
        self._stranger = -1
        self._standings: dict[tuple[Node, ...], Standing] = {}
        self._since = 0
        self._n_learned = 0
        self.key: Key = _of_none

    def learn(
        self, state: Any, number: int, here: Standing, after: Standing, changes: tuple[Change, ...]
    ) -> Standing:
        """Remember where a state, which has this number, has led.

        It has led nowhere else than a standing with the same nodes that is known from before; to
        know what follows there, go on from the one that is returned.
        """
        if number < self._rests_until:
            return after
        if self._n_learned >= MOST:
            helpful = number - self._since >= 2 * MOST
            self._rests_until = 0 if helpful else number + REST * MOST
            self._forget(number, here)
            return after
        key = self._key_of(state, number, here)
        after = self._standings.setdefault(after.nodes, after)
        if key is not None:
            here.after[key] = after, changes
            self._n_learned += 1
        return after

    def _key_of(self, state: Any, number: int, here: Standing) -> Hashable | None:
        try:
            return self.key(state)
        except (LookupError, TypeError):
            pass
        # One stranger changes nothing, two in a row do.
        if self.key is not _of_none and self._stranger != number - 1:
            self._stranger = number
            return None
        n_learned = self._n_learned
        self._forget(self._since, here)
        self._n_learned = n_learned + MOST // 16
        self.key = key_like(state, self._vocabulary, self._floors)
        try:
            return self.key(state)
        except (LookupError, TypeError):
            return None

    def _forget(self, number: int, here: Standing) -> None:
        self.key = _of_none
        here.after.clear()
        self._standings = {here.nodes: here}
        self._n_learned = 0
        self._since = number


def _of_none(_: Any) -> NoReturn:
    raise LookupError
