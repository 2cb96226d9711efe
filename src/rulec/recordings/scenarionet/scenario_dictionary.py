"""Values in ScenarioNet's dictionaries, checked, with the path of keys to each.

https://scenarionet.readthedocs.io/en/latest/description.html describes the content.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field, replace
from itertools import chain, compress
from pathlib import Path
from typing import Any

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.encodings.file_values import LARGEST, short

MOST_NUMBERS = 5_000_000
"""Limit on the numbers read from a scenario's arrays and lists; 20 s have some 100,000."""

_TWO_AXES = 2
_NUMBERS = frozenset({int, float, bool, np.float64, np.float32, np.int64, np.int32, np.bool_})


@dataclass(slots=True)
class NumbersLeft:
    """How many more numbers may be read: the same value may occur in many places."""

    count: int = MOST_NUMBERS


@dataclass(frozen=True, slots=True)
class KeyedValue:
    """A value with the keys that lead to it. Its methods raise RulecError R0610.

    ``place`` is the byte at which its scenario begins, of several in a file.
    """

    value: Any
    way: tuple[str, ...]
    path: Path
    form: BinaryFormat
    left: NumbersLeft = field(default_factory=NumbersLeft)
    place: int | None = None

    def wrong(self, why: str) -> RulecError:
        """The error about a value."""
        where = " / ".join(self.way)
        return self.form.refused(
            self.path, f"`{where}` {why}" if where else f"it {why}", self.place
        )

    def get(self, key: str) -> KeyedValue | None:
        """The value of a dictionary's key; None if it is missing or None."""
        if not isinstance(self.value, dict):
            raise self.wrong("is no dictionary")
        value = self.value.get(key)
        return None if value is None else self._below(key, value)

    def child(self, key: str) -> KeyedValue:
        """The value of a dictionary's key."""
        keyed_value = self.get(key)
        if keyed_value is None:
            raise self.wrong(f"has no `{key}`")
        return keyed_value

    def items(self) -> list[tuple[str, KeyedValue]]:
        """The keys of a dictionary, as texts, and their values."""
        if not isinstance(self.value, dict):
            raise self.wrong("is no dictionary")
        self._spend(len(self.value))
        names = list(map(str, self.value))
        if len(set(names)) < len(names):
            ((twice, _),) = Counter(names).most_common(1)
            raise self.wrong(f"has the key `{short(twice)}` twice, as a text and as a number")
        return [
            (name, self._below(name, value))
            for name, value in zip(names, self.value.values(), strict=True)
        ]

    def elements(self) -> list[KeyedValue]:
        """The elements of a list, a tuple, or an array along its first axis."""
        value = self._row()
        return [self._below(str(number), item) for number, item in enumerate(value)]

    def chosen(self, flags: NDArray[np.bool_], flags_name: str) -> KeyedValue:
        """The elements of a list, tuple or array that are flagged; it has as many as ``flags``."""
        value = self._row()
        if len(value) != len(flags):
            raise self.wrong(f"has {len(value)} states, `{flags_name}` has {len(flags)}")
        if isinstance(value, np.ndarray):
            return replace(self, value=value[flags])
        return replace(self, value=list(compress(value, flags.tolist())))

    def _row(self) -> list[Any] | tuple[Any, ...] | NDArray[Any]:
        value = self.value
        # ``np.ndim`` would make an array of a list, whose elements may differ in length
        is_row = (
            value.ndim > 0 if isinstance(value, np.ndarray) else isinstance(value, list | tuple)
        )
        if not is_row:
            raise self.wrong("is no list")
        self._spend(len(value))
        row: list[Any] | tuple[Any, ...] | NDArray[Any] = value
        return row

    def text(self) -> str:
        """A text; a whole number is converted to one."""
        if isinstance(self.value, str | int | np.integer | np.str_):
            return str(self.value)
        raise self.wrong("is no text")

    def whole(self) -> int:
        """A whole number, which may be written as a text."""
        text = self.text()
        if not (text.isascii() and text.lstrip("-").isdigit() and len(text) < 19):
            raise self.wrong(f"is `{short(text)}`, no whole number")
        return int(text)

    def numbers(self) -> NDArray[float64]:
        """The finite numbers in an array, or in a list or tuple of at most two levels."""
        value = self.value
        if not isinstance(value, np.ndarray):
            value = self._as_array()
        self._spend(value.size)
        if value.dtype.kind not in "biuf":
            raise self.wrong("has other things than numbers in it")
        numbers: NDArray[float64] = value.astype(float64)
        if numbers.size and not (np.abs(numbers) < LARGEST).all():
            raise self.wrong(f"contains a number that is not below {LARGEST:.0e}")
        return numbers

    def column(self) -> NDArray[float64]:
        """Numbers in a single row or column."""
        numbers = self.numbers()
        if numbers.ndim == _TWO_AXES and numbers.shape[1] == 1:
            numbers = numbers[:, 0]
        if numbers.ndim != 1:
            raise self.wrong(f"has the shape {numbers.shape}, not that of a list")
        return numbers

    def places(self) -> NDArray[float64]:
        """Points in rows: x, y and z; z is NaN where it is missing."""
        numbers = self.numbers()
        if not numbers.size:
            return np.empty((0, 3))
        if numbers.ndim != _TWO_AXES or numbers.shape[1] < _TWO_AXES:
            raise self.wrong(f"has the shape {numbers.shape}, not that of points")
        if numbers.shape[1] == _TWO_AXES:
            return np.column_stack((numbers, np.full(len(numbers), np.nan)))
        return numbers[:, :3]

    def _as_array(self) -> NDArray[float64]:
        if not isinstance(self.value, list | tuple):
            raise self.wrong("is no array")
        self._spend(len(self.value))
        kinds = set(map(type, self.value))
        flat = bool(kinds) and kinds <= _NUMBERS
        rows = [np.ravel(row) if isinstance(row, np.ndarray) else row for row in self.value]
        if not flat and not all(isinstance(row, list | tuple | np.ndarray) for row in rows):
            raise self.wrong("has other things than numbers in it")
        if not flat:
            self._spend(sum(map(len, rows)))
            if len(set(map(len, rows))) > 1:
                raise self.wrong("has rows of different lengths")
        if not set(map(type, rows if flat else chain.from_iterable(rows))) <= _NUMBERS:
            raise self.wrong("has other things than numbers in it")
        table: NDArray[float64] = np.array(rows, dtype=float64)
        return table

    def _spend(self, count: int) -> None:
        self.left.count -= count
        if self.left.count < 0:
            raise self.wrong(
                f"is one of more than {MOST_NUMBERS:,} values, or some come many times"
            )

    def _below(self, key: str, value: Any) -> KeyedValue:
        return replace(self, value=value, way=(*self.way, short(key)))
