"""Findings of a check as an editor's diagnostics."""

from __future__ import annotations

import os
from collections.abc import Iterable, Mapping

from lsprotocol import types as lsp

from rulec.diagnostics import Diagnostic, SourceLocation
from rulec.language_server.workspace.editor_workspace import EditorWorkspace, uri_of

SOURCE = "rulec"


def by_file(findings: Iterable[Diagnostic], document: str) -> dict[str, list[Diagnostic]]:
    """Findings by the addresses of their files; those without a file belong to ``document``."""
    by_uri: dict[str, list[Diagnostic]] = {}
    for finding in findings:
        file = uri_of(finding.place.file) if finding.place is not None else document
        by_uri.setdefault(file, []).append(finding)
    return by_uri


def distinct(findings: Iterable[Diagnostic]) -> list[Diagnostic]:
    """Findings without duplicates, which the checks of several documents can produce."""
    first: dict[tuple[object, ...], Diagnostic] = {}
    for finding in findings:
        place = finding.place
        where = () if place is None else (os.path.realpath(place.file), place.start)
        end = None if place is None else place.end_column
        first.setdefault((finding.code, finding.message, where, end), finding)
    return list(first.values())


def diagnostics_of(
    findings: Iterable[Diagnostic], text: str, workspace: EditorWorkspace
) -> list[lsp.Diagnostic]:
    """Findings in one text, as diagnostics of the protocol."""
    positions = workspace.positions(text)
    texts: dict[str, str] = {}
    return [
        lsp.Diagnostic(
            range=positions.place(finding.place or SourceLocation("", 1, 1)),
            message=in_words(finding),
            severity=lsp.DiagnosticSeverity.Error
            if finding.severity == "error"
            else lsp.DiagnosticSeverity.Warning,
            code=finding.code,
            source=SOURCE,
            related_information=[
                lsp.DiagnosticRelatedInformation(
                    lsp.Location(
                        uri_of(label.place.file), _range(label.place, text, texts, workspace)
                    ),
                    label.message,
                )
                for label in finding.labels
            ]
            or None,
        )
        for finding in findings
    ]


def _range(
    place: SourceLocation, own: str, texts: dict[str, str], workspace: EditorWorkspace
) -> lsp.Range:
    """The range of a place that may be in another file."""
    if place.file not in texts:
        document = workspace.document(uri_of(place.file))
        texts[place.file] = own if document is None else document.text
    return workspace.positions(texts[place.file]).place(place)


def in_words(finding: Diagnostic) -> str:
    """A finding's message, what was expected, the help and further notes, line by line."""
    message = finding.message + (f" ({finding.expected})" if finding.expected else "")
    way_out = [f"help: {finding.help}"] if finding.help else []
    return "\n".join([message, *way_out, *(f"note: {note}" for note in finding.notes)])


def union(by_document: Mapping[str, Mapping[str, list[Diagnostic]]], file: str) -> list[Diagnostic]:
    """The findings in a file from the checks of all documents; those of its own check first."""
    own = by_document.get(file, {}).get(file, [])
    others = [
        finding
        for document, files in by_document.items()
        if document != file
        for finding in files.get(file, [])
    ]
    return distinct([*own, *others])
