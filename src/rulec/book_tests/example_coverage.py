"""Coverage of rules by examples: monitor edges, truth values, and verdicts."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.book_tests.book_test_messages import unexercised
from rulec.book_tests.example_runs import ExampleOutcome, ExampleRun, example_trace, own_names
from rulec.book_tests.limit_coverage import (
    LimitSide,
    close_state,
    deciding_edges,
    sides_of,
    touched,
)
from rulec.diagnostics import Diagnostic
from rulec.logic.formula import Comparison, Formula, Proposition, atoms_of
from rulec.logic.kleene import holds
from rulec.monitoring.verify import letter_reader_of
from rulec.rulebook.rulebook_model import Rule
from rulec.rulebook.rules.axiom_instances import axiom_instances
from rulec.value_display import short_repr
from rulec.vocabulary import Vocabulary
from rulec.witnesses.coverage_witness import (
    CoverageWitness,
    coverage_witness,
    possible_letters,
    truth_values,
)
from rulec.witnesses.letter_functions import Digits, constant_reads, digits_of

_MOST_TRIED = 16
"""Number of letters tried to find a state close to a limit."""


@dataclass(frozen=True, slots=True)
class UncoveredEdge:
    """A monitor edge that no example takes, with a shortest example for it.

    The edge leads from state ``source`` to ``target``; ``accepted`` is the rule's verdict on the
    example.
    """

    source: int
    target: int
    states: tuple[CoverageWitness, ...]
    accepted: bool


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
            known = axiom_instances(rule.variables, run.rulebook.axioms, run.rulebook.vocabulary)
            axioms = [outcome.formula for outcome in known]
            of_rule = _coverage(rule, compiled, outcomes, run.compiled, axioms)
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
        machine: MealyMonitor,
        vocabulary: Vocabulary,
        axioms: Sequence[Formula],
    ) -> None:
        self._rule, self._machine, self._vocabulary = rule, machine, vocabulary
        self._axioms = axioms
        self._ways = _ways(machine, vocabulary)
        self._constant = constant_reads(machine.reads, vocabulary)
        self._witnesses: dict[int, CoverageWitness] = {}
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
        last = self._witness(self._ways[constants].letters[symbol])
        return self._edge(constants, source, symbol, last)

    def untouched(self, side: LimitSide) -> UntouchedLimit | None:
        """The limit with an example close to it on one side; None if that makes no difference."""
        machine = self._machine
        edges = deciding_edges(side, machine, lambda letter: self._unsettled[self._fixed(letter)])
        for source, letter in itertools.islice(edges, _MOST_TRIED):
            last = self._witness(letter)
            says = close_state(last.says, side, machine, self._vocabulary)
            if says is not None:
                symbol, constants = machine.letters[letter], self._fixed(letter)
                edge = self._edge(constants, source, symbol, replace(last, says=says))
                return UntouchedLimit(side.comparison, side.holds, edge)
        return None

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

    def _fixed(self, letter: int) -> Digits:
        if not any(self._constant):
            return ()
        return tuple(itertools.compress(digits_of(letter, self._machine.reads), self._constant))

    def _witness(self, letter: int) -> CoverageWitness:
        if letter not in self._witnesses:
            self._witnesses[letter] = coverage_witness(
                letter, self._machine, self._rule.formula, self._vocabulary, self._axioms
            )
        return self._witnesses[letter]


def _coverage(
    rule: Rule,
    compiled: CompiledRule,
    outcomes: Sequence[ExampleOutcome],
    rulebook: CompiledRulebook,
    axioms: Sequence[Formula],
) -> RuleCoverage:
    machine = compiled.machine
    known = _RuleExamples(rule, machine, rulebook.vocabulary, axioms)
    taken = {edge for outcome in outcomes for edge in _edges_taken(machine, outcome.word)}
    values = [
        (proposition, value)
        for proposition, possible in truth_values(
            list(dict.fromkeys(atoms_of(rule.formula))), machine
        ).items()
        for value in possible
    ]
    sides = sides_of(rule.formula)
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
