"""Columns of a table: numbers and texts as arrays, and errors about rows."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np
from numpy import bool_, int64
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.diagnostics import RulecError, nearest_name
from rulec.recordings.encodings.file_values import LARGEST, number_in, numbers_in, short
from rulec.value_display import short_repr

MOST_ROWS = 20_000_000
"""Limit on the rows of a table; all of NGSIM in one table has 12 million."""

MOST_COLUMNS = 1000

_ALIKE = 0.75
"""A slip in a name: one letter of four or more is another, or two have changed places."""

Refused = Callable[..., RulecError]
"""Makes a table's error from ``why``, the row's place or None, ``expected``, ``help_text``."""


class Texts(NamedTuple):
    """A text column: each row's code is an index into ``names``."""

    codes: NDArray[int64]
    names: tuple[str, ...]

    def groups(
        self, by: NDArray[np.integer[Any]] | None = None
    ) -> Iterator[tuple[str, NDArray[np.intp]]]:
        """Each text that occurs, with the indices of its rows, sorted by ``by`` if given."""
        order = np.lexsort((self.codes,) if by is None else (by, self.codes))
        starts = np.flatnonzero(np.diff(self.codes[order], prepend=-1)).tolist()
        for start, end in pairwise([*starts, len(order)]):
            yield self.names[int(self.codes[order[start]])], order[start:end]

    def of(self, row: int | np.intp) -> str:
        """The text of a row."""
        return self.names[int(self.codes[row])]

    def having(self, name: str) -> NDArray[bool_]:
        """Mask of the rows with a text."""
        code = self.names.index(name) if name in self.names else -1
        flags: NDArray[bool_] = self.codes == code
        return flags


@dataclass(frozen=True, slots=True, eq=False)
class Columns:
    """Columns by their names in the table's head; empty cells are NaN or ``""``.

    ``rows``: the places of the rows, such as line numbers.
    """

    __repr__ = short_repr

    refused: Refused
    numbers: Mapping[str, Floats]
    texts: Mapping[str, Texts]
    rows: NDArray[int64]

    def wrong(self, row: int, why: str, expected: str = "", help_text: str = "") -> RulecError:
        """The error for a row, counted from 0."""
        place = int(self.rows[row])
        return self.refused(why, place, expected=expected, help_text=help_text)

    def part(self, chosen: NDArray[np.intp]) -> Columns:
        """The columns, reduced to the chosen rows."""
        return Columns(
            self.refused,
            {name: column[chosen] for name, column in self.numbers.items()},
            {name: Texts(text.codes[chosen], text.names) for name, text in self.texts.items()},
            self.rows[chosen],
        )


@dataclass(frozen=True, slots=True)
class ColumnTable:
    """A table before it is read: the names of its columns, and the function that reads some.

    ``read`` takes the names of the number columns and of the text columns.
    """

    __repr__ = short_repr

    names: tuple[str, ...]
    refused: Refused
    read: Callable[[Sequence[str], Sequence[str]], Columns]


class ColumnKind(NamedTuple):
    """A column that a table may have: each name for it, with the unit's size in rulec's unit."""

    name: str
    also: Mapping[str, float]
    is_text: bool = False
    required: bool = False


class NamedColumns(NamedTuple):
    """Columns of a table under rulec's names and in rulec's units, and the unread names.

    ``given``: each column's name in the table, and the size of its unit in rulec's unit.
    """

    columns: Columns
    given: Mapping[str, tuple[str, float]]
    numbers: Mapping[str, Floats]
    texts: Mapping[str, Texts]
    unread: tuple[str, ...]

    def number(self, name: str) -> Floats | None:
        """A number column, or None if the table lacks it."""
        return self.numbers.get(name)

    def part(self, chosen: NDArray[np.intp]) -> NamedColumns:
        """The columns, reduced to the chosen rows."""
        return NamedColumns(
            self.columns.part(chosen),
            self.given,
            {name: column[chosen] for name, column in self.numbers.items()},
            {name: Texts(text.codes[chosen], text.names) for name, text in self.texts.items()},
            self.unread,
        )


def named_columns(table: ColumnTable, kinds: Sequence[ColumnKind]) -> NamedColumns:
    """Read the columns that are known, under any of their names.

    Raises RulecError for a required column that is missing or has empty cells, and for a column
    that occurs twice.
    """
    ours = {alias: kind for kind in kinds for alias in (kind.name, *kind.also)}
    given: dict[str, tuple[str, float]] = {}
    unread = []
    for name in table.names:
        alias = name.strip().casefold()
        kind = ours.get(alias)
        if kind is None:
            unread.append(name)
        elif kind.name in given:
            both = f"`{short(given[kind.name][0])}` and `{short(name)}`"
            why = f"its columns {both} are both `{kind.name}`"
            raise table.refused(why, help_text="keep one of them, or rename the other")
        else:
            given[kind.name] = name, kind.also.get(alias, 1.0)
    for kind in kinds:
        if kind.required and kind.name not in given:
            raise _missing(table, kind, unread, [k.name for k in kinds if k.required])
    texts = {x.name: given[x.name][0] for x in kinds if x.is_text and x.name in given}
    numbers = {own: name for own, (name, _) in given.items() if own not in texts}
    columns = table.read([*numbers.values()], [*texts.values()])
    for kind in kinds:
        if kind.required:
            _check_full(columns, given[kind.name][0], kind)
    return NamedColumns(
        columns,
        given,
        {own: columns.numbers[name] * given[own][1] for own, name in numbers.items()},
        {own: columns.texts[name] for own, name in texts.items()},
        tuple(unread),
    )


def unread_remark(unread: Iterable[str], kinds: Sequence[ColumnKind]) -> str:
    """A remark on unread columns whose names resemble those of known columns."""
    known = [kind.name for kind in kinds]
    near = [(short(name), nearest_name(name.strip(), known, _ALIKE)) for name in unread]
    similar = [f"`{name}` (is it `{known_name}`?)" for name, known_name in near if known_name]
    return f"columns that are not read: {', '.join(similar)}" if similar else ""


def _missing(
    table: ColumnTable, kind: ColumnKind, unread: Sequence[str], required: Sequence[str]
) -> RulecError:
    near = _with_unit(kind, unread) or nearest_name(kind.name, [name.strip() for name in unread])
    why = f"it has no column `{kind.name}`" + (f", but `{short(near)}`" if near else "")
    also = [name for name in kind.also if name != kind.name][:4]
    way_out = (
        f"if `{short(near)}` is meant, rename it to `{kind.name}`"
        if near
        else f"name a column `{kind.name}`"
        + (f" (also {', '.join(f'`{name}`' for name in also)})" if also else "")
    )
    expected = f"expected the columns {', '.join(f'`{name}`' for name in required)}"
    return table.refused(why, expected=expected, help_text=way_out)


def _with_unit(kind: ColumnKind, unread: Iterable[str]) -> str | None:
    """An unread heading with a known name and something after it, such as `x [m]`."""
    names = (kind.name, *kind.also)
    bare = ((name, re.match(r"\w*", name.strip().casefold())) for name in unread)
    return next((name for name, match in bare if match and match[0] in names), None)


def _check_full(columns: Columns, name: str, kind: ColumnKind) -> None:
    texts, numbers = columns.texts, columns.numbers
    empty = texts[name].having("") if kind.is_text else np.isnan(numbers[name])
    if empty.any():
        row = int(np.argmax(empty))
        why = f"its column `{short(name)}` is empty here"
        if kind.is_text:
            raise columns.wrong(row, why, "expected a value")
        raise columns.wrong(
            row,
            f"{why}, or says that it is none, as `nan` does",
            "expected a number",
            "leave the row out, or write the number that is meant",
        )


def checked_numbers(values: Sequence[str], largest: float = LARGEST) -> tuple[Floats, int | None]:
    """The numbers in texts, NaN for empty ones, and the index of the first that is not a number.

    Booleans become 1 and 0 if the column holds nothing else.
    """
    try:
        numbers = np.fromiter(numbers_in(values), float, len(values))
    except ValueError:
        spelt = {value: _number(value) for value in set(values)}
        if {value.strip().casefold() for value in spelt} <= _FLAGS:
            spelt = {value: _flag(value) for value in spelt}
        numbers = np.fromiter(map(spelt.__getitem__, values), float, len(values))
    bad = ~(np.abs(numbers) < largest) & ~np.isnan(numbers)
    return numbers, int(np.argmax(bad)) if bad.any() else None


def _number(text: str) -> float:
    """A number; NaN for an empty text, infinity for one that is not a number."""
    try:
        return number_in(text)
    except ValueError:
        return np.nan if text.strip().casefold() in _EMPTY else np.inf


def _flag(text: str) -> float:
    return {"true": 1.0, "false": 0.0}.get(text.strip().casefold(), np.nan)


_EMPTY = ("", "na", "<na>", "n/a", "null", "none", "-")
_FLAGS = {"true", "false", "nan", *_EMPTY}
"""The texts in a Boolean column, as pandas writes it."""
