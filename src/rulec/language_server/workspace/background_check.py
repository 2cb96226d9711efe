"""Checks of large documents in a thread, so that requests are answered meanwhile.

Until one has ended, names are looked up in a view of the document: its text without the rules that
the cursor is not in, which is read in a moment, however many there are.
"""

from __future__ import annotations

import re
from asyncio import AbstractEventLoop
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from threading import Lock, Thread

from rulec.cancellation import CancelledError, is_wanted
from rulec.diagnostics import Diagnostic, RulecError
from rulec.language_server.workspace.editor_workspace import Document, EditorWorkspace
from rulec.rulebook.resolution_memory import ResolutionMemory
from rulec.syntax.keywords import CHANGE_WORDS, ITEM_WORDS, RULE_WORDS

LARGE = 50_000
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
        own = replace(self.document, memory=ResolutionMemory())
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
            known.parsed, known.memory, known.checked = own.parsed, own.memory, own.checked
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
