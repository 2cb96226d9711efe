"""Signal passes: which signals a function gives, and only those of them that somebody reads."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from typing import Any, TypeAlias, TypeVar

from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.signal_columns import SignalColumns, SignalNames, together

Passes: TypeAlias = Mapping[tuple[str, ...], Callable[[DriveContext], SignalColumns]]
"""Names -> the function that gives signals of these names, and no others."""

_Value = TypeVar("_Value")

_MOST_READERS = 1 << 6
"""Choices of names for which the functions are kept before all are forgotten."""


class SignalPasses:
    """Functions that give signals of a drive, each called if somebody reads any that it gives."""

    def __init__(self, passes: Passes) -> None:
        self._passes = passes
        self._read: dict[SignalNames, Sequence[Callable[[DriveContext], SignalColumns]]] = {}

    def __call__(self, context: DriveContext, names: SignalNames = None) -> SignalColumns:
        """The signals of a drive that have these names."""
        if names not in self._read:
            if len(self._read) >= _MOST_READERS:
                self._read.clear()
            self._read[names] = tuple(
                [
                    signals_of
                    for given, signals_of in self._passes.items()
                    if names is None or not names.isdisjoint(given)
                ]
            )
        return together([signals_of(context) for signals_of in self._read[names]], names)

    @staticmethod
    def joined(several: Iterable[SignalPasses]) -> SignalPasses:
        """The functions of several, in their order."""
        return SignalPasses({given: x for own in several for given, x in own._passes.items()})


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
