"""Signal passes: which signals a function provides, so that only functions that are read run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from typing import Any, TypeAlias, TypeVar

from rulec.diagnostics import named
from rulec.diagnostics.fault_messages import fault_of
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.signal_columns import SignalColumns, SignalNames, together

_Pass: TypeAlias = Callable[[DriveContext], SignalColumns]

Passes: TypeAlias = Mapping[tuple[str, ...], _Pass]
"""Names of signals -> the function that provides exactly these."""

_Value = TypeVar("_Value")

_MOST_READERS = 1 << 6
"""Most choices of names whose functions are kept; beyond this all are dropped."""


class SignalPasses:
    """The functions that compute a drive's signals, called only if a signal of theirs is read."""

    def __init__(self, passes: Passes) -> None:
        self._passes = passes
        self._read: dict[SignalNames, Sequence[tuple[Sequence[str], _Pass]]] = {}

    def __call__(self, context: DriveContext, names: SignalNames = None) -> SignalColumns:
        """The signals of a drive that have these names.

        An exception in a function costs a single drive that function's signals. If there are
        several drives it is raised, so that each of them can be made by itself.
        """
        if names not in self._read:
            if len(self._read) >= _MOST_READERS:
                self._read.clear()
            self._read[names] = tuple(
                [
                    (given, signals_of)
                    for given, signals_of in self._passes.items()
                    if names is None or not names.isdisjoint(given)
                ]
            )
        return together([_contained(*own, context) for own in self._read[names]], names)

    @staticmethod
    def joined(several: Iterable[SignalPasses]) -> SignalPasses:
        """The functions of several passes, in their order."""
        return SignalPasses({given: x for own in several for given, x in own._passes.items()})


def _contained(given: Sequence[str], signals_of: _Pass, context: DriveContext) -> SignalColumns:
    try:
        return signals_of(context)
    except Exception as problem:
        if context.spans.n_drives > 1:
            raise
        ego = context.ego.participants[0].id
        fault = fault_of(problem, f"{named(given)} in the drive of `{ego}`")
        return SignalColumns(faults=dict.fromkeys(given, fault))


def once_a_recording(
    function: Callable[[DriveContext], _Value],
) -> Callable[[DriveContext], _Value]:
    """Make a function of only the recording and its thresholds compute its result once.

    The recording's surroundings keep the result; they belong to one side of traffic and one choice
    of thresholds. It is shared, so callers must not change it.
    """

    @wraps(function)
    def found(context: DriveContext) -> _Value:
        return _kept(function, function, context, context.surroundings.computed)

    return found


def once_a_map(function: Callable[[DriveContext], _Value]) -> Callable[[DriveContext], _Value]:
    """``once_a_recording`` for a function of only the recording's map."""

    @wraps(function)
    def found(context: DriveContext) -> _Value:
        return _kept(function, function, context, context.surroundings.of_map)

    return found


def once_a_road(function: Callable[[DriveContext], _Value]) -> Callable[[DriveContext], _Value]:
    """``once_a_recording`` for a function of only the map and one road."""

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
