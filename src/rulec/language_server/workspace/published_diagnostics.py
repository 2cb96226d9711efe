"""Findings of a check as an editor's diagnostics.

Large documents are checked in a thread, so that requests are answered meanwhile. Until one has
ended, names are looked up in a view of the document: its text without the rules that the cursor is
not in, which is read in a moment, however many there are.
"""

from __future__ import annotations

import os
import re
from asyncio import AbstractEventLoop
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass, field, replace
from threading import Lock, Thread

from lsprotocol import types as lsp

from rulec.cancellation import CancelledError, is_wanted
from rulec.diagnostics import Diagnostic, RulecError, SourceLocation
from rulec.language_server.workspace.editor_workspace import Document, EditorWorkspace, uri_of
from rulec.syntax.keywords import CHANGE_WORDS, ITEM_WORDS, RULE_WORDS

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


LARGE = 20_000
"""Characters of a text that takes longer to check than a keystroke may."""

# Items begin on lines of their own; a match begins with the end of the line before.
_ITEM, _OTHER_ITEM = (
    re.compile(rf"\n[ \t]*(?:{'|'.join(sorted(words))})\b")
    for words in (ITEM_WORDS, ITEM_WORDS.difference(RULE_WORDS, CHANGE_WORDS, ["rule"]))
)


@dataclass(slots=True)
class BackgroundCheck:
    """A check in a thread, and what is called in the loop with its findings."""

    document: Document
    editor: EditorWorkspace
    loop: AbstractEventLoop
    done: Callable[[Document, tuple[Diagnostic, ...]], object]
    is_cancelled: bool = False
    pause: Lock = field(default_factory=Lock)
    """While it is held, the check waits between two of its steps."""

    def start(self) -> None:
        """Start the thread, which ends with the server."""
        Thread(target=self._check, daemon=True).start()

    def _goes_on(self) -> bool:
        with self.pause:
            return not self.is_cancelled

    def _check(self) -> None:
        is_wanted.set(self._goes_on)
        # A copy, since the document may be edited meanwhile.
        own = replace(self.document)
        try:
            own.checked = self.editor.check(own)
            findings = own.checked.findings
        except RulecError as error:  # in the project's settings
            findings = error.diagnostics
        except CancelledError:
            return
        self.loop.call_soon_threadsafe(self._end, own, findings)

    def _end(self, own: Document, findings: tuple[Diagnostic, ...]) -> None:
        if not self.is_cancelled:
            known = self.document
            known.checked = own.checked
            self.done(known, findings)


def view_around(text: str, offset: int) -> str:
    """The text with blanks for all rules but the one at a character; all else is where it was."""
    start = text.rfind("\n", 0, offset)
    while start > 0 and not _ITEM.match(text, start):
        start = text.rfind("\n", 0, start)
    parts: list[str] = []
    end = 0
    for begin in sorted(
        {0, max(start, 0), *(match.start() for match in _OTHER_ITEM.finditer(text))}
    ):
        if begin >= end:
            following = _ITEM.search(text, begin + 1)
            parts += [" " * (begin - end), text[begin : following.start() if following else None]]
            end = begin + len(parts[-1])
    return "".join([*parts, " " * (len(text) - end)])
