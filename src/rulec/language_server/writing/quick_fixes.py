"""Edits that do what a message's help says; each is tried before it is offered."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import count
from typing import TypeAlias

from lsprotocol import types as lsp

from rulec.diagnostics import Diagnostic, Fix, RulecError, SourceLocation
from rulec.diagnostics.ways_out import leaving_out, short
from rulec.language_server.names.renaming import TextChange, changed_text, text_edits
from rulec.language_server.workspace.editor_workspace import (
    CheckedDocument,
    Document,
    EditorWorkspace,
)
from rulec.language_server.workspace.published_diagnostics import diagnostics_of
from rulec.language_server.workspace.text_positions import TextPositions
from rulec.rulebook.files.reference_messages import (
    EXTENDS_CIRCLE,
    NAME_NOT_FOUND,
    WRONG_KIND_OF_FILE,
)
from rulec.syntax.messages.lookalikes import CONFUSABLE_NAME
from rulec.syntax.messages.mismatch import UNEXPECTED_WORD, UNTERMINATED_TEXT
from rulec.syntax.messages.structure import NOT_A_RULEBOOK, OUTSIDE_BRACES, UNBALANCED_BRACE

_MOST_TRIED = 12
"""The greatest number of edits tried for one message: each is checked as if it had been typed."""

_HIDING = frozenset(
    code.code for code in (NOT_A_RULEBOOK, WRONG_KIND_OF_FILE, EXTENDS_CIRCLE, NAME_NOT_FOUND)
)
"""Mistakes that keep others from being looked for."""

_UNREADABLE = frozenset(
    code.code
    for code in (
        *(UNEXPECTED_WORD, UNTERMINATED_TEXT),
        *(UNBALANCED_BRACE, OUTSIDE_BRACES, NOT_A_RULEBOOK),
    )
)


@dataclass(frozen=True, slots=True)
class QuickFix:
    """An edit that fixes the problem of a diagnostic."""

    title: str
    finding: Diagnostic
    changes: tuple[TextChange, ...]


def quick_fixes(
    checked: CheckedDocument,
    document: Document,
    where: lsp.Range,
    editor: EditorWorkspace,
) -> list[QuickFix]:
    """The edits for the findings in a range of a document."""
    positions = editor.positions(checked.text)
    fixes: list[QuickFix] = []
    trial = _Trial(document, editor, len(_errors(checked.findings)), len(checked.findings))
    for finding in checked.findings:
        place = finding.place
        if place is None or place.file != checked.name:
            continue
        shown = positions.place(place)
        if shown.end < where.start or where.end < shown.start:
            continue
        fixes += _for(finding, place, positions, trial)
    return fixes


def _for(
    finding: Diagnostic, place: SourceLocation, positions: TextPositions, trial: _Trial
) -> Iterator[QuickFix]:
    if finding.fix is not None and finding.fix.place.file == place.file:
        change = TextChange(*_bounds(finding.fix.place, positions), finding.fix.text)
        was = positions.text[change.start : change.end]
        title = f"Write `{short(change.text)}`" if change.text else leaving_out(was)
        yield QuickFix(title, finding, (change,))
        return
    offered = set[str]()
    for title, changes in _edits(finding, positions)[:_MOST_TRIED]:
        after = changed_text(positions.text, changes)
        if after not in offered and trial.mends(after, finding):
            yield QuickFix(title, finding, changes)
            offered.add(after)


def _bounds(place: SourceLocation, positions: TextPositions) -> tuple[int, int]:
    start = positions.offset_of(place.line, place.column)
    end = positions.offset_of(place.end_line or place.line, place.end_column or place.column)
    return start, max(start, end)


def _edits(finding: Diagnostic, positions: TextPositions) -> list[Edit]:
    """The edits that a message offers, the most likely first."""
    edits = [(one.title, _changes(one.fixes, positions)) for one in finding.offers]
    if finding.code == CONFUSABLE_NAME.code:
        return [*everywhere(edits, positions.text)]
    return [with_free_name(edit, positions.text) for edit in edits]


def _changes(fixes: Sequence[Fix], positions: TextPositions) -> tuple[TextChange, ...]:
    return tuple(TextChange(*_replaced(fix.place, positions), fix.text) for fix in fixes)


def _replaced(place: SourceLocation, positions: TextPositions) -> tuple[int, int]:
    """What an offered edit replaces: nothing, if it is a new line."""
    if place.column is not None:
        return _bounds(place, positions)
    text = positions.text
    above = text.find("\n") + 1 or len(text)
    if place.line is not None:
        above = _line_of_item(text, positions.offset_of(place.line, 1))
    return above, above


def _line_of_item(text: str, offset: int) -> int:
    """The beginning of the item at a character, including the comments above it."""
    start = text.rfind("\n", 0, offset) + 1
    while start > 0 and (text[start] in " \t}" or text[start] == "\n"):
        start = text.rfind("\n", 0, start - 1) + 1
    while start > 0:
        above = text.rfind("\n", 0, start - 1) + 1
        if not text.startswith("#", above):
            break
        start = above
    return start


@dataclass(frozen=True, slots=True)
class _Trial:
    """A document in which edits are tried, with the number of its errors and findings now."""

    document: Document
    editor: EditorWorkspace
    errors: int
    findings: int

    def mends(self, text: str, finding: Diagnostic) -> bool:
        """Whether a changed text has fewer problems, and none that is worse.

        A mistake that hid others counts as fixed if it is gone and the text can then be parsed.
        """
        tried = Document(self.document.uri, text)
        try:
            diagnostics = self.editor.check(tried).findings
        except RulecError:
            return False
        if finding.code in _HIDING:
            is_gone = all(diagnostic.code != finding.code for diagnostic in diagnostics)
            return is_gone and not any(diagnostic.code in _UNREADABLE for diagnostic in diagnostics)
        errors = len(_errors(diagnostics))
        return errors < self.errors or (errors == self.errors and len(diagnostics) < self.findings)


def _errors(findings: Sequence[Diagnostic]) -> list[Diagnostic]:
    return [diagnostic for diagnostic in findings if diagnostic.severity == "error"]


def code_action(fix: QuickFix, uri: str, text: str, editor: EditorWorkspace) -> lsp.CodeAction:
    """A quick fix as a code action of the protocol."""
    edits = text_edits(fix.changes, text, editor)
    return lsp.CodeAction(
        fix.title,
        kind=lsp.CodeActionKind.QuickFix,
        diagnostics=diagnostics_of([fix.finding], text, editor),
        edit=lsp.WorkspaceEdit(changes={uri: edits}),
    )


Edit: TypeAlias = tuple[str, tuple[TextChange, ...]]
"""The edit's title in the editor, and its changes."""


def with_free_name(edit: Edit, text: str) -> Edit:
    """An offered edit, which without a title gives a name of its own to what it changes."""
    title, changes = edit
    if title:
        return edit
    (change,) = changes
    name = _free(change.text, text)
    return f"Call it `{name}`", (TextChange(change.start, change.end, name),)


def everywhere(edits: Sequence[Edit], text: str) -> Iterator[Edit]:
    """Edits that each write a name at one of its uses, made at all of its uses.

    It is then spelt like a similar one; or, where both are meant, with a name of its own.
    """
    for _, (change,) in edits:
        was = rf"\b{re.escape(text[change.start : change.end])}\b"
        uses = [match.span() for match in re.finditer(was, text)]
        for name in (change.text, _free(change.text, text)):
            yield f"Write `{name}`", tuple(TextChange(*use, name) for use in uses)


def _free(name: str, text: str) -> str:
    """A variant of a name that does not occur in a text."""
    return next(
        f"{name}_{number}" for number in count(2) if not re.search(rf"\b{name}_{number}\b", text)
    )
