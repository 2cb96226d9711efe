"""Documents with possible line breaks, and their layout in lines.

After Oppen, "Pretty Printing" (1980), and Wadler, "A Prettier Printer" (2003): a group is put on
one line if it fits there; otherwise all of its own breaks become line ends. The lines depend only
on the document, so that formatting twice gives the same result.
"""

from __future__ import annotations

from dataclasses import dataclass, field

from rulec.syntax.formatting.comments import Comment

WIDTH = 100
"""The maximal length of a line."""

_DEEPEST = 60
"""Lines are indented no deeper than this, so that deeply nested text has room."""


@dataclass(frozen=True, slots=True)
class Break:
    """Printed as ``flat`` while its group is on one line, otherwise a line end."""

    flat: str = " "


@dataclass(frozen=True, slots=True)
class Fill:
    """A space, or a line end if the next part is too long.

    The next part extends to the next break; its new line is indented ``deeper``.
    """

    deeper: int = 4


@dataclass(frozen=True, slots=True)
class LineEnd:
    """A fixed line end, with the comments that belong there."""

    trailing: Comment | None = None
    own: tuple[Comment, ...] = ()
    deeper: int = 0
    inner: int = 0


@dataclass(frozen=True, slots=True)
class ColumnMark:
    """Marks a position in a line, for alignment in a column."""


@dataclass(frozen=True, slots=True)
class Nest:
    """Content whose lines are indented this much deeper."""

    deeper: int
    inside: Document


@dataclass(frozen=True, slots=True)
class GroupDocument:
    """Content that is put on one line if it fits, unless ``forced`` to be broken."""

    inside: Document
    forced: bool


@dataclass(frozen=True, slots=True)
class Concatenation:
    """Documents one after the other."""

    parts: tuple[Document, ...]
    forced: bool


Document = str | Break | Fill | LineEnd | ColumnMark | Nest | GroupDocument | Concatenation


@dataclass(slots=True)
class LaidOutLine:
    """A line of the layout: its code, trailing comment and column mark.

    ``opens``: it ends with the opening brace of a block.
    """

    code: str
    comment: Comment | None = None
    mark: int = 0
    opens: bool = False


def run(*parts: Document) -> Concatenation:
    """Documents one after the other."""
    return Concatenation(parts, any(map(has_line_end, parts)))


def group(*parts: Document, forced: bool = False) -> GroupDocument:
    """A document that is put on one line if it fits and is not ``forced`` to be broken."""
    inside = run(*parts)
    return GroupDocument(inside, forced or inside.forced)


def has_line_end(document: Document) -> bool:
    """Whether a document has a fixed line end."""
    match document:
        case LineEnd():
            return True
        case Nest(inside=inside):
            return has_line_end(inside)
        case GroupDocument(forced=forced) | Concatenation(forced=forced):
            return forced
        case _:
            return False


_Todo = list[tuple[int, bool, Document]]
"""The remaining work, the next item last: indentation, whether on one line, document."""


@dataclass(slots=True)
class _Layout:
    todo: _Todo
    width: int
    rows: list[LaidOutLine] = field(default_factory=list)

    def go(self) -> list[LaidOutLine]:
        self._line(self.todo[0][0])
        while self.todo:
            indent, flat, document = self.todo.pop()
            match document:
                case str():
                    self.rows[-1].code += document
                case ColumnMark():
                    self.rows[-1].mark = len(self.rows[-1].code)
                case Concatenation(parts):
                    self.todo.extend((indent, flat, part) for part in reversed(parts))
                case Nest(deeper, inside):
                    self.todo.append((indent + deeper, flat, inside))
                case GroupDocument(inside, forced):
                    fits = flat or (not forced and self._fits(inside))
                    self.todo.append((indent, fits, inside))
                case Break(text):
                    if flat:
                        self.rows[-1].code += text
                    else:
                        self._line(indent)
                case Fill(deeper):
                    if flat or self._fits(" "):
                        self.rows[-1].code += " "
                    else:
                        self._line(indent + deeper)
                case LineEnd(trailing, own, deeper, inner):
                    self.rows[-1].comment = trailing
                    for comment in own:
                        self._line(indent + deeper + inner)
                        self.rows[-1].code += comment.text
                    self._line(indent + deeper)
        return self.rows

    def _line(self, indent: int) -> None:
        self.rows.append(LaidOutLine(" " * min(indent, _DEEPEST)))

    def _fits(self, *documents: Document) -> bool:
        columns_left = self.width - len(self.rows[-1].code)
        inner: _Todo = [(0, True, document) for document in reversed(documents)]
        behind = len(self.todo)
        while columns_left >= 0:
            if inner:
                _, flat, one = inner.pop()
            elif behind:
                behind -= 1
                _, flat, one = self.todo[behind]
            else:
                return True
            match one:
                case str():
                    columns_left -= len(one)
                case Concatenation(parts):
                    inner.extend((0, flat, part) for part in reversed(parts))
                case Nest(inside=inside) | GroupDocument(inside=inside):
                    inner.append((0, flat, inside))
                case Break(text) if flat:
                    columns_left -= len(text)
                case Fill() if flat:
                    columns_left -= 1
                case Break() | Fill() | LineEnd():
                    return True
        return False


def lay_out(document: Document, indent: int = 0, width: int = WIDTH) -> list[LaidOutLine]:
    """Lay out a document in lines of at most ``width`` columns.

    A line is longer only if it cannot be broken.
    """
    return _Layout([(indent, False, document)], width).go()


def on_one_line(document: Document) -> str:
    """The text of a document without line ends, on one line."""
    (row,) = _Layout([(0, True, document)], 0).go()
    return row.code
