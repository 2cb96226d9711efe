"""Messages of Waymo's scenarios with checked values."""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite

import numpy as np

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_values import LARGEST
from rulec.recordings.encodings.wire_format import Message, Value, WireField, WireFile
from rulec.recordings.lane_centres.road_features import Places3d

_NAN = float("nan")


@dataclass(frozen=True, slots=True)
class CheckedMessage:
    """A message with the byte at which it begins. Its methods raise RulecError R0610."""

    values: dict[str, list[WireField]]
    place: int
    file: WireFile

    def number(self, name: str) -> float:
        """A number, which must be present and not huge."""
        value = float(self._only(name))
        if not abs(value) < LARGEST:
            raise self.wrong(f"`{name}` is {value:g}", f"a number below {LARGEST:.0e}")
        return value

    def whole(self, name: str, default: int | None = None) -> int:
        """A whole number, or its default; without a default it must be present."""
        return default if default is not None and name not in self.values else int(self._only(name))

    def word(self, name: str, default: str = "unknown") -> str:
        """A word of an enumeration, or its default."""
        values = self.values.get(name)
        return str(values[0].value) if values else default

    def is_true(self, name: str) -> bool:
        """A flag; false if it is missing."""
        values = self.values.get(name)
        return bool(values and values[0].value)

    def wholes(self, name: str) -> list[int]:
        """All whole numbers in a field."""
        return [value for item in self.values.get(name, ()) if isinstance(value := item.value, int)]

    def message(self, name: str) -> CheckedMessage | None:
        """The message in a field; None if it is missing."""
        return next(iter(self.messages(name)), None)

    def messages(self, name: str) -> list[CheckedMessage]:
        """All messages in a field."""
        return [checked(item, self.file) for item in self.values.get(name, ())]

    def places(self, name: str) -> Places3d:
        """The points in a field."""
        rows = [point.xyz() for point in self.messages(name)]
        return np.array(rows, dtype=float).reshape(-1, 3)

    def xyz(self) -> tuple[float, float, float]:
        """A point's coordinates (m); its height may be missing."""
        return self.number("x"), self.number("y"), self.number("z") if "z" in self.values else _NAN

    def wrong(self, why: str, expected: str = "") -> RulecError:
        """The error at the byte where the message begins."""
        return self.file.wrong(why, self.place, expected)

    def _only(self, name: str) -> float:
        values = self.values.get(name)
        value: Value = values[0].value if values else _NAN
        if not isinstance(value, int | float) or not isfinite(value):
            why = f"`{name}` is {value!r:.40}" if values else f"there is no `{name}`"
            raise self.wrong(why, "a number")
        return value


def checked(item: WireField, file: WireFile) -> CheckedMessage:
    """The message in a field, with access by field name."""
    values: dict[str, list[WireField]] = {}
    if isinstance(item.value, Message):
        for field in item.value.fields:
            values.setdefault(field.field.name, []).append(field)
    return CheckedMessage(values, item.place, file)
