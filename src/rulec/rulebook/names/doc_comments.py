"""Doc comments: the description that an author wrote beside a declaration."""

from __future__ import annotations

from rulec.diagnostics import Span


def description(span: Span) -> str:
    """Description of an item: the comment behind it, else those above.

    With one behind the item, those above it may be about several items. A comment with a blank line
    below it is about more than the next item. Empty if there is none.
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
