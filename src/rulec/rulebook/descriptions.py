"""What the comments beside a declaration say of it: the description that its author gave it."""

from __future__ import annotations

from rulec.diagnostics import Span


def description(span: Span) -> str:
    """The comment lines right above an item, or the comment behind it, as one line of text.

    A comment with a blank line below it is about more than the next item. Empty if there is none.
    """
    source = span.source
    first, _ = source.position(span.start)
    found: list[str] = []
    for number in range(first - 1, 0, -1):
        line = source.line(number).strip()
        if not line.startswith("#"):
            break
        found.insert(0, line.lstrip("#").strip())
    if not found:
        last, column = source.position(span.end)
        _, sign, behind = source.line(last)[column - 1 :].partition("#")
        found = [behind.strip()] if sign else []
    return " ".join(filter(None, found))
