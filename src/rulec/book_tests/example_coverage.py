"""Coverage of rules by examples: monitor edges, truth values, and verdicts."""

from __future__ import annotations

import itertools
import operator
from collections import defaultdict
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.book_tests.book_test_messages import unexercised
from rulec.book_tests.example_runs import (
    ExampleOutcome,
    ExampleRun,
    example_trace,
    own_names,
    word_of,
)
from rulec.book_tests.limit_coverage import (
    LimitSide,
    close_state,
    deciding_edges,
    sides_of,
    touched,
)
from rulec.diagnostics import Diagnostic
from rulec.logic.formula import Comparison, Proposition, atoms_of
from rulec.logic.kleene import holds
from rulec.monitoring.verify import letter_reader_of
from rulec.rulebook.rulebook_model import Axiom, Example, ExampleState, Rule, Variable
from rulec.rulebook.rules.axiom_instances import axiom_instances
from rulec.rulebook.rules.axioms import contradicted
from rulec.value_display import short_repr
from rulec.vocabulary import Quantity, Vocabulary
from rulec.witnesses.coverage_witness import (
    CoverageWitness,
    asked_whether_told,
    coverage_witness,
    go_together,
    is_possible,
    possible_letters,
    truth_values,
)
from rulec.witnesses.letter_functions import Digits, constant_reads, digits_of
from rulec.witnesses.letter_witness import LetterWitnesses

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
class RuleCoverage:
    """Edges, truth values and limits of a rule that its examples cover.

    An edge is a state of the rule's machine with a class of letters; edges from the two states in
    which the verdict is final do not count, nor do letters that no state of the world can have. The
    values of an atom or a comparison are true and false, as far as they are possible. A limit
    counts once per side: an example should be close to it on each side where that makes a
    difference. A rule is ``inherited`` if the rulebook took it unchanged from another one.
    """

    __repr__ = short_repr

    rule: str
    n_edges: int
    missing_edges: tuple[UncoveredEdge, ...]
    n_values: int
    missing_values: tuple[tuple[Proposition, bool], ...]
    n_limits: int = 0
    missing_limits: tuple[UntouchedLimit, ...] = ()
    inherited: bool = False

    @property
    def total(self) -> int:
        """The number of edges, values of atoms, and sides of limits."""
        return self.n_edges + self.n_values + self.n_limits

    @property
    def covered(self) -> int:
        """The number of those that examples take or have."""
        missing = (self.missing_edges, self.missing_values, self.missing_limits)
        return self.total - sum(map(len, missing))


def percent(rules: Iterable[RuleCoverage]) -> float:
    """Percentage of edges, values and limits covered; 100 if there are none."""
    rules = list(rules)
    total = sum(rule.total for rule in rules)
    return 100.0 * sum(rule.covered for rule in rules) / total if total else 100.0


def asked_of(rules: Iterable[RuleCoverage], patterns: Sequence[str]) -> list[RuleCoverage]:
    """The rules that a rulebook has to cover: its own, or all those chosen by patterns.

    Inherited rules are to be covered by the examples of the rulebook that wrote them.
    """
    return [rule for rule in rules if patterns or not rule.inherited]


def coverage(run: ExampleRun) -> tuple[RuleCoverage, ...]:
    """The coverage of every rule by the examples that were run.

    If patterns were given, rules are left out if neither they nor their examples match. A rule that
    matches but has no example is included, with nothing covered.
    """
    covered = []
    for rule, compiled, outcomes in _by_rule(run):
        if outcomes or run.names(rule):
            of_rule = _coverage(rule, compiled, outcomes, run.compiled, run.rulebook.axioms)
            covered.append(replace(of_rule, inherited=rule.book not in ("", run.rulebook.name)))
    return tuple(covered)


def _by_rule(run: ExampleRun) -> Iterator[tuple[Rule, CompiledRule, list[ExampleOutcome]]]:
    outcomes: defaultdict[int, list[ExampleOutcome]] = defaultdict(list)
    for outcome in run.outcomes:
        outcomes[id(outcome.rule)].append(outcome)
    for rule, compiled in zip(run.rulebook.rules, run.compiled.rules, strict=True):
        yield rule, compiled, outcomes[id(rule)]


@dataclass(frozen=True, slots=True)
class _Ways:
    """What traces can do whose constants (values that cannot change) are the same.

    The first letter of each class, and a shortest word of classes to each reachable state.
    """

    letters: Mapping[int, int]
    paths: Mapping[int, tuple[int, ...]]


def _ways(machine: MealyMonitor, vocabulary: Vocabulary) -> Mapping[Digits, _Ways]:
    """What traces can do, per values of the constants; defaults first."""
    return {
        constants: _Ways(letters, _shortest_paths(machine, letters))
        for constants, letters in possible_letters(machine, vocabulary).items()
    }


class _RuleExamples:
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
        self._ways = _ways(machine, vocabulary)
        self._constant = constant_reads(machine.reads, vocabulary)
        self._witnesses: dict[int, CoverageWitness] = {}
        self._plain: dict[tuple[int, Digits], int | None] = {}
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
        letters = [self._plainest(symbol, constants) for symbol in word]
        if None in letters:
            return edge
        trace = self._counting.trace([letter for letter in letters if letter is not None])
        states = tuple(map(CoverageWitness, trace.states))
        whole = replace(edge, states=states, objects=trace.objects)
        return whole if self._word(states, trace.objects) == word else edge

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

    def _plainest(self, symbol: int, constants: Digits) -> int | None:
        key = symbol, constants
        if key not in self._plain:
            self._plain[key] = self._counting.plainest(symbol, constants)
        return self._plain[key]

    @cached_property
    def _counting(self) -> LetterWitnesses:
        return LetterWitnesses(self._compiled, self._vocabulary)

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


def _coverage(
    rule: Rule,
    compiled: CompiledRule,
    outcomes: Sequence[ExampleOutcome],
    rulebook: CompiledRulebook,
    facts: Sequence[Axiom],
) -> RuleCoverage:
    machine = compiled.machine
    known = _RuleExamples(rule, compiled, rulebook, facts)
    taken = {edge for outcome in outcomes for edge in _edges_taken(machine, outcome.word)}
    values = [
        (proposition, value)
        for proposition, possible in truth_values(
            list(dict.fromkeys(atoms_of(rule.formula))), machine
        ).items()
        for value in possible
    ]
    sides = sides_of(rule.formula, rulebook.vocabulary)
    seen: set[tuple[Proposition, object]] = set()
    near: set[LimitSide] = set()
    for outcome in outcomes:
        trace = example_trace(rule, outcome.example)
        reader = letter_reader_of(trace, rulebook)
        for number in range(len(trace.states)):
            state = reader.view(number)
            seen |= {(atom, holds(atom, own_names(rule), state)) for atom, _ in values}
            near.update(touched(sides, own_names(rule), state))
    limits = [known.untouched(side) for side in sides if side not in near]
    missing_limits = tuple(limit for limit in limits if limit is not None)
    return RuleCoverage(
        rule=rule.name,
        n_edges=len(known.edges),
        missing_edges=tuple(known.uncovered(*edge) for edge in known.edges if edge not in taken),
        n_values=len(values),
        missing_values=tuple(value for value in values if value not in seen),
        n_limits=len(near) + len(missing_limits),
        missing_limits=missing_limits,
    )


def _edges_taken(machine: MealyMonitor, word: Sequence[int]) -> Iterator[tuple[int, int]]:
    state = 0
    for symbol in word:
        yield state, symbol
        state = machine.successors[state][symbol]


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


def uncovered_verdicts(run: ExampleRun) -> Iterator[Diagnostic]:
    """Warnings (R0408) about rules whose examples show only one of the two verdicts.

    Rules with a failing example are left out, because that has to be corrected first. If patterns
    were given, the only warning is that a rule named by them has no example.
    """
    for rule, compiled, outcomes in _by_rule(run):
        if run.patterns and (outcomes or not run.names(rule)):
            continue
        shown = {outcome.accepted for outcome in outcomes}
        if len(shown) < 2 and all(outcome.passed for outcome in outcomes):
            missing = verdicts(compiled.machine, run.compiled.vocabulary) - shown
            if missing:
                yield unexercised(rule, missing, any_examples=bool(outcomes))


def verdicts(machine: MealyMonitor, vocabulary: Vocabulary) -> set[bool]:
    """The verdicts that a rule can have: accepted (True), rejected (False), or both."""
    return {
        machine.outputs[state][symbol]
        for ways in _ways(machine, vocabulary).values()
        for state in ways.paths
        for symbol in ways.letters
    }
