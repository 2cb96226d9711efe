"""Names that a source of traces does not provide, and rules that cannot be judged without them.

Values count as names, too: if a source provides some values of an enumeration by name, it never
provides the others. A rule is never kept merely because of a value that the source cannot provide.
The same holds for types of objects.
"""

from __future__ import annotations

from collections.abc import Set
from itertools import chain

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.outcome_machine import VIOLATED, OutcomeMachine, bits_of
from rulec.monitoring.told_names import NEVER_FALSE, NEVER_TRUE
from rulec.monitoring.uncertainty.state_letters.letter_classes import LetterClasses
from rulec.monitoring.uncertainty.state_letters.read_digits import names_of_read
from rulec.trace.remembered import Remembered

MOST_LOOKED_AT = 1 << 21
"""After so many states with a letter the search ends.

Some word is then assumed to violate the rule.
"""

MOST_COMPARED, MOST_LOOKED_AT_WHOLE = 200, 1 << 16
"""Of larger machines sets of states are first kept whole, as long as no more is looked at: to
compare all states takes longer."""

MOST_REPETITIONS = 1 << 12
"""A letter is repeated at most so often."""


class RequiredNames:
    """The names that a source must provide for a rule's machine to be judged, cached.

    ``classes`` are those of its possible letters.
    """

    def __init__(self, machine: OutcomeMachine, classes: LetterClasses) -> None:
        self._machine = machine
        self._classes = classes
        self._reads = machine.reads
        self._values = [_values_of(read) for read in machine.reads]
        names = map(names_of_read, machine.reads)
        self._names = [(*own, *values) for own, values in zip(names, self._values, strict=True)]
        self._lacking: Remembered[frozenset[str], tuple[str, ...]] = Remembered(
            lambda names: () if self._can_fire(names) else self._smallest_lack(names)
        )
        self._steps = Remembered(self._step)

    def missing_of(self, untold: frozenset[str]) -> tuple[str, ...]:
        """Names among these whose absence means that no word can be known to violate the rule.

        Empty if some word can, whatever values the untold names have.
        """
        names = untold.intersection(chain.from_iterable(self._names))
        return self._lacking[names] if names else ()

    def _smallest_lack(self, names: frozenset[str]) -> tuple[str, ...]:
        """A minimal set of untold names that would have to be provided, in the order of reads."""
        order = dict.fromkeys(name for own in self._names for name in own if name in names)
        lacking = list(order)
        for name in order:
            without = [other for other in lacking if other != name]
            if without and not self._can_fire(frozenset(without)):
                lacking = without
        return tuple(lacking)

    def _can_fire(self, untold: frozenset[str]) -> bool:
        """Whether all completions of some word violate the rule.

        Beyond ``MOST_LOOKED_AT`` this is assumed: then the rule is judged, and at worst always
        open.
        """
        letters = self._classes_in_the_dark(untold)
        fires = None
        if len(self._machine.successors) > MOST_COMPARED:
            fires = self._fires(letters, MOST_LOOKED_AT_WHOLE, whole=True)
        if fires is None:
            fires = self._fires(letters, MOST_LOOKED_AT, whole=False)
        return fires is not False

    def _fires(self, letters: Set[int], most: int, *, whole: bool) -> bool | None:
        """Whether all completions of some word violate the rule; None if that takes too long."""
        machine = self._machine
        # If they do from the least states, they do from all states.
        every = sum(1 << state for state in machine.starts)
        start = every if whole else machine.least(every)
        if self._is_lost_by_runs(start, letters, whole=whole):
            return True
        reached = {start}
        looked_at, n_classes = 0, sum(map(int.bit_count, letters))
        for here in (waiting := [start]):
            looked_at += here.bit_count() * n_classes
            if looked_at > most:
                return None
            for classes in letters:
                after = self._steps[here, classes, whole]
                if after is None:
                    return True
                if after not in reached:
                    reached.add(after)
                    waiting.append(after)
        return False

    def _is_lost_by_runs(self, start: int, letters: Set[int], *, whole: bool) -> bool:
        """Whether long runs of one or two letters violate the rule.

        This suffices for most duties; with a short step no search would reach that far.
        """
        tried: set[int] = set()
        for first in letters:
            middle = self._at_last(start, first, whole=whole)
            if middle is None:
                return True
            if middle not in tried and None in {
                self._at_last(middle, letter, whole=whole) for letter in letters
            }:
                return True
            tried.add(middle)
        return False

    def _at_last(self, here: int, classes: int, *, whole: bool) -> int | None:
        """The least states in which a repeated letter ends up; None if it violates the rule."""
        met: set[int] = set()
        while here not in met and len(met) < MOST_REPETITIONS:
            met.add(here)
            after = self._steps[here, classes, whole]
            if after is None:
                return None
            here = after
        return here

    def _step(self, about: tuple[int, int, bool]) -> int | None:
        """The least states after a letter of any of these classes; None if all of it violates.

        Cached, since runs of letters, the search, and fewer untold names need the same steps.
        """
        here, classes, whole = about
        machine, states, symbols = self._machine, bits_of(here), bits_of(classes)
        outputs = [machine.outputs[state] for state in states]
        if all(row[symbol] == VIOLATED for row in outputs for symbol in symbols):
            return None
        rows = [machine.successors[state] for state in states]
        targets = {row[symbol] for row in rows for symbol in symbols}
        reached = sum([1 << target for target in targets])
        return reached if whole else machine.least(reached)

    def _classes_in_the_dark(self, untold: frozenset[str]) -> frozenset[int]:
        """The minimal sets of classes, as bits, that letters may have, by the reads that are told.

        An outcome of all words of a larger set is also the outcome of all words of a smaller one.
        """
        diagram = self._classes.diagram
        reached = frozenset({diagram.start})
        for n in range(len(self._reads) - 1, -1, -1):
            never = {digit for value, digit in self._values[n].items() if value in untold}
            size = self._reads[n].size
            digits = [1 << digit for digit in range(size) if digit not in never]
            if not untold.isdisjoint(names_of_read(self._reads[n])):
                digits = [(1 << size) - 1]
            reached = frozenset(diagram.step(n, here, mask) for here in reached for mask in digits)
        every = frozenset(nodes >> 1 for nodes in reached) - {0}
        return frozenset(x for x in every if not any(y & x == y != x for y in every))


def _values_of(read: Read | NumberRead) -> dict[str, int]:
    """The digits of the values that a read distinguishes, by how they are called if untold."""
    if not isinstance(read, Read):
        return {}
    if not read.values:
        return {read.name + NEVER_FALSE: 0, read.name + NEVER_TRUE: 1}
    return {value: read.digit(value) for value in read.values}
