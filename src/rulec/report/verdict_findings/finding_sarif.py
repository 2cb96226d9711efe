"""Findings of verdicts as SARIF 2.1.0.

https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html
"""

from __future__ import annotations

import json
from hashlib import sha256
from typing import IO, Any

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.monitoring.rulebook_edition import edition_of
from rulec.report.findings.sarif import SCHEMA, uri_of
from rulec.report.verdict_findings.verdict_finding import (
    COLUMNS,
    FindingContext,
    RecordingFindings,
    VerdictFinding,
)
from rulec.rulebook.rulebook_model import cited_law

_LEVELS = {"hard": "error", "soft": "warning"}


class SarifWriter:
    """One SARIF run: results for what is violated or open, notifications for what is not judged.

    Results are written as they come; notifications are stored until the end.
    """

    def __init__(self, stream: IO[bytes], about: FindingContext) -> None:
        self._stream = stream
        self._numbers = {name: number for number, name in enumerate(about.rules)}
        self._notes: list[dict[str, Any]] = []
        self._complete = True
        self._any = False
        driver = {
            "name": "rulec",
            "version": about.version,
            "properties": edition_of(about.rulebook)._asdict(),
            "rules": [_rule(rule, about.rulebook.name) for rule in about.rules.values()],
        }
        head = json.dumps({"tool": {"driver": driver}, "columnKind": "unicodeCodePoints"})
        self._write(
            f'{{"$schema": {json.dumps(SCHEMA)}, "version": "2.1.0", "runs": [{head[:-1]}, '
            '"results": ['
        )

    def add(self, recording: RecordingFindings) -> None:
        """Write a result for each violation and each open verdict."""
        self._complete &= not recording.failure
        for finding in recording.findings:
            if finding.outcome == "not_judged":
                self._notes.append(_notification(finding))
                continue
            result = _result(finding, self._numbers[finding.rule])
            self._write(f"{',' if self._any else ''}\n{json.dumps(result)}")
            self._any = True

    def close(self) -> None:
        """Write the notifications and the end of the document."""
        run = {"executionSuccessful": self._complete, "toolExecutionNotifications": self._notes}
        self._write(f'\n], "invocations": [{json.dumps(run)}]}}]}}\n')

    def _write(self, text: str) -> None:
        self._stream.write(text.encode("ascii"))


def _rule(rule: CompiledRule, rulebook: str) -> dict[str, Any]:
    text = rule.says or rule.name
    described: dict[str, Any] = {
        "id": rule.name,
        "shortDescription": {"text": text},
        "defaultConfiguration": {"level": _LEVELS[rule.strength]},
        "properties": {"rulebook": rule.book or rulebook, "strength": rule.strength},
    }
    if law := cited_law(rule.cite, rule.inherited_from):
        described["fullDescription"] = {"text": f"{text} ({law})"}
    return described


def _result(finding: VerdictFinding, number: int) -> dict[str, Any]:
    is_open = finding.outcome == "open"
    key = (finding.file, finding.recording, finding.rule, finding.vehicle, *finding.other)
    return {
        "ruleId": finding.rule,
        "ruleIndex": number,
        "kind": "open" if is_open else "fail",
        "level": "none" if is_open else _LEVELS[finding.strength],
        "message": {"text": finding.says},
        "locations": [_location(finding)],
        "partialFingerprints": {"rulec/v1": sha256("\0".join(key).encode(*_BYTES)).hexdigest()},
        "properties": {
            name: getattr(finding, name)
            for name in _PROPERTIES
            if getattr(finding, name) not in (None, "", ())
        },
    }


_PROPERTIES = tuple(name for name in COLUMNS if name not in ("file", "rule", "because"))
_BYTES = ("utf-8", "surrogatepass")


def _location(finding: VerdictFinding) -> dict[str, Any]:
    location: dict[str, Any] = {
        "physicalLocation": {"artifactLocation": {"uri": uri_of(finding.file)}}
    }
    if finding.from_s is not None:
        # SARIF's regions are of text, pixels or bytes; of time there is none
        times = {"from_s": finding.from_s, "to_s": finding.to_s, "at_s": finding.at_s}
        location["properties"] = {
            "timeRegion": {name: time for name, time in times.items() if time is not None}
        }
    names = [name for name in (finding.recording, finding.vehicle) if name]
    if names:
        location["logicalLocations"] = [
            {"name": names[-1], "fullyQualifiedName": "/".join(names), "kind": "object"}
        ]
    return location


def _notification(finding: VerdictFinding) -> dict[str, Any]:
    note: dict[str, Any] = {
        "level": "note" if finding.rule or finding.vehicle else "error",
        "message": {"text": finding.says or "not judged"},
        "locations": [_location(finding)],
    }
    if finding.rule:
        note["associatedRule"] = {"id": finding.rule}
    return note
