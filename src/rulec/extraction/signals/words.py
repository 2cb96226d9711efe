"""Words: the names that a definition provides, so that only definitions that are read run."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Callable, Iterable, Sequence
from types import ModuleType
from typing import TypeAlias, TypeVar

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

_Definition: TypeAlias = Callable[[DriveContext], SignalColumns | OneSignal | None]
_OfEachObject: TypeAlias = Callable[[DriveContext], SignalValues | SignalColumn | None]
_OneWay = TypeVar("_OneWay", bound=_Definition)
_AboutObjects = TypeVar("_AboutObjects", bound=_OfEachObject)

_DEFINED: dict[str, dict[tuple[str, ...], _Definition]] = defaultdict(dict)
"""Module -> the words that each of its definitions provides, in their order."""


def word(*names: str) -> Callable[[_OneWay], _OneWay]:
    """For a function that defines exactly these words; None if a recording does not tell them."""

    def defines(definition: _OneWay) -> _OneWay:
        _DEFINED[definition.__module__][names] = definition
        return definition

    return defines


def word_of_objects(name: str) -> Callable[[_AboutObjects], _AboutObjects]:
    """For a function whose values define a word about objects."""

    def defines(definition: _AboutObjects) -> _AboutObjects:
        def of_objects(context: DriveContext) -> OfObjects | None:
            values = definition(context)
            return None if values is None else OfObjects(values)

        _DEFINED[definition.__module__][name,] = of_objects
        return definition

    return defines


_MOST_READERS = 1 << 6
"""Most choices of names whose definitions are kept; beyond this all are dropped."""


class WordsByModule:
    """The words that some modules define, computed only if one of a definition's words is read."""

    def __init__(self, modules: Iterable[ModuleType]) -> None:
        self._definitions = {
            names: definition
            for module in modules
            for names, definition in _DEFINED[module.__name__].items()
        }
        self._read: dict[SignalNames, Sequence[tuple[Sequence[str], _Definition]]] = {}

    def __call__(self, context: DriveContext, names: SignalNames = None) -> SignalColumns:
        """The words of a drive that have these names.

        An exception in a definition costs a single drive that definition's words. If there are
        several drives it is raised, so that each of them can be made by itself.
        """
        if names not in self._read:
            if len(self._read) >= _MOST_READERS:
                self._read.clear()
            self._read[names] = tuple(
                [
                    (given, signals_of)
                    for given, signals_of in self._definitions.items()
                    if names is None or not names.isdisjoint(given)
                ]
            )
        return together([_contained(*own, context) for own in self._read[names]], names)


def _contained(
    given: Sequence[str], signals_of: _Definition, context: DriveContext
) -> SignalColumns:
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
