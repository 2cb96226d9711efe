"""Results of examples as JUnit XML, for continuous integration."""

from __future__ import annotations

from collections.abc import Sequence
from xml.etree import ElementTree

from rulec.book_tests.example_coverage import RuleCoverage, percent
from rulec.book_tests.example_runs import ExampleOutcome, ExampleRun
from rulec.diagnostics.diagnostic import at
from rulec.report.findings.diagnostics_text import render_diagnostics
from rulec.report.tests.example_text import coverage_lines, failure
from rulec.report.text.xml_text import HEAD, xml_text


def as_junit(runs: Sequence[ExampleRun], covered: Sequence[Sequence[RuleCoverage]] | None) -> str:
    """A suite for each rulebook, in it a case for each example."""
    root = ElementTree.Element("testsuites", {"name": "rulec", **_counts(runs)})
    for number, run in enumerate(runs):
        suite = ElementTree.SubElement(
            root, "testsuite", {"name": xml_text(run.rulebook.name), **_counts([run])}
        )
        if covered is not None:
            properties = ElementTree.SubElement(suite, "properties")
            part = f"{percent(covered[number]):.3f}"
            ElementTree.SubElement(properties, "property", {"name": "coverage", "value": part})
        for outcome in run.outcomes:
            _case(suite, run.rulebook.name, outcome)
        if covered is not None:
            lines = coverage_lines(covered[number], run.rulebook.vocabulary)
            output = ElementTree.SubElement(suite, "system-out")
            output.text = xml_text("\n".join(lines))
    ElementTree.indent(root)
    written = ElementTree.tostring(root, encoding="unicode")
    return f"{HEAD}{written}"


def _counts(runs: Sequence[ExampleRun]) -> dict[str, str]:
    outcomes = [outcome for run in runs for outcome in run.outcomes]
    failures = sum(not outcome.passed for outcome in outcomes)
    return {"tests": str(len(outcomes)), "failures": str(failures), "errors": "0", "skipped": "0"}


def _case(suite: ElementTree.Element, rulebook: str, example_outcome: ExampleOutcome) -> None:
    attributes = {
        "classname": f"{rulebook}.{example_outcome.rule.name}",
        "name": example_outcome.name,
    }
    place = at(example_outcome.example.span)
    if place is not None:
        attributes |= {"file": place.file, "line": str(place.line)}
    case = ElementTree.SubElement(
        suite, "testcase", {name: xml_text(value) for name, value in attributes.items()}
    )
    if not example_outcome.passed:
        problem = failure(example_outcome, rulebook)
        attributes = {"type": problem.code, "message": xml_text(problem.message)}
        element = ElementTree.SubElement(case, "failure", attributes)
        element.text = xml_text(render_diagnostics([problem], summary=False))
