"""Names that are not in the text, and other names for all uses of one."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from itertools import count
from typing import TypeAlias

from rulec.language_server.names.renaming import TextChange

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
