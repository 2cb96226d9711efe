"""Values in JSON that need care: unknown ones, intervals, and numbers that no float represents.

``null`` is an unknown value, and ``{"from": 1, "to": 2}`` an interval.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Collection, Mapping
from typing import Any

import msgspec

from rulec.trace.trace_model import State
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from rulec.vocabulary.written_numbers import WrittenNumber, number_written

BOUNDS = frozenset({"from", "to"})

_NUMBERS = frozenset({int, float, WrittenNumber})

_DIGIT = ord("0")
_DIGITS = bytes(_DIGIT if chr(byte) in "0123456789" else 32 for byte in range(256))
_MANY = b"0" * 16
"""Numbers with fewer digits are exact floats, except tiny ones."""

_LONG = re.compile(rb"[0-9](?:\.?[0-9]){15,}(?:[eE][-+]?[0-9]+)?")
_TINY = re.compile(rb"[eE]-0*(?:29[0-9]|[3-9][0-9]{2}|[0-9]{4})")


def from_json(state: Mapping[str, Any], objects: Collection[str]) -> State:
    """The state that decoded JSON represents.

    A mapping with no keys besides `from` and `to` is an interval, unless all of its keys are
    ``objects``. Raises ValueError, saying what is wrong, if such an interval is invalid.
    """
    named = BOUNDS.intersection(objects)
    read = dict(state)
    for name, value in state.items():
        if value is None:
            read[name] = UNKNOWN
        elif type(value) is dict:
            read[name] = _of_object(value, name, named)
    return read


def _of_object(given: dict[str, Any], name: str, named: frozenset[str]) -> Any:
    """What a JSON object says of a name: an interval, or what it is for each object."""
    if given and given.keys() <= BOUNDS and not given.keys() <= named:
        return _interval(given, name)
    read = given.copy()
    for item, value in given.items():
        if value is None:
            read[item] = UNKNOWN
        elif type(value) is dict:
            read[item] = _of_object(value, name, named)
    return read


def _interval(given: dict[str, Any], name: str) -> Interval:
    low, high = given.get("from"), given.get("to")
    if type(low) not in _NUMBERS or type(high) not in _NUMBERS:
        raise ValueError(f"`{name}` is an interval without a number for `from` or `to`")
    try:
        return Interval(low, high)  # type: ignore[arg-type]
    except ValueError as wrong:
        raise ValueError(f"`{name}`: {wrong}") from None


def to_json(state: State) -> dict[str, Any]:
    """A state in the form that is encoded as JSON."""
    return {name: _written(value) for name, value in state.items()}


def _written(value: Any) -> Any:
    if value is UNKNOWN:
        return None
    if isinstance(value, Interval):
        return {"from": value.low, "to": value.high}
    if isinstance(value, Mapping):
        return {name: _written(inner) for name, inner in value.items()}
    return value


def may_be_no_float(line: bytes) -> bool:
    """Whether JSON contains numbers that may not be exactly a float's decimal.

    Also True for a text that looks like such a number.
    """
    digits = line.translate(_DIGITS, b".")
    if _MANY in digits and not all(map(_is_own, _LONG.findall(line))):
        return True
    return (b"e-" in line or b"E-" in line) and _TINY.search(line) is not None


def _is_own(written: bytes) -> bool:
    """Whether a decimal is exactly what Python writes for its float."""
    text = written.decode()
    return float.__repr__(float(text)) == text


def exactly(line: bytes) -> dict[str, Any]:
    """The JSON object in a line, with all numbers exactly as written.

    Raises ValueError for a number that is too long or too close to 0.
    """
    decoded: dict[str, Any] = json.loads(line, parse_float=number_written, parse_int=_whole)
    return decoded


def _whole(text: str) -> float:
    number = number_written(text)
    return int(text) if math.isinf(number) else number


def as_written(value: object) -> object:
    """What an encoder writes for numbers it does not know: a WrittenNumber, or NumPy's floats."""
    if isinstance(value, WrittenNumber):
        return msgspec.Raw(str(value).encode())
    if isinstance(value, float):  # NumPy's
        return float(value)
    raise NotImplementedError
