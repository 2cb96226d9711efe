"""The classes of letters that a state may have, from what is known of each read."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property, reduce
from itertools import product
from operator import or_

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.monitoring.uncertainty.state_letters.entangled_reads import EntangledReads
from rulec.monitoring.uncertainty.state_letters.letter_diagram import LetterDiagram
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters, read_digits
from rulec.trace.remembered import Remembered
from rulec.vocabulary.partial_values import PartialValue

MOST_KEPT = 1 << 16
"""How many letters keep their classes before all are discarded."""


class LetterClasses:
    """The classes of possible letters of a machine, as bit sets."""

    def __init__(self, machine: OutcomeMachine) -> None:
        self._machine = machine
        self._known = Remembered(self._classes, MOST_KEPT)
        self._rules: dict[str, RuleLetters] = {}

    @cached_property
    def diagram(self) -> LetterDiagram:
        """The machine's letters, built on first use, since not all rules are judged."""
        return LetterDiagram(self._machine)

    def of(self, letters: Letters) -> int:
        """The classes of letters; 0 if axioms exclude them all."""
        return self._known[letters]

    def _classes(self, letters: Letters) -> int:
        return reduce(or_, map(self.diagram.classes, letters), 0)

    def of_rule(self, rule: CompiledRule, reads: EntangledReads) -> RuleLetters:
        """The letters of a rule that has this machine, with these entangled reads."""
        known = self._rules.get(rule.name)
        if known is None or known.entangled is not reads:
            known = self._rules[rule.name] = RuleLetters(self, rule, reads)
        return known

    def side_by_side(
        self, left: Letters, right: Letters, fixed: tuple[int, ...]
    ) -> frozenset[tuple[int, int]]:
        """The classes of two letters for each choice of digits of the ``fixed`` reads in both."""
        same = frozenset(fixed)
        both = {
            nodes
            for first, second in product(left, right)
            for nodes in self.diagram.nodes_side_by_side(first, second, same)
        }
        return frozenset([(x >> 1, y >> 1) for x, y in both if x > 1 and y > 1])


@dataclass
class PossibleWord:
    """The letters that a rule may read for its objects, state by state.

    ``classes`` are their classes, as bits. ``exact`` is false if some of the letters may be
    impossible, because there were too many completions. The other properties are computed on
    demand.
    """

    classes: tuple[int, ...]
    exact: bool
    find_states: Callable[[], tuple[Letters, ...]]
    find_unknown: Callable[[], tuple[frozenset[str], ...]]

    @cached_property
    def states(self) -> tuple[Letters, ...]:
        """The letters of each state."""
        return self.find_states()

    @cached_property
    def unknown(self) -> tuple[frozenset[str], ...]:
        """For each read the names with unknown values."""
        return self.find_unknown()


class RuleLetters:
    """The letters that a rule may read for its objects, by keys.

    A key has the digits, as bits, of each independent read and, if there are ``entangled`` ones,
    the place of their joint letters as last item.
    """

    def __init__(
        self, classes: LetterClasses, rule: CompiledRule, entangled: EntangledReads
    ) -> None:
        self.reads = tuple([read_digits(read) for read in rule.machine.reads])
        self.entangled = entangled
        own = range(len(self.reads))
        self.independent = tuple([n for n in own if n not in entangled.numbers])
        # The place of each read among the independent ones, then those of the entangled ones.
        self._order = sorted(own, key=(*self.independent, *entangled.numbers).__getitem__)
        self.classes: Remembered[tuple[int, ...], int] = Remembered(
            lambda key: classes.of(self.letters(key)), MOST_KEPT
        )
        """The classes, as bits, of the letters with a key; 0 where axioms exclude them all."""

    def possible(
        self,
        digits: tuple[int, ...],
        values: tuple[PartialValue | None, ...],
        there: Mapping[str, str] | None = None,
    ) -> tuple[int, bool]:
        """The classes, as bits, of letters, and whether each of these is possible.

        ``digits`` are those of independent reads, ``values`` those of what entangled ones depend
        on; see ``EntangledReads.number``. Raises MissingValueError.
        """
        if not self.entangled.numbers:
            return self.classes[digits], True
        place = self.entangled.number(values, there)
        key = *digits, place
        return self.classes[key], self.entangled.joint_letters[place][1]

    def letters(self, key: tuple[int, ...]) -> Letters:
        """The letters with a key."""
        if not self.entangled.numbers:
            return (key,)
        cubes, _ = self.entangled.joint_letters[key[-1]]
        alone, order = key[:-1], self._order
        return tuple([tuple([(*alone, *cube)[n] for n in order]) for cube in cubes])
