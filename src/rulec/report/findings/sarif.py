"""Diagnostics and findings of verdicts as SARIF 2.1.0, the exchange format of static analysis.

https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from hashlib import sha256
from io import BytesIO
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any
from urllib.parse import quote

from rulec.diagnostics import Diagnostic, Fix, SourceLocation
from rulec.report.findings.code_registry import CodeExplanation, all_codes
from rulec.rulebook.rulebook_model import cited_law
from rulec.version import __version__

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRule
    from rulec.report.findings.verdict_finding import (
        FindingContext,
        RecordingFindings,
        VerdictFinding,
    )

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)
_LEVELS = {"hard": "error", "soft": "warning"}
_BESIDES = ("file", "rule", "because")
"""Fields of a finding that are told elsewhere in its result."""


class SarifRun:
    """One run of rulec, whose results are written as they come, a line for each."""

    def __init__(
        self,
        stream: IO[bytes],
        rules: Mapping[str, dict[str, Any]],
        version: str = __version__,
        **about: object,
    ) -> None:
        self._stream = stream
        self._numbers = {name: number for number, name in enumerate(rules)}
        self._any = False
        driver = {"name": "rulec", "version": version, **about, "rules": [*rules.values()]}
        head = json.dumps({"tool": {"driver": driver}, "columnKind": "unicodeCodePoints"})
        self._write(
            f'{{"$schema": {json.dumps(SCHEMA)}, "version": "2.1.0", "runs": [{head[:-1]}, '
            '"results": ['
        )

    def add(self, rule: str, result: Mapping[str, Any]) -> None:
        """Write what was found by a rule."""
        numbered = {"ruleId": rule, "ruleIndex": self._numbers[rule], **result}
        self._write(f"{',' if self._any else ''}\n{json.dumps(numbered)}")
        self._any = True

    def close(self, *, complete: bool, **notes: object) -> None:
        """Write the end of the document; ``complete``: all inputs could be read."""
        run = {"executionSuccessful": complete, **notes}
        self._write(f'\n], "invocations": [{json.dumps(run)}]}}]}}\n')

    def _write(self, text: str) -> None:
        self._stream.write(text.encode("ascii"))


def as_sarif(diagnostics: Sequence[Diagnostic], *, complete: bool = True) -> str:
    """The run that found diagnostics; its rules are their codes."""
    stream = BytesIO()
    codes = sorted({diagnostic.code for diagnostic in diagnostics})
    run = SarifRun(stream, {code: _code(all_codes()[code]) for code in codes})
    for diagnostic in diagnostics:
        run.add(diagnostic.code, _mistake(diagnostic))
    run.close(complete=complete)
    return stream.getvalue().decode().rstrip("\n")


class SarifWriter:
    """Results for what is violated or open, notifications for what is not judged.

    Results are written as they come; notifications are stored until the end.
    """

    def __init__(self, stream: IO[bytes], about: FindingContext) -> None:
        rules = {name: _rule(rule, about.rulebook.name) for name, rule in about.rules.items()}
        self._run = SarifRun(stream, rules, about.version, properties=about.edition)
        self._about = about
        self._notes: list[dict[str, Any]] = []
        self._complete = True

    def add(self, recording: RecordingFindings) -> None:
        """Write a result for each violation and each open verdict."""
        self._complete &= not recording.failure
        for finding in recording.findings:
            if finding.outcome == "not_judged":
                self._notes.append(_notification(finding))
            else:
                fails = finding.outcome == "violated" or self._about.is_failure(finding)
                self._run.add(finding.rule, _verdict(finding, fails=fails))

    def close(self) -> None:
        """Write the notifications and the end of the document."""
        self._run.close(complete=self._complete, toolExecutionNotifications=self._notes)


def _code(code: CodeExplanation) -> dict[str, Any]:
    return {
        "id": code.code,
        "shortDescription": {"text": code.title},
        "fullDescription": {"text": code.why},
        "help": {"text": code.as_plain_text(), "markdown": code.markdown},
    }


def _rule(rule: CompiledRule, rulebook: str) -> dict[str, Any]:
    text, law = rule.says or rule.name, cited_law(rule.cite, rule.inherited_from)
    return _without_empty(
        id=rule.name,
        shortDescription={"text": text},
        defaultConfiguration={"level": _LEVELS[rule.strength]},
        properties={"rulebook": rule.book or rulebook, "strength": rule.strength},
        fullDescription=law and {"text": f"{text} ({law})"},
    )


def _mistake(mistake: Diagnostic) -> dict[str, Any]:
    way_out = mistake.help and f"help: {mistake.help}"
    sentences = filter(None, (mistake.message, mistake.expected, way_out, *mistake.notes))
    return _without_empty(
        level=mistake.severity,
        message={"text": "\n".join(sentences)},
        locations=[_location(mistake.place)] if mistake.place else [],
        relatedLocations=[
            {"id": number, **_location(label.place), "message": {"text": label.message}}
            for number, label in enumerate(mistake.labels)
        ],
        fixes=[_fix(mistake.fix, mistake.help)] if mistake.fix else [],
    )


def _fix(fix: Fix, title: str) -> dict[str, Any]:
    place = _location(fix.place)["physicalLocation"]
    mend = {"deletedRegion": place["region"], "insertedContent": {"text": fix.text}}
    changes = [{"artifactLocation": place["artifactLocation"], "replacements": [mend]}]
    return {"description": {"text": title}, "artifactChanges": changes}


def _verdict(finding: VerdictFinding, *, fails: bool) -> dict[str, Any]:
    key = (finding.file, finding.recording, finding.rule, finding.vehicle, *finding.other)
    fingerprint = sha256("\0".join(key).encode("utf-8", "surrogatepass")).hexdigest()
    evidence = {name: value for name, value in finding.row().items() if name not in _BESIDES}
    return {
        "kind": "fail" if fails else "open",
        "level": _LEVELS[finding.strength] if fails else "none",
        "message": {"text": finding.says},
        "locations": [_moment(finding)],
        "partialFingerprints": {"rulec/v1": fingerprint},
        "properties": _without_empty(**evidence),
    }


def _notification(finding: VerdictFinding) -> dict[str, Any]:
    return _without_empty(
        level="note" if finding.rule or finding.vehicle else "error",
        message={"text": finding.says or "not judged"},
        locations=[_moment(finding)],
        associatedRule=finding.rule and {"id": finding.rule},
    )


def _location(place: SourceLocation) -> dict[str, Any]:
    region = _without_empty(
        startLine=place.line,
        startColumn=place.column,
        endLine=place.end_line,
        endColumn=place.end_column,
    )
    file = {"uri": _uri_of(place.file)}
    return {"physicalLocation": _without_empty(artifactLocation=file, region=region)}


def _moment(finding: VerdictFinding) -> dict[str, Any]:
    """The file, and of a drive in it the name and the times."""
    names = [name for name in (finding.recording, finding.vehicle) if name]
    # SARIF's regions are of text, pixels or bytes; of time there is none
    times = _without_empty(from_s=finding.from_s, to_s=finding.to_s, at_s=finding.at_s)
    return _without_empty(
        **_location(SourceLocation(finding.file)),
        properties=finding.from_s is not None and {"timeRegion": times},
        logicalLocations=names
        and [{"name": names[-1], "fullyQualifiedName": "/".join(names), "kind": "object"}],
    )


def _without_empty(**properties: object) -> dict[str, Any]:
    return {
        name: given for name, given in properties.items() if given or type(given) in (int, float)
    }


def _uri_of(file: str) -> str:
    """A file's URI; relative to the working directory if the path is."""
    path = Path(file)
    if path.is_absolute():
        return path.as_uri()
    return quote(path.as_posix().encode("utf-8", "surrogateescape"))
