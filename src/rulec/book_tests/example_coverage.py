"""Coverage of rules by examples: monitor edges, truth values, and verdicts."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.book_tests.book_test_messages import unexercised
from rulec.book_tests.example_runs import (
    ExampleOutcome,
    ExampleRun,
    example_trace,
    own_names,
)
from rulec.book_tests.limit_coverage import LimitSide, sides_of, touched
from rulec.book_tests.proposed_examples import (
    ProposedExamples,
    UncoveredEdge,
    UntouchedLimit,
    ways_of,
)
from rulec.diagnostics import Diagnostic
from rulec.logic.formula import Proposition, atoms_of
from rulec.logic.kleene import holds
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.uncertainty.known_words import KnownLetters
from rulec.rulebook.rulebook_model import Axiom, Rule
from rulec.value_display import short_repr
from rulec.vocabulary import Vocabulary
from rulec.witnesses.coverage_witness import truth_values


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


def _coverage(
    rule: Rule,
    compiled: CompiledRule,
    outcomes: Sequence[ExampleOutcome],
    rulebook: CompiledRulebook,
    facts: Sequence[Axiom],
) -> RuleCoverage:
    machine = compiled.machine
    known = ProposedExamples(rule, compiled, rulebook, facts)
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
        trace = with_derived_values(example_trace(rule, outcome.example), rulebook.vocabulary)
        reader = KnownLetters(trace, rulebook)
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
        for ways in ways_of(machine, vocabulary).values()
        for state in ways.paths
        for symbol in ways.letters
    }
