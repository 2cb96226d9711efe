"""Outcomes of examples as JUnit XML."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rulec.book_tests.example_coverage import RuleCoverage, asked_of, percent
from rulec.book_tests.example_runs import ExampleRun
from rulec.diagnostics import Diagnostic, SourceLocation
from rulec.diagnostics.diagnostic import at
from rulec.files.read_files import from_here
from rulec.report.findings.diagnostics_text import render_diagnostics
from rulec.report.findings.junit import TAIL, JUnitCase, JUnitSuite, counts_of, head, suite_text
from rulec.report.tests.example_text import Besides, coverage_lines, failures


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
