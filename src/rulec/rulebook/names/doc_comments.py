"""Doc comments: the description that an author wrote beside a declaration."""

from __future__ import annotations

from rulec.diagnostics import Span


def description(span: Span) -> str:
    """The description of an item: the comment after it, else the comments above.

    If there is one after the item, those above may be about several items. A comment followed by a
    blank line is about more than the next item. Empty if there is none.
    """
    source = span.source
    last, column = source.position(span.end)
    _, sign, behind = source.line(last)[column - 1 :].partition("#")
    if sign:
        return behind.strip()
    first, _ = source.position(span.start)
    names: list[str] = []
    for number in range(first - 1, 0, -1):
        line = source.line(number).strip()
        if not line.startswith("#"):
            break
        names.insert(0, line.lstrip("#").strip())
    return " ".join(filter(None, names))
