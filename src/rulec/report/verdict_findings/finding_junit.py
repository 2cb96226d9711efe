"""Findings of verdicts as JUnit XML, for continuous integration."""

from __future__ import annotations

from collections.abc import Sequence
from typing import IO
from xml.etree import ElementTree

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.report.text.xml_text import HEAD, element, written, xml_text
from rulec.report.verdict_findings.verdict_finding import (
    FindingContext,
    RecordingFindings,
    VerdictFinding,
)


class JUnitWriter:
    """A suite for each recording, with a case for each rule.

    A case fails if a hard rule is violated, like the exit status; violations of soft rules are its
    output. It is skipped, with the reason, if the rule could be judged for no vehicle, or if it is
    open and no violation is known: a case passes only if the rule is known to be kept.
    """

    def __init__(self, stream: IO[bytes], about: FindingContext) -> None:
        self._stream = stream
        self._about = about
        stream.write(f'{HEAD}<testsuites name="rulec">\n'.encode())

    def add(self, recording: RecordingFindings) -> None:
        """Write the suite of a recording."""
        by_rule = recording.by_rule
        suite = element(None, "testsuite", name=recording.title)
        name = self._about.rulebook.name
        if recording.failure:
            case = element(suite, "testcase", classname=name, name="reading", file=recording.file)
            element(case, "error", type="not judged", message=recording.failure)
        else:
            for rule in self._about.rules.values():
                _case(suite, name, rule, by_rule.get(rule.name, ()), recording)
            lines = [f"{x.vehicle}: not judged: {x.because}" for x in by_rule.get("", ())]
            if lines:
                element(suite, "system-out").text = xml_text("\n".join(lines))
        counts = {
            "tests": len(suite.findall("testcase")),
            "failures": len(suite.findall("testcase/failure")),
            "errors": len(suite.findall("testcase/error")),
            "skipped": len(suite.findall("testcase/skipped")),
        }
        suite.attrib.update({name: str(number) for name, number in counts.items()})
        self._stream.write(written(suite, 1))

    def close(self) -> None:
        """Write the end of the document."""
        self._stream.write(b"</testsuites>\n")


def _case(
    suite: ElementTree.Element,
    rulebook: str,
    rule: CompiledRule,
    findings: Sequence[VerdictFinding],
    recording: RecordingFindings,
) -> None:
    case = element(suite, "testcase", classname=rulebook, name=rule.name, file=recording.file)
    violated = [finding for finding in findings if finding.outcome == "violated"]
    others = [finding for finding in findings if finding.outcome == "open"]
    nowhere = [
        finding for finding in findings if finding.outcome == "not_judged" and not finding.vehicle
    ]
    lines = [finding.says for finding in violated]
    if violated and rule.strength == "hard":
        drives = len({finding.vehicle for finding in violated})
        share = f"violated in {drives:,} of {recording.drives:,} drives"
        failure = element(case, "failure", type="hard rule", message=f"{share}: {lines[0]}")
        failure.text = xml_text("\n".join(lines))
        lines = []
    elif nowhere and not violated and not others:
        words = ", ".join(nowhere[0].open_on)
        element(case, "skipped", message=nowhere[0].because or f"not told: {words}")
    elif others and not violated:
        drives = len({finding.vehicle for finding in others})
        share = f"open in {drives:,} of {recording.drives:,} drives"
        element(case, "skipped", message=f"{share}: {others[0].says}")
    lines += [finding.says for finding in others]
    if lines:
        element(case, "system-out").text = xml_text("\n".join(lines))
