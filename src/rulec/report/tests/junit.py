"""Results of examples as JUnit XML, for continuous integration."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

from rulec.book_tests.example_coverage import RuleCoverage, asked_of, percent
from rulec.book_tests.example_runs import ExampleOutcome, ExampleRun
from rulec.diagnostics import Diagnostic
from rulec.diagnostics.diagnostic import at
from rulec.files.read_files import from_here
from rulec.report.findings.diagnostics_text import render_diagnostics
from rulec.report.tests.example_text import Besides, coverage_lines, failures
from rulec.report.text.xml_text import HEAD, element, xml_text


def as_junit(
    runs: Sequence[ExampleRun],
    covered: Sequence[Sequence[RuleCoverage]] | None,
    besides: Besides,
) -> str:
    """A suite for each rulebook with a case for each example.

    A rulebook that could not be tested has one case with its error; requirements not met are
    failures in a separate suite.
    """
    counts = _counts(runs, errors=len(besides.unread), short=len(besides.short))
    root = element(None, "testsuites", name="rulec", **counts)
    for number, run in enumerate(runs):
        suite = element(root, "testsuite", name=run.name, **_counts([run]))
        if covered is not None:
            part = f"{percent(asked_of(covered[number], run.patterns)):.3f}"
            element(element(suite, "properties"), "property", name="coverage", value=part)
        failing = failures(run)
        for index, outcome in enumerate(run.outcomes):
            _case(suite, run.name, outcome, failing.get(index))
        if covered is not None:
            lines = coverage_lines(covered[number], run.rulebook.vocabulary)
            element(suite, "system-out").text = xml_text("\n".join(lines))
    for name, problems in besides.unread.items():
        suite = element(root, "testsuite", name=name, **_counts([], errors=1))
        place = next((location for diagnostic in problems if (location := diagnostic.place)), None)
        where = (
            {"file": name} if place is None else {"file": from_here(place.file), "line": place.line}
        )
        case = element(suite, "testcase", classname=name, name="reading", **where)
        first = problems[0]
        error = element(case, "error", type=first.code, message=first.message)
        error.text = xml_text(render_diagnostics(problems, summary=False))
    if besides.short:
        suite = element(root, "testsuite", name="rulec", **_counts([], short=len(besides.short)))
        for threshold, sentence in besides.short.items():
            case = element(suite, "testcase", classname="rulec", name=threshold)
            element(case, "failure", type="threshold", message=sentence)
    ElementTree.indent(root)
    written = ElementTree.tostring(root, encoding="unicode")
    return f"{HEAD}{written}"


def _counts(runs: Sequence[ExampleRun], *, errors: int = 0, short: int = 0) -> dict[str, int]:
    outcomes = [outcome for run in runs for outcome in run.outcomes]
    failures = sum(not outcome.passed for outcome in outcomes) + short
    return {
        "tests": len(outcomes) + errors + short,
        "failures": failures,
        "errors": errors,
        "skipped": 0,
    }


def _case(
    suite: ElementTree.Element,
    rulebook: str,
    example_outcome: ExampleOutcome,
    problem: Diagnostic | None,
) -> None:
    place = at(example_outcome.example.span)
    case = element(
        suite,
        "testcase",
        classname=f"{rulebook}.{example_outcome.rule.name}",
        name=example_outcome.name,
        file=None if place is None else from_here(place.file),
        line=None if place is None else place.line,
    )
    if problem is not None:
        failure = element(case, "failure", type=problem.code, message=problem.message)
        failure.text = xml_text(render_diagnostics([problem], summary=False))
