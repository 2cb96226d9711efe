"""Signal passes: which signals a function gives, and only those of them that somebody reads."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import wraps
from typing import Any, TypeAlias, TypeVar

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.signal_columns import SignalColumns, SignalNames, together

Passes: TypeAlias = Mapping[tuple[str, ...], Callable[[DriveContext], SignalColumns]]
"""Names -> the function that gives signals of these names, and no others."""

_Value = TypeVar("_Value")


def signals_by(passes: Passes, context: DriveContext, names: SignalNames) -> SignalColumns:
    """The signals of a drive that have these names, by those passes that give any of them."""
    parts = [
        signals_of(context)
        for given, signals_of in passes.items()
        if names is None or not names.isdisjoint(given)
    ]
    return together(parts, names)


def once_a_recording(
    function: Callable[[DriveContext], _Value],
) -> Callable[[DriveContext], _Value]:
    """Let a function of no more than the recording and its thresholds compute once for it.

    The recording's surroundings keep what it finds; they are made for one side of traffic and one
    choice of thresholds. It is shared: nobody changes it.
    """

    @wraps(function)
    def found(context: DriveContext) -> _Value:
        return _kept(function, function, context, context.surroundings.computed)

    return found


def once_a_map(function: Callable[[DriveContext], _Value]) -> Callable[[DriveContext], _Value]:
    """The same of a function of no more than the recording's map."""

    @wraps(function)
    def found(context: DriveContext) -> _Value:
        return _kept(function, function, context, context.surroundings.of_map)

    return found


def once_a_road(function: Callable[[DriveContext], _Value]) -> Callable[[DriveContext], _Value]:
    """The same of a function of no more than the road, too."""

    @wraps(function)
    def found(context: DriveContext) -> _Value:
        known = context.surroundings.of_map
        return _kept((function, context.road), function, context, known)

    return found


def _kept(
    key: object,
    function: Callable[[DriveContext], _Value],
    context: DriveContext,
    known: dict[object, Any],
) -> _Value:
    if key not in known:
        known[key] = function(context)
    found: _Value = known[key]
    return found
