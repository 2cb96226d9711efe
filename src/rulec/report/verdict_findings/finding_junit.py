"""Findings of verdicts as JUnit XML, for continuous integration."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
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
    """A suite for each recording, with a case for each rule and each drive that was judged.

    A case fails if a hard rule is violated, like the exit status; a violated soft rule is its
    output. It is skipped, with the reason, if the rule is open or not judged for the drive: a case
    passes only if the rule is known to be kept. A rule that was judged for no drive has one case.
    """

    def __init__(self, stream: IO[bytes], about: FindingContext) -> None:
        self._stream = stream
        self._about = about
        stream.write(f'{HEAD}<testsuites name="rulec">\n'.encode())

    def add(self, recording: RecordingFindings) -> None:
        """Write the suite of a recording."""
        suite = element(None, "testsuite", name=recording.title)
        if recording.failure:
            book = self._about.rulebook.name
            case = element(suite, "testcase", classname=book, name="reading", file=recording.file)
            element(case, "error", type="not judged", message=recording.failure)
        else:
            by_rule = recording.by_rule
            for rule in self._about.rules.values():
                suite.extend(self._cases(rule, by_rule.get(rule.name, ()), recording))
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

    def _cases(
        self, rule: CompiledRule, findings: Sequence[VerdictFinding], recording: RecordingFindings
    ) -> Iterator[ElementTree.Element]:
        """The cases of a rule."""
        book = self._about.rulebook.name
        by_drive: dict[str, list[VerdictFinding]] = {}
        for finding in findings:
            by_drive.setdefault(finding.vehicle, []).append(finding)
        if nowhere := by_drive.get(""):
            yield _case(book, rule.name, recording.file, nowhere)
            return
        for drive in recording.drives:
            found = by_drive.get(drive, [])
            yield _case(f"{book}.{rule.name}", drive, recording.file, found)


def _case(
    classname: str, name: str, file: str, findings: Sequence[VerdictFinding]
) -> ElementTree.Element:
    """A case with the findings of a rule in a drive."""
    case = element(None, "testcase", classname=classname, name=name, file=file)
    violated = [finding for finding in findings if finding.outcome == "violated"]
    lines = [finding.says for finding in findings]
    if violated and violated[0].strength == "hard":
        failure = element(case, "failure", type="hard rule", message=lines[0])
        failure.text = xml_text("\n".join(lines))
    elif violated:
        element(case, "system-out").text = xml_text("\n".join(lines))
    elif findings:
        words = ", ".join(findings[0].open_on)
        not_told = findings[0].because or f"not told: {words}"
        is_open = findings[0].outcome == "open"
        element(case, "skipped", message=lines[0] if is_open else not_told)
    return case
