"""Suites of examples and of verdicts as JUnit XML, for continuous integration."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import IO, TYPE_CHECKING, Any, Literal
from xml.etree import ElementTree

if TYPE_CHECKING:
    from rulec.report.findings.verdict_finding import (
        FindingContext,
        RecordingFindings,
        VerdictFinding,
    )

_NOT_XML = re.compile("[^\t\n\x20-\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]")
"""Characters that XML 1.0 does not allow, not even escaped (section 2.2)."""


TAIL = "</testsuites>"
"""The end of a document."""


@dataclass(frozen=True, slots=True, kw_only=True)
class JUnitCase:
    """An example, or a rule that a drive is judged by.

    It passes unless ``result`` says otherwise: of a ``kind``, with a ``message`` and a ``text``.
    """

    group: str
    name: str
    file: str | None = None
    line: int | None = None
    result: Literal["failure", "error", "skipped", "system-out", ""] = ""
    kind: str | None = None
    message: str | None = None
    text: str = ""


@dataclass(frozen=True, slots=True, kw_only=True)
class JUnitSuite:
    """The cases of a rulebook or a recording, the coverage of examples (%), and more output."""

    name: str
    cases: Sequence[JUnitCase]
    coverage: float | None = None
    output: str | None = None


def counts_of(suites: Iterable[JUnitSuite]) -> dict[str, int]:
    """The numbers of cases, altogether and by their results."""
    results = [case.result for suite in suites for case in suite.cases]
    return {
        "tests": len(results),
        "failures": results.count("failure"),
        "errors": results.count("error"),
        "skipped": results.count("skipped"),
    }


def head(**about: object) -> str:
    """The beginning of a document; ``about`` are attributes of all its suites."""
    root = ElementTree.tostring(_element(None, "testsuites", name="rulec", **about), "unicode")
    return f'<?xml version="1.0" encoding="UTF-8"?>\n{root.removesuffix(" />")}>\n'


def suite_text(suite: JUnitSuite) -> str:
    """A suite with its cases."""
    root = _element(None, "testsuite", name=suite.name, **counts_of([suite]))
    if suite.coverage is not None:
        part = f"{suite.coverage:.3f}"
        _element(_element(root, "properties"), "property", name="coverage", value=part)
    for case in suite.cases:
        about = {"classname": case.group, "name": case.name, "file": case.file, "line": case.line}
        element = _element(root, "testcase", **about)
        if case.result:
            result = _element(element, case.result, type=case.kind, message=case.message)
            result.text = _xml_text(case.text)
    if suite.output is not None:
        _element(root, "system-out").text = _xml_text(suite.output)
    ElementTree.indent(root, level=1)
    return f"  {ElementTree.tostring(root, encoding='unicode')}\n"


class JUnitWriter:
    """A suite for each recording, with a case for each rule and each drive that was judged.

    A case fails if a hard rule is violated, or open where that counts as violated, like the exit
    status; a violated soft rule is its output. It is skipped, with the reason, if the rule is open
    or not judged for the drive: a case passes only if the rule is known to be kept. A rule that was
    judged for no drive has one case.
    """

    def __init__(self, stream: IO[bytes], about: FindingContext) -> None:
        self._stream = stream
        self._about = about
        stream.write(head().encode())

    def add(self, recording: RecordingFindings) -> None:
        """Write the suite of a recording."""
        book, by_rule = self._about.rulebook.name, recording.by_rule
        lost = [f"{x.vehicle}: not judged: {x.because}" for x in by_rule.get("", ())]
        cases = [
            case for rule in self._about.rules for case in self._cases(rule, by_rule, recording)
        ]
        if recording.failure:
            about: dict[str, Any] = {"kind": "not judged", "message": recording.failure}
            file, lost = recording.file, []
            cases = [JUnitCase(group=book, name="reading", file=file, result="error", **about)]
        output = "\n".join(lost) if lost else None
        suite = JUnitSuite(name=recording.title, cases=cases, output=output)
        self._stream.write(suite_text(suite).encode())

    def close(self) -> None:
        """Write the end of the document."""
        self._stream.write(f"{TAIL}\n".encode())

    def _cases(
        self, rule: str, by_rule: Mapping[str, Sequence[VerdictFinding]], of: RecordingFindings
    ) -> Iterator[JUnitCase]:
        """The cases of a rule: one if it was judged for no drive, else one a drive."""
        book = self._about.rulebook.name
        by_drive: dict[str, list[VerdictFinding]] = {}
        for finding in by_rule.get(rule, ()):
            by_drive.setdefault(finding.vehicle, []).append(finding)
        if nowhere := by_drive.get(""):
            yield JUnitCase(group=book, name=rule, file=of.file, **self._result(nowhere))
            return
        for drive in of.drives:
            result = self._result(by_drive.get(drive, []))
            yield JUnitCase(group=f"{book}.{rule}", name=drive, file=of.file, **result)

    def _result(self, findings: Sequence[VerdictFinding]) -> dict[str, Any]:
        """The result of a case with these findings of a rule in a drive."""
        if not findings:
            return {}
        first, text = findings[0], "\n".join(finding.says for finding in findings)
        if any(map(self._about.is_failure, findings)):
            return {"result": "failure", "kind": "hard rule", "message": first.says, "text": text}
        if any(finding.outcome == "violated" for finding in findings):
            return {"result": "system-out", "text": text}
        why = first.because or f"not told: {', '.join(first.open_on)}"
        return {"result": "skipped", "message": first.says if first.outcome == "open" else why}


def _element(
    parent: ElementTree.Element | None, tag: str, **attributes: object
) -> ElementTree.Element:
    """A new element, within another one unless None; attributes that are None are omitted."""
    given = {name: _xml_text(str(value)) for name, value in attributes.items() if value is not None}
    if parent is None:
        return ElementTree.Element(tag, given)
    return ElementTree.SubElement(parent, tag, given)


def _xml_text(text: str) -> str:
    """A text allowed in XML; other characters are replaced by their codes."""
    return _NOT_XML.sub(lambda match: f"\\u{ord(match[0]):04x}", text)
