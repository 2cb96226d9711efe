"""Values that are not known, in JSON: ``null``, and intervals as ``{"from": 1, "to": 2}``."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rulec.trace.trace_model import State
from rulec.vocabulary.partial_values import UNKNOWN, Interval


def from_json(state: Mapping[str, Any]) -> State:
    """The state that decoded JSON stands for."""
    return {name: _value_of(value) for name, value in state.items()}


def _value_of(value: Any) -> Any:
    if value is None:
        return UNKNOWN
    if type(value) is not dict:
        return value
    if value.keys() == {"from", "to"} and _is_interval(value["from"], value["to"]):
        return Interval(value["from"], value["to"])
    return {name: _value_of(inner) for name, inner in value.items()}


def _is_interval(low: Any, high: Any) -> bool:
    numbers = all(isinstance(end, int | float) and not isinstance(end, bool) for end in (low, high))
    return numbers and low <= high


def to_json(state: State) -> dict[str, Any]:
    """What JSON writes for a state."""
    return {name: _written(value) for name, value in state.items()}


def _written(value: Any) -> Any:
    if value is UNKNOWN:
        return None
    if isinstance(value, Interval):
        return {"from": value.low, "to": value.high}
    if isinstance(value, Mapping):
        return {name: _written(inner) for name, inner in value.items()}
    return value
