"""Outcomes of examples as JSON and as JUnit XML."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, Literal

from rulec.book_tests.example_coverage import RuleCoverage, asked_of, percent
from rulec.book_tests.example_runs import ExampleOutcome, ExampleRun
from rulec.diagnostics import Diagnostic, SourceLocation
from rulec.diagnostics.diagnostic import at
from rulec.files.read_files import from_here
from rulec.logic.printing import formula_text
from rulec.report.findings.diagnostics_json import PlaceData
from rulec.report.findings.diagnostics_text import render_diagnostics
from rulec.report.findings.junit import TAIL, JUnitCase, JUnitSuite, counts_of, head, suite_text
from rulec.report.json_document import JsonDocument, JsonPart, as_indented, filled
from rulec.report.tests.example_text import (
    Besides,
    asked_rules,
    coverage_lines,
    failures,
    missing_example,
)


def as_junit(
    runs: Sequence[ExampleRun],
    covered: Sequence[Sequence[RuleCoverage]] | None,
    besides: Besides,
) -> str:
    """A suite for each rulebook with a case for each example.

    A rulebook that could not be tested has one case with its error; requirements not met are
    failures in a separate suite.
    """
    every = [None] * len(runs) if covered is None else covered
    suites = [_suite(run, coverage) for run, coverage in zip(runs, every, strict=True)]
    for name, problems in besides.unread.items():
        place = next((location for problem in problems if (location := problem.place)), None)
        result = _result("error", problems)
        case = JUnitCase(group=name, name="reading", **_where(place, name), **result)
        suites.append(JUnitSuite(name=name, cases=[case]))
    short = [
        JUnitCase(group="rulec", name=name, result="failure", kind="threshold", message=sentence)
        for name, sentence in besides.short.items()
    ]
    suites += [JUnitSuite(name="rulec", cases=short)] if short else []
    return "".join((head(**counts_of(suites)), *map(suite_text, suites), TAIL))


def _suite(run: ExampleRun, covered: Sequence[RuleCoverage] | None) -> JUnitSuite:
    failing = failures(run)
    cases = [
        JUnitCase(
            group=f"{run.name}.{outcome.rule.name}",
            name=outcome.name,
            **_where(at(outcome.example.span)),
            **(_result("failure", [failing[number]]) if number in failing else {}),
        )
        for number, outcome in enumerate(run.outcomes)
    ]
    if covered is None:
        return JUnitSuite(name=run.name, cases=cases)
    lines = coverage_lines(covered, run.rulebook.vocabulary)
    part = percent(asked_of(covered, run.patterns))
    return JUnitSuite(name=run.name, cases=cases, coverage=part, output="\n".join(lines))


def _where(place: SourceLocation | None, file: str | None = None) -> dict[str, Any]:
    return {"file": file} if place is None else {"file": from_here(place.file), "line": place.line}


def _result(result: str, problems: Sequence[Diagnostic]) -> dict[str, Any]:
    first, text = problems[0], render_diagnostics(problems, summary=False)
    return {"result": result, "kind": first.code, "message": first.message, "text": text}


ExampleVerdict = Literal["accept", "reject"]


class OutcomeData(JsonPart, frozen=True, kw_only=True):
    """An example: the verdict it states, and the rule's verdict."""

    rulebook: str
    rule: str
    label: str
    number: int
    says: ExampleVerdict
    does: ExampleVerdict
    passed: bool
    lost_after: int | None
    place: PlaceData | None


class MissingEdgeData(JsonPart, frozen=True, kw_only=True):
    """An edge that no example takes, and an example that would."""

    source: int
    target: int
    example: str


class MissingValueData(JsonPart, frozen=True, kw_only=True):
    """A value of an atom that no example has."""

    atom: str
    value: bool


class MissingLimitData(JsonPart, frozen=True, kw_only=True):
    """A limit that no example comes close to with this value, and an example that would."""

    limit: str
    value: bool
    example: str


class RuleCoverageData(JsonPart, frozen=True, kw_only=True):
    """Coverage of a rule's automaton and its atoms' values by examples."""

    rulebook: str
    rule: str
    inherited: bool
    percent: float
    edges: int
    missing_edges: Sequence[MissingEdgeData]
    values: int
    missing_values: Sequence[MissingValueData]
    limits: int
    missing_limits: Sequence[MissingLimitData]


class CoverageData(JsonPart, frozen=True, kw_only=True):
    """The coverage of own rules, of all with inherited ones, and of each rule."""

    percent: float
    percent_with_inherited: float
    rules: Sequence[RuleCoverageData]


class ExamplesRun(JsonDocument, frozen=True, kw_only=True):
    """The examples of rulebooks; ``coverage`` is null unless requested."""

    examples: Sequence[OutcomeData]
    passed: int
    failed: int
    coverage: CoverageData | None


def as_json(runs: Sequence[ExampleRun], covered: Sequence[Sequence[RuleCoverage]] | None) -> str:
    """Write the runs of rulebooks, each with coverage unless it is None."""
    passed = [outcome.passed for run in runs for outcome in run.outcomes]
    return as_indented(
        ExamplesRun(
            examples=[_outcome(run, outcome) for run in runs for outcome in run.outcomes],
            passed=sum(passed),
            failed=len(passed) - sum(passed),
            coverage=None if covered is None else _coverage(runs, covered),
        )
    )


def _outcome(run: ExampleRun, outcome: ExampleOutcome) -> OutcomeData:
    return filled(
        OutcomeData,
        outcome,
        outcome.example,
        rulebook=run.name,
        rule=outcome.rule.name,
        says="accept" if outcome.example.accepts else "reject",
        does="accept" if outcome.accepted else "reject",
        place=at(outcome.example.span),
    )


def _coverage(
    runs: Sequence[ExampleRun], covered: Sequence[Sequence[RuleCoverage]]
) -> CoverageData:
    return CoverageData(
        percent=round(percent(asked_rules(runs, covered)), 3),
        percent_with_inherited=round(percent(rule for rules in covered for rule in rules), 3),
        rules=[
            _rule(run, rule) for run, rules in zip(runs, covered, strict=True) for rule in rules
        ],
    )


def _rule(run: ExampleRun, rule: RuleCoverage) -> RuleCoverageData:
    vocabulary = run.rulebook.vocabulary
    return filled(
        RuleCoverageData,
        rule,
        rulebook=run.name,
        percent=round(percent([rule]), 3),
        edges=rule.n_edges,
        missing_edges=[
            filled(MissingEdgeData, edge, example=missing_example(edge, vocabulary))
            for edge in rule.missing_edges
        ],
        values=rule.n_values,
        missing_values=[
            MissingValueData(atom=formula_text(atom), value=value)
            for atom, value in rule.missing_values
        ],
        limits=rule.n_limits,
        missing_limits=[
            MissingLimitData(
                limit=formula_text(limit.comparison),
                value=limit.value,
                example=missing_example(limit.example, vocabulary),
            )
            for limit in rule.missing_limits
        ],
    )
