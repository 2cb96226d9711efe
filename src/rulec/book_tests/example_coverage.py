"""Coverage of rules by examples: monitor edges, truth values, and verdicts."""

from __future__ import annotations

import itertools
from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

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

_MOST_TRIED = 16
"""Letters that are tried for a state close to a limit."""


@dataclass(frozen=True, slots=True)
class UncoveredEdge:
    """Monitor edge that no example takes, with a shortest example for it.

    The edge leads from state ``source`` to ``target``; ``accepted`` is what the rule does with the
    example.
    """

    source: int
    target: int
    states: tuple[CoverageWitness, ...]
    accepted: bool


@dataclass(frozen=True, slots=True)
class UntouchedLimit:
    """A limit that no example comes close to where its comparison has this value.

    ``example`` would.
    """

    comparison: Comparison
    value: bool
    example: UncoveredEdge


@dataclass(frozen=True, slots=True)
class RuleCoverage:
    """Edges, truth values and limits of a rule that its examples cover.

    An edge is a state of its machine and a class of letters; the edges of the two states in which
    the verdict is settled for good do not count, nor does what no state of the world can be. The
    values of an atom or a comparison are true and false, as far as it can have them, and those of
    a limit that examples are close to it on both sides, where that makes a difference. A rule is
    ``inherited`` if the rulebook that was run has it as another one wrote it.
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
        """Edges, values of atoms, and sides of limits, together."""
        return self.n_edges + self.n_values + self.n_limits

    @property
    def covered(self) -> int:
        """Those of them that are taken or seen."""
        missing = (self.missing_edges, self.missing_values, self.missing_limits)
        return self.total - sum(map(len, missing))


def percent(rules: Iterable[RuleCoverage]) -> float:
    """Percentage of edges, values and limits covered; 100 if there are none."""
    rules = list(rules)
    total = sum(rule.total for rule in rules)
    return 100.0 * sum(rule.covered for rule in rules) / total if total else 100.0


def asked_of(rules: Iterable[RuleCoverage], patterns: Sequence[str]) -> list[RuleCoverage]:
    """The rules that a rulebook has to cover: its own, or all that patterns have chosen.

    What it inherits is for the examples of who wrote it.
    """
    return [rule for rule in rules if patterns or not rule.inherited]


def coverage(run: ExampleRun) -> tuple[RuleCoverage, ...]:
    """The coverage of every rule by the examples that were run.

    Where patterns chose, rules are left out that none matches, nor any of their examples. One
    that one matches and that has no example is there: nothing of it is covered.
    """
    covered = []
    for rule, compiled, outcomes in _by_rule(run):
        if outcomes or run.names(rule):
            known = axiom_instances(rule.variables, run.rulebook.axioms, run.rulebook.vocabulary)
            axioms = [outcome.formula for outcome in known]
            one = _coverage(rule, compiled, outcomes, run.compiled, axioms)
            covered.append(replace(one, inherited=rule.book not in ("", run.rulebook.name)))
    return tuple(covered)


def _by_rule(run: ExampleRun) -> Iterator[tuple[Rule, CompiledRule, list[ExampleOutcome]]]:
    outcomes: defaultdict[int, list[ExampleOutcome]] = defaultdict(list)
    for outcome in run.outcomes:
        outcomes[id(outcome.rule)].append(outcome)
    for rule, compiled in zip(run.rulebook.rules, run.compiled.rules, strict=True):
        yield rule, compiled, outcomes[id(rule)]


@dataclass(frozen=True, slots=True, eq=False)
class _RuleExamples:
    """A rule's monitor, a shortest word to each reachable state, a witness of each letter class."""

    rule: Rule
    machine: MealyMonitor
    vocabulary: Vocabulary
    axioms: Sequence[Formula]
    paths: Mapping[int, tuple[int, ...]]
    witnesses: Mapping[int, CoverageWitness]

    @property
    def unsettled(self) -> list[int]:
        """The reachable states in which the verdict is not settled for good."""
        sinks = (self.machine.rejecting_sink, self.machine.accepting_sink)
        return [state for state in sorted(self.paths) if state not in sinks]

    def uncovered(
        self, source: int, symbol: int, last: CoverageWitness | None = None
    ) -> UncoveredEdge:
        """The edge with its shortest example, whose ``last`` state may be given."""
        before = [self.witnesses[letter_class] for letter_class in self.paths[source]]
        return UncoveredEdge(
            source,
            self.machine.successors[source][symbol],
            (*before, self.witnesses[symbol] if last is None else last),
            self.machine.outputs[source][symbol],
        )

    def untouched(self, side: LimitSide) -> UntouchedLimit | None:
        """The limit with an example that is close to it on a side, if that makes a difference."""
        found = deciding_edges(side, self.machine, self.unsettled)
        for source, letter in itertools.islice(found, _MOST_TRIED):
            formula = self.rule.formula
            last = coverage_witness(letter, self.machine, formula, self.vocabulary, self.axioms)
            says = close_state(last.says, side, self.machine, self.vocabulary)
            if says is not None:
                symbol = self.machine.letters[letter]
                edge = self.uncovered(source, symbol, replace(last, says=says))
                return UntouchedLimit(side.comparison, side.holds, edge)
        return None


def _rule_examples(
    rule: Rule, machine: MealyMonitor, vocabulary: Vocabulary, axioms: Sequence[Formula]
) -> _RuleExamples:
    letters = possible_letters(machine)
    witnesses = {
        symbol: coverage_witness(letter, machine, rule.formula, vocabulary, axioms)
        for symbol, letter in letters.items()
    }
    paths = _shortest_paths(machine, letters)
    return _RuleExamples(rule, machine, vocabulary, axioms, paths=paths, witnesses=witnesses)


def _coverage(
    rule: Rule,
    compiled: CompiledRule,
    outcomes: Sequence[ExampleOutcome],
    rulebook: CompiledRulebook,
    axioms: Sequence[Formula],
) -> RuleCoverage:
    machine = compiled.machine
    known = _rule_examples(rule, machine, rulebook.vocabulary, axioms)
    edges = list(itertools.product(known.unsettled, sorted(known.witnesses)))
    taken = {edge for outcome in outcomes for edge in _taken(machine, outcome.word)}
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
        n_edges=len(edges),
        missing_edges=tuple(known.uncovered(*edge) for edge in edges if edge not in taken),
        n_values=len(values),
        missing_values=tuple(value for value in values if value not in seen),
        n_limits=len(near) + len(missing_limits),
        missing_limits=missing_limits,
    )


def _taken(machine: MealyMonitor, word: Sequence[int]) -> Iterator[tuple[int, int]]:
    state = 0
    for symbol in word:
        yield state, symbol
        state = machine.successors[state][symbol]


def _shortest_paths(machine: MealyMonitor, symbols: Iterable[int]) -> Mapping[int, tuple[int, ...]]:
    """Shortest word of letter classes to each reachable state."""
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
    """Warnings (R0408) about rules whose examples show one of two verdicts.

    Rules with an example that fails are left out, for that has to be mended first. Where patterns
    chose among the examples, it is only said of the rules that they name that they have none.
    """
    for rule, compiled, outcomes in _by_rule(run):
        if run.patterns and (outcomes or not run.names(rule)):
            continue
        shown = {outcome.accepted for outcome in outcomes}
        if len(shown) < 2 and all(outcome.passed for outcome in outcomes):
            missing = verdicts(compiled.machine) - shown
            if missing:
                yield unexercised(rule, missing, any_examples=bool(outcomes))


def verdicts(machine: MealyMonitor) -> set[bool]:
    """Verdicts that a rule can have: accepted (True), rejected (False), or both."""
    symbols = possible_letters(machine)
    reachable = _shortest_paths(machine, symbols)
    return {machine.outputs[state][symbol] for state in reachable for symbol in symbols}
