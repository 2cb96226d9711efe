"""Coverage of verdicts: whether examples show a rule both kept and broken."""

from __future__ import annotations

from collections.abc import Iterator

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.book_tests.book_test_messages import unexercised
from rulec.book_tests.example_runs import ExampleOutcome, ExampleRun
from rulec.diagnostics import Diagnostic
from rulec.witnesses.coverage_witness import possible_letters


def uncovered_verdicts(run: ExampleRun) -> Iterator[Diagnostic]:
    """Warnings (R0408) about rules whose examples show one of two verdicts.

    Rules with an example that fails are left out, for that has to be mended first. So is every rule
    where a pattern chose among the examples.
    """
    if run.pattern is not None:
        return
    of_rule: dict[int, list[ExampleOutcome]] = {id(rule): [] for rule in run.rulebook.rules}
    for outcome in run.outcomes:
        of_rule[id(outcome.rule)].append(outcome)
    for rule, compiled in zip(run.rulebook.rules, run.compiled.rules, strict=True):
        outcomes = of_rule[id(rule)]
        if not all(outcome.passed for outcome in outcomes):
            continue
        shown = {outcome.accepted for outcome in outcomes}
        if len(shown) < 2 and (missing := verdicts(compiled.machine) - shown):
            yield unexercised(rule, missing, any_examples=bool(outcomes))


def verdicts(machine: MealyMonitor) -> set[bool]:
    """Verdicts that a rule can have: accepted (True), rejected (False), or both."""
    symbols = sorted(possible_letters(machine))
    reached_verdicts: set[bool] = set()
    waiting = [0]
    seen = {0}
    for state in waiting:
        reached_verdicts.update(machine.outputs[state][symbol] for symbol in symbols)
        if len(reached_verdicts) == 2:
            break
        new = {machine.successors[state][symbol] for symbol in symbols} - seen
        seen |= new
        waiting += sorted(new)
    return reached_verdicts
