"""Diagnostics as SARIF 2.1.0, the exchange format of static analysis.

https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any
from urllib.parse import quote

from rulec.diagnostics import Diagnostic, SourceLocation
from rulec.diagnostics.code import Code
from rulec.report.findings.code_registry import all_codes, as_markdown, as_plain_text
from rulec.version import __version__

SCHEMA = (
    "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
)


def as_sarif(diagnostics: Sequence[Diagnostic], *, complete: bool = True) -> str:
    """One run of rulec; ``complete``: all inputs could be read."""
    codes = sorted({diagnostic.code for diagnostic in diagnostics})
    run = {
        "tool": {
            "driver": {
                "name": "rulec",
                "version": __version__,
                "rules": [_rule(all_codes()[code]) for code in codes],
            }
        },
        "columnKind": "unicodeCodePoints",
        "invocations": [{"executionSuccessful": complete}],
        "results": [
            _result(diagnostic, codes.index(diagnostic.code)) for diagnostic in diagnostics
        ],
    }
    document = {"$schema": SCHEMA, "version": "2.1.0", "runs": [run]}
    return json.dumps(document, ensure_ascii=False, indent=2)


def _rule(code: Code) -> dict[str, Any]:
    return {
        "id": code.code,
        "shortDescription": {"text": code.title},
        "fullDescription": {"text": code.why},
        "help": {"text": as_plain_text(code), "markdown": as_markdown(code)},
    }


def _result(diagnostic: Diagnostic, index: int) -> dict[str, Any]:
    sentences = [
        diagnostic.message,
        diagnostic.expected,
        diagnostic.help and f"help: {diagnostic.help}",
        *diagnostic.notes,
    ]
    result: dict[str, Any] = {
        "ruleId": diagnostic.code,
        "ruleIndex": index,
        "level": diagnostic.severity,
        "message": {"text": "\n".join(sentence for sentence in sentences if sentence)},
    }
    if diagnostic.place is not None:
        result["locations"] = [{"physicalLocation": _location(diagnostic.place)}]
    if diagnostic.labels:
        result["relatedLocations"] = [
            {
                "id": number,
                "physicalLocation": _location(label.place),
                "message": {"text": label.message},
            }
            for number, label in enumerate(diagnostic.labels)
        ]
    if diagnostic.fix is not None:
        place = _location(diagnostic.fix.place)
        mend = {"deletedRegion": place["region"], "insertedContent": {"text": diagnostic.fix.text}}
        changes = [{"artifactLocation": place["artifactLocation"], "replacements": [mend]}]
        result["fixes"] = [
            {"description": {"text": diagnostic.help}, "artifactChanges": changes},
        ]
    return result


def _location(place: SourceLocation) -> dict[str, Any]:
    location: dict[str, Any] = {"artifactLocation": {"uri": uri_of(place.file)}}
    if place.line is not None:
        region = {
            "startLine": place.line,
            "startColumn": place.column,
            "endLine": place.end_line,
            "endColumn": place.end_column,
        }
        location["region"] = {name: number for name, number in region.items() if number is not None}
    return location


def uri_of(file: str) -> str:
    """A file's URI; relative to the working directory if the path is."""
    path = Path(file)
    if path.is_absolute():
        return path.as_uri()
    return quote(path.as_posix().encode("utf-8", "surrogateescape"))
