"""Diagnostics as data: a code, a place and texts; sources and locations in them."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Iterable
from dataclasses import dataclass, field, replace
from itertools import chain
from typing import Any, Literal, TypeAlias

from rulec.diagnostics.argument_names import for_caller
from rulec.value_display import Rows, short_repr

Severity: TypeAlias = Literal["error", "warning"]


@dataclass(frozen=True, slots=True)
class Label:
    """A further place worth showing, with a short text about it."""

    place: SourceLocation
    message: str


@dataclass(frozen=True, slots=True)
class Fix:
    """An edit that corrects a mistake: the text at ``place`` is replaced by ``text``."""

    place: SourceLocation
    text: str


@dataclass(frozen=True, slots=True)
class Offer:
    """An edit that may be meant, with a title; it is tried and chosen, never made by itself.

    A place without a column stands for a new line above the item there, one without a line for a
    new line in the file's header. Without a title, the text is a name of which a variant is meant
    that is not in the file.
    """

    title: str
    fixes: tuple[Fix, ...]


@dataclass(frozen=True, slots=True)
class Diagnostic:
    """One mistake (or remark).

    ``message`` says what is wrong in one clause; ``expected`` is shown beside the underlined place
    (``expected a name``); ``help`` is the way out, ``fix`` the same as an edit, if one is certain,
    and ``offers`` the edits that may be meant by it, the most likely first.
    Diagnostics are made by the ``Code`` with the text ``code``.
    """

    __repr__ = short_repr

    code: str
    message: str
    place: SourceLocation | None = None
    expected: str = ""
    help: str = ""
    labels: tuple[Label, ...] = ()
    notes: tuple[str, ...] = ()
    severity: Severity = "error"
    fix: Fix | None = None
    offers: tuple[Offer, ...] = ()


def at(span: Span | None) -> SourceLocation | None:
    """The place of a span; None for None."""
    return None if span is None else span.place


def unquoted(diagnostic: Diagnostic) -> Diagnostic:
    """A diagnostic without the quoted source line."""
    if diagnostic.place is None:
        return diagnostic
    return replace(diagnostic, place=replace(diagnostic.place, excerpt=""))


def diagnostic_rows(diagnostics: Iterable[Diagnostic]) -> list[dict[str, Any]]:
    """Diagnostics as plain dicts."""
    return [
        {
            "code": diagnostic.code,
            "severity": diagnostic.severity,
            "message": diagnostic.message,
            **{part: getattr(diagnostic.place, part, None) for part in ("file", "line", "column")},
            "help": diagnostic.help,
        }
        for diagnostic in diagnostics
    ]


class RulecError(Rows, Exception):
    """Exception with one or more diagnostics that end a piece of work."""

    def __init__(self, diagnostics: Iterable[Diagnostic] | Diagnostic) -> None:
        if isinstance(diagnostics, Diagnostic):
            diagnostics = (diagnostics,)
        self._given = tuple(diagnostics)
        # Text that is not valid Unicode, as in a file's name, must not fail when printed
        text = "; ".join(_one_line(d) for d in self.diagnostics)
        texts = ((one.expected, one.help and f"help: {one.help}") for one in self.diagnostics[:20])
        ways_out = dict.fromkeys(filter(None, chain.from_iterable(texts)))
        super().__init__("\n".join([text, *ways_out]).encode(errors="backslashreplace").decode())

    @property
    def diagnostics(self) -> tuple[Diagnostic, ...]:
        """The diagnostics, with options or arguments named as their reader knows them."""
        return tuple(map(_for_caller, self._given))

    def __repr__(self) -> str:
        codes = "; ".join(d.code for d in self.diagnostics[:20])
        return f"RulecError({codes}: {self.args[0].partition(chr(10))[0]:.80})"

    def rows(self) -> list[dict[str, Any]]:
        """One row per diagnostic."""
        return diagnostic_rows(self.diagnostics)

    def __reduce__(self) -> tuple[type[RulecError], tuple[Any, ...]]:
        return type(self), (self._given,)


def as_answer(error: RulecError) -> RulecError:
    """The error without traceback and causes, whose frames keep their local variables alive.

    For errors that may occur once per row of a file.
    """
    error.__traceback__ = error.__cause__ = error.__context__ = None
    return error


def with_place(error: RulecError, place: SourceLocation | None) -> RulecError:
    """An error in which diagnostics without a place get this one."""
    if place is None or all(diagnostic.place for diagnostic in error.diagnostics):
        return error
    return RulecError(
        [
            diagnostic if diagnostic.place else replace(diagnostic, place=place)
            for diagnostic in error.diagnostics
        ]
    )


def _for_caller(diagnostic: Diagnostic) -> Diagnostic:
    message, way_out = map(for_caller, (diagnostic.message, diagnostic.help))
    if (message, way_out) == (diagnostic.message, diagnostic.help):
        return diagnostic
    return replace(diagnostic, message=message, help=way_out)


def _one_line(diagnostic: Diagnostic) -> str:
    where = "" if diagnostic.place is None else f"{address(diagnostic.place)}: "
    return f"{where}{diagnostic.message} [{diagnostic.code}]"


@dataclass(frozen=True, slots=True)
class SourceLocation:
    """Source location for readers: lines and columns count from 1.

    ``end_column`` is the column behind the last character. ``excerpt`` is the text of line ``line``
    (without its line end); empty when there is nothing worth showing.
    """

    file: str
    line: int | None = None
    column: int | None = None
    end_line: int | None = None
    end_column: int | None = None
    excerpt: str = ""

    @property
    def start(self) -> tuple[int, int]:
        """Line and column as a sort key; an unknown one is 0."""
        return self.line or 0, self.column or 0


def address(place: SourceLocation) -> str:
    """``file:line:column``, as far as it is known."""
    parts = [place.file, place.line, place.column]
    return ":".join(str(part) for part in parts if part is not None)


@dataclass(frozen=True, slots=True)
class Source:
    """A text with the name of the file it came from."""

    name: str
    text: str = field(repr=False)
    _line_starts: list[int] = field(default_factory=list, init=False, repr=False, compare=False)
    _known: dict[int, str] = field(default_factory=dict, init=False, repr=False, compare=False)

    def _lines(self) -> list[int]:
        if not self._line_starts:
            starts = [0]
            while (end := self.text.find("\n", starts[-1])) >= 0:
                starts.append(end + 1)
            self._line_starts.extend(starts)
        return self._line_starts

    def position(self, offset: int) -> tuple[int, int]:
        """Line and column, both from 1, of a character offset."""
        starts = self._lines()
        line = bisect_right(starts, offset)
        return line, offset - starts[line - 1] + 1

    def offset(self, line: int, column: int) -> int:
        """The character offset of a line and a column, both from 1."""
        return self._lines()[line - 1] + column - 1

    def line(self, number: int) -> str:
        """The text of a line, counted from 1, without its line end."""
        # However many mistakes a long line has, its text is copied once.
        if number not in self._known:
            starts = self._lines()
            end = starts[number] if number < len(starts) else len(self.text)
            self._known[number] = self.text[starts[number - 1] : end].rstrip("\r\n")
        return self._known[number]


@dataclass(frozen=True, slots=True)
class Span:
    """Characters ``start`` to ``end`` (exclusive) of a source."""

    source: Source
    start: int
    end: int

    @property
    def text(self) -> str:
        """The characters themselves."""
        return self.source.text[self.start : self.end]

    @property
    def place(self) -> SourceLocation:
        """The source location of the span, with its first line's text."""
        line, column = self.source.position(self.start)
        end_line, end_column = self.source.position(max(self.start, self.end))
        excerpt = self.source.line(line)
        return SourceLocation(
            file=self.source.name,
            line=line,
            column=column,
            end_line=end_line,
            end_column=end_column,
            excerpt=excerpt,
        )
