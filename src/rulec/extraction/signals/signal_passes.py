"""Signal passes: which signals a function provides, so that only functions that are read run."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import wraps
from typing import TypeAlias

from rulec.diagnostics import named
from rulec.diagnostics.fault_messages import fault_of
from rulec.extraction.drive_context import DriveContext
from rulec.extraction.signals.signal_columns import (
    OfObjects,
    OneSignal,
    SignalColumn,
    SignalColumns,
    SignalNames,
    SignalValues,
    named_signal,
    together,
)

_Pass: TypeAlias = Callable[[DriveContext], SignalColumns | OneSignal | None]

Passes: TypeAlias = Mapping[str | tuple[str, ...], _Pass]
"""Names of signals -> the function that provides exactly these; None if the recording does not."""


def about(
    values_of: Callable[[DriveContext], SignalValues | SignalColumn | None],
) -> Callable[[DriveContext], OfObjects | None]:
    """A function whose values are a signal about objects."""

    @wraps(values_of)
    def found(context: DriveContext) -> OfObjects | None:
        values = values_of(context)
        return None if values is None else OfObjects(values)

    return found


_MOST_READERS = 1 << 6
"""Most choices of names whose functions are kept; beyond this all are dropped."""


class SignalPasses:
    """The functions that compute a drive's signals, called only if a signal of theirs is read."""

    def __init__(self, passes: Passes) -> None:
        self._passes = {
            (given,) if isinstance(given, str) else given: x for given, x in passes.items()
        }
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
        found = signals_of(context)
    except Exception as problem:
        if context.spans.n_drives > 1:
            raise
        ego = context.ego.participants[0].id
        fault = fault_of(problem, f"{named(given)} in the drive of `{ego}`")
        return SignalColumns(faults=dict.fromkeys(given, fault))
    if found is None or isinstance(found, SignalColumns):
        return found or SignalColumns()
    (name,) = given
    return named_signal(name, found)
