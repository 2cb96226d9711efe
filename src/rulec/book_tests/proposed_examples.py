"""Proposed examples: a shortest one for each edge of a rule's monitor, and for each limit."""

from __future__ import annotations

import itertools
import operator
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.book_tests.example_runs import word_of
from rulec.book_tests.limit_coverage import LimitSide, close_state, deciding_edges
from rulec.logic.formula import Comparison
from rulec.rulebook.rulebook_model import Axiom, Example, ExampleState, Rule, Variable
from rulec.rulebook.rules.axiom_instances import axiom_instances
from rulec.rulebook.rules.axioms import contradicted
from rulec.vocabulary import Quantity, Vocabulary
from rulec.witnesses.class_witness import ClassWitnesses
from rulec.witnesses.coverage_witness import (
    CoverageWitness,
    asked_whether_told,
    coverage_witness,
    go_together,
    is_possible,
    possible_letters,
)
from rulec.witnesses.letter_functions import Digits, constant_reads, digits_of
from rulec.witnesses.undecided import UndecidedError

_MOST_TRIED = 16
"""Number of letters tried to find a state close to a limit."""

_NOT_ALONE = ("something else is so, too",)
"""What is said of a state that needs more than its rule reads, as a fact says."""


@dataclass(frozen=True, slots=True)
class UncoveredEdge:
    """A monitor edge that no example takes, with a shortest example for it.

    The edge leads from state ``source`` to ``target``; ``accepted`` is the rule's verdict on the
    example. ``objects`` are those of the example besides the rule's own.
    """

    source: int
    target: int
    states: tuple[CoverageWitness, ...]
    accepted: bool
    objects: tuple[Variable, ...] = ()

    @property
    def is_whole(self) -> bool:
        """Whether the states take the edge as they are, without what is only said in words."""
        return not any(state.besides for state in self.states)


def stated(says: ExampleState, vocabulary: Vocabulary) -> ExampleState:
    """What an example has to say of a state: numbers, and values other than their defaults."""
    words = vocabulary.declarations
    return {
        subject: value
        for subject, value in says.items()
        if isinstance(words[subject[0]], Quantity) or value != words[subject[0]].default
    }


@dataclass(frozen=True, slots=True)
class UntouchedLimit:
    """A limit that no example comes close to while its comparison has this value.

    ``example`` is one that would.
    """

    comparison: Comparison
    value: bool
    example: UncoveredEdge


@dataclass(frozen=True, slots=True)
class Ways:
    """What traces can do whose constants (values that cannot change) are the same.

    The first letter of each class, and a shortest word of classes to each reachable state.
    """

    letters: Mapping[int, int]
    paths: Mapping[int, tuple[int, ...]]


def ways_of(machine: MealyMonitor, vocabulary: Vocabulary) -> Mapping[Digits, Ways]:
    """What traces can do, per values of the constants; defaults first."""
    return {
        constants: Ways(letters, _shortest_paths(machine, letters))
        for constants, letters in possible_letters(machine, vocabulary).items()
    }


class ProposedExamples:
    """A rule's monitor, what traces can do, and a witness for each letter requested."""

    def __init__(
        self,
        rule: Rule,
        compiled: CompiledRule,
        rulebook: CompiledRulebook,
        facts: Sequence[Axiom],
    ) -> None:
        machine, vocabulary = compiled.machine, rulebook.vocabulary
        self._rule, self._machine, self._vocabulary = rule, machine, vocabulary
        self._compiled, self._rulebook = compiled, rulebook
        self._facts = facts
        # Numbers that stand for none, which need not be said.
        self._untold = {
            (term.name, term.arguments): float(default)
            for term, default in asked_whether_told(rule.formula, vocabulary).items()
        }
        known = axiom_instances(rule.variables, facts, vocabulary)
        self._axioms = [instance.formula for instance in known]
        self._ways = ways_of(machine, vocabulary)
        self._constant = constant_reads(machine.reads, vocabulary)
        self._witnesses: dict[int, CoverageWitness] = {}
        self._whole_states: dict[tuple[int, Digits], CoverageWitness | None] = {}
        sinks = (machine.rejecting_sink, machine.accepting_sink)
        # The states in which the verdict is not final yet.
        self._unsettled = {
            constants: tuple(state for state in sorted(ways.paths) if state not in sinks)
            for constants, ways in self._ways.items()
        }

    @cached_property
    def edges(self) -> Mapping[tuple[int, int], Digits]:
        """Edge -> the values of the constants in a shortest trace that ends with the edge."""
        shortest: dict[tuple[int, int], Digits] = {}
        for constants, ways in self._ways.items():
            for edge in itertools.product(self._unsettled[constants], ways.letters):
                known = shortest.get(edge)
                length = len(ways.paths[edge[0]])
                if known is None or length < len(self._ways[known].paths[edge[0]]):
                    shortest[edge] = constants
        return dict(sorted(shortest.items()))

    def uncovered(self, source: int, symbol: int) -> UncoveredEdge:
        """The edge with a shortest example."""
        constants = self.edges[source, symbol]
        ways = self._ways[constants]
        edge = self._edge(constants, source, symbol, self._witness(ways.letters[symbol]))
        word = (*ways.paths[source], symbol)
        return edge if edge.is_whole else self._whole(edge, word, constants)

    def untouched(self, side: LimitSide) -> UntouchedLimit | None:
        """The limit with an example close to it on one side; None if that makes no difference.

        One that need not be completed is preferred.
        """
        machine = self._machine
        edges = deciding_edges(side, machine, lambda letter: self._unsettled[self._fixed(letter)])
        found = None
        for source, letter in itertools.islice(edges, _MOST_TRIED):
            last = self._witness(letter)
            says = close_state(last.says, side, letter, machine, self._vocabulary)
            if says is not None:
                symbol, constants = machine.letters[letter], self._fixed(letter)
                moved = self._read_again(symbol, replace(last, says=says))
                edge = self._edge(constants, source, symbol, moved)
                found = found or UntouchedLimit(side.comparison, side.holds, edge)
                word = (*self._ways[constants].paths[source], symbol)
                if edge.is_whole and self._word(edge.states) == word:
                    return UntouchedLimit(side.comparison, side.holds, edge)
        return found

    def _edge(
        self, constants: Digits, source: int, symbol: int, last: CoverageWitness
    ) -> UncoveredEdge:
        ways = self._ways[constants]
        path = [self._witness(ways.letters[letter_class]) for letter_class in ways.paths[source]]
        # A constant may have been moved to a limit: it has to be the same in the states before.
        names = self._vocabulary.constants
        same = {subject: value for subject, value in last.says.items() if subject[0] in names}
        before = tuple(replace(state, says={**state.says, **same}) for state in path)
        return UncoveredEdge(
            source,
            self._machine.successors[source][symbol],
            (*before, last),
            self._machine.outputs[source][symbol],
        )

    def _whole(self, edge: UncoveredEdge, word: Digits, constants: Digits) -> UncoveredEdge:
        """The edge with an example that need not be completed, if one is found.

        Its states are others with the same effect, or there are further objects.
        """
        others = [self._whole_witness(symbol, constants) for symbol in word]
        if None not in others:
            return replace(edge, states=tuple(other for other in others if other is not None))
        classes = [self._classes.get((symbol, constants)) for symbol in word]
        try:
            example = self._counting.example([own for own in classes if own is not None])
        except UndecidedError:
            return edge
        if None in classes or example is None:
            return edge
        objects, says = example
        states = tuple(map(CoverageWitness, says))
        whole = replace(edge, states=states, objects=objects)
        return whole if self._word(states, objects) == word else edge

    def _whole_witness(self, symbol: int, constants: Digits) -> CoverageWitness | None:
        """A state in a class of letters with these constants that need not be completed."""
        key = symbol, constants
        if key not in self._whole_states:
            letters = itertools.islice(self._letters_of(symbol, constants), _MOST_TRIED)
            tried = (self._witness(letter) for letter in letters)
            self._whole_states[key] = next((one for one in tried if not one.besides), None)
        return self._whole_states[key]

    def _letters_of(self, symbol: int, constants: Digits) -> Iterator[int]:
        """The letters of a class with these constants, those near the first one first."""
        machine = self._machine
        first = self._ways[constants].letters[symbol]
        plain = digits_of(first, machine.reads)
        near = []
        for letter, letter_class in enumerate(machine.letters):
            if letter_class == symbol and self._fixed(letter) == constants:
                digits = digits_of(letter, machine.reads)
                if all(map(is_possible, machine.reads, digits)) and self._fit(digits):
                    near.append((sum(map(operator.ne, digits, plain)), letter))
        return (letter for _, letter in sorted(near))

    @cached_property
    def _fit(self) -> Callable[[Digits], bool]:
        return go_together(self._machine)

    @cached_property
    def _classes(self) -> Mapping[tuple[int, Digits], int]:
        """A number for each class of letters with the same constants."""
        kinds = dict.fromkeys(self._kind(letter) for letter in range(len(self._machine.letters)))
        return {kind: number for number, kind in enumerate(kinds)}

    def _kind(self, letter: int) -> tuple[int, Digits]:
        return self._machine.letters[letter], self._fixed(letter)

    @cached_property
    def _counting(self) -> ClassWitnesses:
        letters = range(len(self._machine.letters))
        classes = [self._classes[self._kind(letter)] for letter in letters]
        return ClassWitnesses(self._compiled, self._vocabulary, self._facts, classes)

    def _word(
        self, states: Iterable[CoverageWitness], objects: tuple[Variable, ...] = ()
    ) -> Digits | None:
        """The letter classes of states as an example would have them; None if they cannot be."""
        says = tuple(stated(state.says, self._vocabulary) for state in states)
        example = Example(accepts=True, states=says, objects=objects)
        alone = replace(self._rule, examples=(example,))
        if any(contradicted(alone, self._facts, self._vocabulary)):
            return None
        return word_of(self._rule, self._compiled, self._rulebook, example)

    def _read_again(self, symbol: int, state: CoverageWitness) -> CoverageWitness:
        """The state without words about what it has anyway, in a letter of the class ``symbol``."""
        says = {
            subject: value
            for subject, value in state.says.items()
            if self._untold.get(subject) != value
        }
        state = replace(state, says=says)
        as_wanted = self._word([replace(state, besides=())]) == (symbol,)
        return replace(state, besides=() if as_wanted else state.besides or _NOT_ALONE)

    def _fixed(self, letter: int) -> Digits:
        if not any(self._constant):
            return ()
        return tuple(itertools.compress(digits_of(letter, self._machine.reads), self._constant))

    def _witness(self, letter: int) -> CoverageWitness:
        if letter not in self._witnesses:
            witness = coverage_witness(
                letter, self._machine, self._rule.formula, self._vocabulary, self._axioms
            )
            self._witnesses[letter] = self._read_again(self._machine.letters[letter], witness)
        return self._witnesses[letter]


def _shortest_paths(machine: MealyMonitor, symbols: Iterable[int]) -> Mapping[int, tuple[int, ...]]:
    """A shortest word of letter classes to each reachable state."""
    paths: dict[int, tuple[int, ...]] = {0: ()}
    waiting = [0]
    for state in waiting:
        for symbol in sorted(symbols):
            target = machine.successors[state][symbol]
            if target not in paths:
                paths[target] = (*paths[state], symbol)
                waiting.append(target)
    return paths
