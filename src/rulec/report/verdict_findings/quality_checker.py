"""Findings of verdicts as results of ASAM's Quality Checker Framework (``.xqar``).

https://github.com/asam-ev/qc-framework, version 1 of the result format.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from datetime import date
from typing import IO
from xml.etree import ElementTree

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.report.text.xml_text import HEAD, element, written
from rulec.report.verdict_findings.verdict_finding import (
    FindingContext,
    RecordingFindings,
    VerdictFinding,
)
from rulec.rulebook.rulebook_model import cited_law

_LEVELS = {"hard": 1, "soft": 2}
_INFORMATION = 3

_ENTITY = "rulec.rulebooks"
_STANDARD = "law"


class QualityCheckerWriter:
    """A bundle for each recording, with a checker for each rule and its issues.

    Violations of hard rules are errors, those of soft rules warnings, open verdicts information.
    """

    def __init__(self, stream: IO[bytes], about: FindingContext) -> None:
        self._stream = stream
        self._about = about
        self._issues = 0
        stream.write(f'{HEAD}<CheckerResults version="1.0.0">\n'.encode())

    def add(self, recording: RecordingFindings) -> None:
        """Write the bundle of a recording."""
        by_rule = recording.by_rule
        rulebook = self._about.rulebook
        issues = sum(finding.outcome != "not_judged" for finding in recording.findings)
        bundle = element(
            None,
            "CheckerBundle",
            build_date=date.today().isoformat(),  # noqa: DTZ011 - the day where this runs
            description=rulebook.title or rulebook.name,
            name=f"rulec {rulebook.name}",
            version=self._about.version,
            summary=recording.failure or f"{issues:,} issues in {recording.drives:,} drives",
        )
        element(bundle, "Param", name="InputFile", value=recording.file)
        if recording.recording:
            element(bundle, "Param", name="Recording", value=recording.recording)
        for rule in self._about.rules.values():
            self._checker(bundle, rule, by_rule.get(rule.name, []), recording.failure)
        self._stream.write(written(bundle, 1))

    def close(self) -> None:
        """Write the end of the document."""
        self._stream.write(b"</CheckerResults>\n")

    def _checker(
        self,
        bundle: ElementTree.Element,
        rule: CompiledRule,
        findings: Iterable[VerdictFinding],
        failure: str,
    ) -> None:
        issues = [item for item in findings if item.outcome != "not_judged"]
        left_out = next((item for item in findings if item.outcome == "not_judged"), None)
        skipped = left_out is not None and not left_out.vehicle and not issues
        law = cited_law(rule.cite, rule.inherited_from)
        checker = element(
            bundle,
            "Checker",
            checkerId=rule.name,
            description=f"{rule.says or rule.name} [{law}]" if law else rule.says,
            summary=left_out.says if skipped and left_out else failure or f"{len(issues)} issues",
            status="error" if failure else "skipped" if skipped else "completed",
        )
        uid = self._uid(rule)
        for finding in issues:
            is_open = finding.outcome == "open"
            issue = element(
                checker,
                "Issue",
                issueId=self._issues,
                description=finding.says,
                level=_INFORMATION if is_open else _LEVELS[rule.strength],
                ruleUID=uid,
            )
            self._issues += 1
            _locations(issue, finding)
        element(checker, "AddressedRule", ruleUID=uid)

    def _uid(self, rule: CompiledRule) -> str:
        """The rule's UID in the framework's form, with the day of the law as its version.

        See doc/manual/rule_uid_schema.md there: entity, standard, numbers with points, and a name.
        """
        rulebook = self._about.rulebook
        day = (rulebook.at or rulebook.as_of).replace("-", ".")
        version = day if re.fullmatch(r"[0-9]+(\.[0-9]+)+", day) else "0.0"
        names = (re.sub(r"\W", "_", name) for name in (rulebook.name, rule.name))
        full = ".".join(name if name[:1].isalpha() else f"r{name}" for name in names)
        return f"{_ENTITY}:{_STANDARD}:{version}:{full}"


def _locations(issue: ElementTree.Element, finding: VerdictFinding) -> None:
    """Add when the finding is decided, and where the vehicle is then."""
    at_s = finding.from_s if finding.at_s is None else finding.at_s
    if at_s is None:
        return
    locations = element(issue, "Locations", description=f"{finding.vehicle} at {at_s:g} s")
    element(locations, "TimeLocation", time=at_s)
    if finding.x is not None and finding.y is not None:
        element(locations, "InertialLocation", x=finding.x, y=finding.y, z=0.0)
