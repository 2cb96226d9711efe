"""What benchmarks find, as data, and as lines of text."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field


@dataclass(frozen=True)
class Figure:
    """One measured thing; ``median`` and ``fastest`` are in ``unit``.

    ``most`` is what the median should not exceed. ``ratio`` says how many times as long ``peer``
    takes, measured in turns with it, and ``least_ratio`` how often that should be at least.
    """

    what: str
    unit: str
    median: float
    fastest: float
    most: float | None = None
    peer: str = ""
    ratio: float | None = None
    least_ratio: float | None = None

    @property
    def wanted(self) -> str:
        """What should be reached; empty if nothing is asked."""
        time = "" if self.most is None else f"≤ {self.most:g} {self.unit}"
        ratio = "" if self.least_ratio is None else f"≥ {self.least_ratio:,g}×"
        return ", ".join(filter(None, (time, ratio)))

    @property
    def is_reached(self) -> bool:
        """Is what is wanted reached?"""
        quick = self.most is None or self.median <= self.most
        return quick and (self.least_ratio is None or (self.ratio or 0) >= self.least_ratio)

    @property
    def compared(self) -> str:
        """How many times as long the peer takes."""
        return "" if self.ratio is None else f"{number(self.ratio)}× {self.peer}"


@dataclass(frozen=True)
class Result:
    """The figures of work on one input; ``input`` says what it is, ``notes`` what else to know.

    ``table`` has all of it where figures are of many things alike, its first row their names.
    """

    title: str
    input: str
    figures: list[Figure]
    notes: list[str] = field(default_factory=list)
    table: list[list[str]] = field(default_factory=list)


COLUMNS = ("figure", "wanted", "median", "fastest", "peer takes")


def cells(figure: Figure) -> tuple[str, ...]:
    """A row of a table, under ``COLUMNS``."""
    wanted = figure.wanted
    if wanted and not figure.is_reached:
        wanted += ", missed"
    times = (f"{number(one)} {figure.unit}" for one in (figure.median, figure.fastest))
    return (figure.what, wanted, *times, figure.compared)


def as_text(result: Result) -> str:
    """A result for a terminal."""
    rows = [COLUMNS, *map(cells, result.figures)]
    notes = [f"  * {one}" for one in result.notes]
    more = aligned(result.table) if result.table else []
    return "\n".join([result.title, f"  {result.input}", *aligned(rows), *notes, *more])


def aligned(rows: Sequence[Sequence[str]]) -> list[str]:
    """Rows with their columns under each other."""
    widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
    padded = (map(str.ljust, row, widths) for row in rows)
    return [("  " + "  ".join(row)).rstrip() for row in padded]


def number(value: float) -> str:
    """With three digits that say something."""
    if value >= 100:
        return f"{value:,.0f}"
    return f"{value:.{1 if value >= 10 else 2 if value >= 1 else 3}f}"
