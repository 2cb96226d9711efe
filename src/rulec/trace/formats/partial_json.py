"""Values not exactly known, in JSON: ``null``, and intervals as ``{"from": 1, "to": 2}``."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from typing import Any

from rulec.trace.trace_model import State
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from rulec.vocabulary.written_numbers import WrittenNumber

BOUNDS = frozenset({"from", "to"})


def from_json(state: Mapping[str, Any], objects: Collection[str]) -> State:
    """The state that decoded JSON represents.

    A mapping with no keys besides `from` and `to` is an interval, unless all of its keys are
    ``objects``. Raises ValueError, saying what is wrong, if such an interval is invalid.
    """
    named = BOUNDS.intersection(objects)
    return {name: _value_of(value, name, named) for name, value in state.items()}


def _value_of(value: Any, name: str, named: frozenset[str]) -> Any:
    if value is None:
        return UNKNOWN
    if type(value) is not dict:
        return value
    if value and value.keys() <= BOUNDS and not value.keys() <= named:
        low, high = value.get("from"), value.get("to")
        if not all(type(end) in (int, float, WrittenNumber) for end in (low, high)):
            raise ValueError(f"`{name}` is an interval without a number for `from` or `to`")
        try:
            return Interval(low, high)  # type: ignore[arg-type]
        except ValueError as wrong:
            raise ValueError(f"`{name}`: {wrong}") from None
    return {item: _value_of(inner, name, named) for item, inner in value.items()}


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
