"""Edits that do what a message's help says; each is tried before it is offered."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

from lsprotocol import types as lsp

from rulec.diagnostics import Diagnostic, RulecError, SourceLocation, nearest_name
from rulec.language_server.names.renaming import TextChange, changed_text
from rulec.language_server.workspace.editor_workspace import (
    CheckedDocument,
    Document,
    EditorWorkspace,
)
from rulec.language_server.workspace.published_diagnostics import diagnostics_of
from rulec.language_server.workspace.text_positions import TextPositions
from rulec.language_server.writing.described_edits import (
    Edit,
    another_name,
    declares_in_formula,
    described_edits,
)
from rulec.rulebook.files.reference_messages import (
    EXTENDS_CIRCLE,
    NAME_NOT_FOUND,
    WRONG_KIND_OF_FILE,
)
from rulec.syntax.keywords import DECLARATION_WORDS
from rulec.syntax.messages.mismatch import UNEXPECTED_WORD, UNTERMINATED_TEXT
from rulec.syntax.messages.structure import NOT_A_RULEBOOK, OUTSIDE_BRACES, UNBALANCED_BRACE

_WORD = re.compile(r"[^\W\d]\w*")
_QUOTED = re.compile(r"`([^`…]+)`")
_MOST_TRIED = 12
"""The greatest number of edits tried for one message: each is checked as if it had been typed."""

_SEVERAL = re.compile(r", | or |such as")
"""If several things are possible, none of them is offered."""

_LISTED = re.compile(r"`(?: \([^)]*\))?, `")
"""What is listed is what there is, not what is meant."""

_NOT_MEANT = re.compile(
    r"check the unit|^end the older one|^a share is a factor|^say what must hold"
    r"|^the most general of them"
)
"""Help in which quoted words are about what is there, or stand for more than the place."""

_EITHER = "Say `traffic "
"""Edits with this start are offered beside another valid one, since only the author can choose."""

_ONLY_THE_AUTHOR_KNOWS = re.compile(
    r"the one you mean|words that may mean it|`, or\b"
    r"|the nearest multiples|say it in this state|`override rule \w+` to change it"
    r"|(?:give it|choose) another name"
)

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

_RULE_HEAD = re.compile(r"(?:hard|soft)\s+rule\s+$")
_DELETING = ("delete", "leave", "keep one")


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
        title = f"Write `{_short(change.text)}`" if change.text else f"Leave out {_named(was)}"
        yield QuickFix(title, finding, (change,))
        return
    is_mended = False
    either = _ONLY_THE_AUTHOR_KNOWS.search(f"{finding.help} {finding.message}")
    for title, changes in list(_candidates(finding, place, positions, trial))[:_MOST_TRIED]:
        if is_mended and not (either or title.startswith(_EITHER)):
            continue
        if trial.mends(changes, finding):
            yield QuickFix(title, finding, changes)
            is_mended = True


def _bounds(place: SourceLocation, positions: TextPositions) -> tuple[int, int]:
    start = positions.offset_of(place.line, place.column)
    end = positions.offset_of(place.end_line or place.line, place.end_column or place.column)
    return start, max(start, end)


def _named(text: str) -> str:
    if text.isprintable():
        return "the comment" if text.lstrip().startswith("#") else f"`{_short(text)}`"
    return ", ".join(f"U+{ord(sign):04X}" for sign in text)


def _short(text: str) -> str:
    line = " ".join(text.split())
    return line if len(line) <= 50 else f"{line[:49]}…"


def _candidates(
    finding: Diagnostic, place: SourceLocation, positions: TextPositions, trial: _Trial
) -> Iterator[Edit]:
    """Edits that the help may mean, the most likely first."""
    text, (start, end) = positions.text, _bounds(place, positions)
    path = trial.document.path
    stem = "" if path is None else path.stem
    if declares_in_formula(text, start):
        return
    yield from described_edits(finding, text, start, end, stem)
    for title, change in _quoted_edits(finding, text, start, end):
        yield title, (change,)
    yield from another_name(finding, text, start, end)


def _quoted_edits(
    finding: Diagnostic, text: str, start: int, end: int
) -> Iterator[tuple[str, TextChange]]:
    """Edits that use the words quoted in the help."""
    words = list(_meant_words(finding, text[start:end]))
    if finding.help.startswith(_DELETING):
        yield from _deletions(text, start, end)
    if finding.help.startswith("did you mean") and words:
        yield from _misspelt(words[0], text, start)
    place = start, end
    for word in dict.fromkeys(words):
        if word == text[start:end]:
            continue
        start, end = _with_own_words(word, text, *place)
        first_word, _, rest = word.partition(" ")
        if first_word in ("use", "traffic") and rest:
            head = text.find("\n") + 1 or len(text)
            title = f"Use `{rest}`" if first_word == "use" else f"Say `{word}`"
            yield title, TextChange(head, head, f"{word}\n")
            continue
        if first_word == "override":
            line = text.rfind("\n", 0, start) + 1
            if written := _RULE_HEAD.search(text, line, start):
                yield f"Write `{word}`", TextChange(*written.span(), "override rule ")
            continue
        if first_word in DECLARATION_WORDS and rest:
            line = _line_of_item(text, start)
            yield f"Declare `{_short(word)}`", TextChange(line, line, f"{word}\n")
            continue
        if word == "}":
            first = text.rfind("\n", 0, start) + 1
            blank = not text[first:start].strip()
            put = f"{word}\n" if blank and first else f"\n{word}\n"
            yield f"Put `{word}` here", TextChange(*((first, first) if blank else (end, end)), put)
        yield f"Write `{_short(word)}`", TextChange(start, end, word)
        if start == end or finding.expected.startswith("expected"):
            yield f"Put `{_short(word)}` before it", TextChange(start, start, f"{word} ")
            yield f"Put `{_short(word)}` behind it", TextChange(end, end, f" {word}")
    if "leave" in finding.help or "delete" in finding.help:
        yield from _deletions(text, start, end)


def _meant_words(finding: Diagnostic, own: str) -> Iterator[str]:
    """The words quoted in a message that may be meant in place of ``own`` words."""
    help_text, expected = finding.help, finding.expected
    if "`unverified`" in expected:
        yield "unverified"  # more has to be found out, not only written
        return
    if _NOT_MEANT.search(help_text):
        return
    is_question = help_text.startswith(("did you mean", "words that may mean it"))
    if is_question or not _LISTED.search(help_text):
        for word in _QUOTED.findall(help_text):
            if not _is_example(word, help_text, own) and word != "_":
                yield word
    if not _SEVERAL.search(expected):
        yield from _QUOTED.findall(expected)


def _with_own_words(word: str, text: str, start: int, end: int) -> tuple[int, int]:
    """A place with the words behind it that a replacement repeats."""
    own = text[start:end]
    behind = word.rpartition(own)[2] if own and own in word else ""
    is_repeated = behind.startswith(" ") and text.startswith(behind, end)
    return (start, end + len(behind)) if is_repeated else (start, end)


def _is_example(word: str, help_text: str, own: str) -> bool:
    """Whether the words in a help text are only an example of a form, not the replacement."""
    behind = f"such as `{word}`" in help_text
    return behind and own not in word and word.partition(" ")[0] not in DECLARATION_WORDS


def _misspelt(word: str, text: str, start: int) -> Iterator[tuple[str, TextChange]]:
    """The word on the line, before the place, that is most similar to the intended word."""
    line = text.rfind("\n", 0, start) + 1
    words = {match[0]: match.span() for match in _WORD.finditer(text, line, start)}
    near = nearest_name(word, words)
    if near is not None and near != word:
        yield f"Write `{word}`", TextChange(*words[near], word)


def _deletions(text: str, start: int, end: int) -> Iterator[tuple[str, TextChange]]:
    if text.startswith("#", start):
        line = text.find("\n", start)
        yield "Leave out the comment", TextChange(start, len(text) if line < 0 else line, "")
    behind = re.compile(r"\s*,\s*").match(text, end)
    before = re.search(r"\s*,\s*$", text[:start])
    shown = _short(text[start:end])
    if before:
        yield f"Leave out `{shown}`", TextChange(before.start(), end, "")
    elif behind:
        yield f"Leave out `{shown}`", TextChange(start, behind.end(), "")
    yield f"Leave out `{shown}`", TextChange(start, end, "")
    first = text.rfind("\n", 0, start) + 1
    last = text.find("\n", end) + 1 or len(text)
    yield f"Leave out the line of `{shown}`", TextChange(first, last, "")


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

    def mends(self, changes: Sequence[TextChange], finding: Diagnostic) -> bool:
        """Whether changes leave fewer problems, and none that is worse.

        A mistake that hid others counts as fixed if it is gone and the text can then be parsed.
        """
        text = changed_text(self.document.text, changes)
        tried = Document(self.document.uri, text, parsed=self.document.parsed)
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
    positions = editor.positions(text)
    edits = [
        lsp.TextEdit(positions.range(change.start, change.end), change.text)
        for change in fix.changes
    ]
    return lsp.CodeAction(
        fix.title,
        kind=lsp.CodeActionKind.QuickFix,
        diagnostics=diagnostics_of([fix.finding], text, editor),
        edit=lsp.WorkspaceEdit(changes={uri: edits}),
    )
