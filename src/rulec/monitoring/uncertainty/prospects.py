"""The reachable outcomes of a machine's states before a word of letter sets."""

from __future__ import annotations

from collections.abc import Sequence
from functools import reduce
from itertools import groupby
from operator import or_

from rulec.automata.outcome_machine import OutcomeMachine

MOST_TABLES = 1 << 12
"""How many tables of outcomes are kept before all are discarded."""


class Prospects:
    """The outcomes, as bits, that words from each state may have, in numbered tables.

    They are computed backwards from a word's end and cached, since words often end alike.
    """

    def __init__(self, machine: OutcomeMachine) -> None:
        # By classes of letters, one after the other.
        self._successors = list(zip(*machine.successors, strict=True))
        self._outcomes = [
            bytes([1 << outcome for outcome in column])
            for column in zip(*machine.outputs, strict=True)
        ]
        self._forget()

    def _forget(self) -> None:
        self._tables: list[bytes] = []
        self._numbers: dict[bytes, int] = {}
        self._before: dict[tuple[int, int], int] = {}

    def along(self, word: Sequence[int]) -> list[bytes]:
        """For each letter of a word, the outcomes by state of the rest of the word from there on.

        Letters are sets of classes, as bits.
        """
        if len(self._tables) > MOST_TABLES:
            self._forget()
        backward: list[bytes] = []
        here = -1
        for classes, stretch in groupby(reversed(word)):
            length = len(list(stretch))
            for done in range(length):
                key = here, classes
                known = self._before.get(key)
                if known is None:
                    known = self._before[key] = self._number(here, classes)
                if known == here:
                    # The table repeats itself from here on.
                    backward += [self._tables[here]] * (length - done)
                    break
                here = known
                backward.append(self._tables[here])
        return backward[::-1]

    def _number(self, after: int, classes: int) -> int:
        symbols = [n for n in range(classes.bit_length()) if classes >> n & 1]
        if after < 0:
            columns = {self._outcomes[symbol] for symbol in symbols}
        else:
            behind = self._tables[after].__getitem__
            columns = {
                bytes(map(behind, targets))
                for targets in {self._successors[symbol] for symbol in symbols}
            }
        joined, *others = columns
        if others:
            every = reduce(or_, [int.from_bytes(column, "little") for column in columns])
            joined = every.to_bytes(len(joined), "little")
        number = self._numbers.setdefault(joined, len(self._tables))
        if number == len(self._tables):
            self._tables.append(joined)
        return number
