"""Checks of large documents, in a thread, so that requests are answered meanwhile.

Until a check has ended, names are looked up in a view of the document: its text without the rules
that the cursor is not in. A view is read in a moment, however many rules there are.
"""

from __future__ import annotations

import re
from asyncio import AbstractEventLoop
from collections.abc import Callable
from dataclasses import dataclass, field, replace
from threading import Thread

from rulec.cancellation import CancelledError, while_wanted
from rulec.diagnostics import Diagnostic, RulecError
from rulec.language_server.workspace.editor_workspace import (
    CheckedDocument,
    Document,
    EditorWorkspace,
)
from rulec.rulebook.resolution_memory import ResolutionMemory
from rulec.syntax.keywords import CHANGE_WORDS, ITEM_WORDS, RULE_WORDS

LARGE = 50_000
"""Characters of a text that takes longer to check than a keystroke may."""

_ITEM = re.compile(rf"^[ \t]*({'|'.join(sorted(ITEM_WORDS))})\b", re.MULTILINE)
_RULES = {*RULE_WORDS, *CHANGE_WORDS, "rule"}


@dataclass(slots=True)
class BackgroundCheck:
    """A check in a thread; ``done`` is called in the loop with its result, unless cancelled."""

    document: Document
    editor: EditorWorkspace
    loop: AbstractEventLoop
    done: Callable[[Document, CheckedDocument | None, tuple[Diagnostic, ...]], object]
    _is_wanted: bool = field(default=True, init=False)

    def start(self) -> None:
        """Start the thread, which ends with the server."""
        Thread(target=self._check, daemon=True).start()

    def cancel(self) -> None:
        """Give the check up; its result is not wanted any more."""
        self._is_wanted = False

    def _check(self) -> None:
        # The thread has a copy: the document may be edited meanwhile.
        own = replace(self.document, memory=ResolutionMemory())
        checked, findings = None, ()
        try:
            with while_wanted(lambda: self._is_wanted):
                checked = self.editor.check(own)
                findings = checked.findings
        except RulecError as error:  # in the project's settings
            findings = error.diagnostics
        except CancelledError:
            return
        self.loop.call_soon_threadsafe(self._end, own, checked, findings)

    def _end(
        self, own: Document, checked: CheckedDocument | None, findings: tuple[Diagnostic, ...]
    ) -> None:
        if self._is_wanted:
            self.document.parsed, self.document.memory = own.parsed, own.memory
            self.document.checked = checked
            self.done(self.document, checked, findings)


def view_around(text: str, offset: int) -> str:
    """The text with blanks in place of all rules but the one at a character.

    Characters and lines of what is left are where they were.
    """
    starts = [*_ITEM.finditer(text)]
    ends = [*(match.start() for match in starts[1:]), len(text)]
    parts = [text[: starts[0].start()]] if starts else [text]
    for match, end in zip(starts, ends, strict=True):
        part = text[match.start() : end]
        if match[1] in _RULES and not match.start() <= offset <= end:
            lines = part.count("\n")
            part = " " * (len(part) - lines) + "\n" * lines
        parts.append(part)
    return "".join(parts)
