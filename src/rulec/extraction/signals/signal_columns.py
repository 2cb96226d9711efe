"""The signals of a drive as named columns, of the world and of objects."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.diagnostics import RulecError
from rulec.trace.partly_known.partly_known_values import Truth

SignalColumn = NDArray[Any]
Bounds: TypeAlias = tuple[SignalColumn, SignalColumn]

SignalNames: TypeAlias = frozenset[str] | None
"""The names of the signals that are read; None means all."""


@dataclass(frozen=True, eq=False, slots=True)
class Measured:
    """Numbers or texts as they were measured.

    ``unknown``: where there is no value. ``bounds``: the least and the greatest possible number, by
    the tolerances of its source. ``texts``: the texts that values index. All arrays have one shape.
    """

    values: SignalColumn
    unknown: Flags | None = None
    bounds: Bounds | None = None
    texts: Sequence[str] | None = None

    def each(self, change: Callable[[SignalColumn], SignalColumn]) -> Measured:
        """The same with all arrays changed."""
        unknown, bounds = self.unknown, self.bounds
        return Measured(
            change(self.values),
            None if unknown is None else change(unknown),
            None if bounds is None else (change(bounds[0]), change(bounds[1])),
            self.texts,
        )

    def unknown_at(self, unknown: Flags) -> Measured:
        """The same values, but unknown where ``unknown``, too."""
        known = self.unknown
        return replace(self, unknown=unknown if known is None else known | unknown)


SignalValues: TypeAlias = Truth | Measured
"""What a signal is: whether something holds, or a number or a text, wherever that is known."""


def signal_values(values: SignalValues | SignalColumn) -> SignalValues:
    """Values that are known everywhere, if given as an array."""
    if not isinstance(values, np.ndarray):
        return values
    return Truth.known(values) if values.dtype == bool else Measured(values)


def unknown_flags(values: SignalValues) -> Flags | None:
    """Where values are unknown; None if nowhere, by their making."""
    if isinstance(values, Measured):
        return values.unknown
    return None if values.is_known else values.unknown


def column_of(values: SignalValues) -> SignalColumn:
    """The values as one array, with any value where they are unknown."""
    return values.values if isinstance(values, Measured) else values.sure


_NONE: Mapping[str, Any] = MappingProxyType({})


class SignalColumns(NamedTuple):
    """The signals of a drive, in arrays with a column per state.

    ``world``: one value per state. ``about``: one row of values per participant, or only the values
    of the ``presence_cells`` one after the other.

    ``only``: the participants that a signal about objects applies to. ``whom``: the ids of the
    participants that cause the value of a signal of the world, a tuple per state. ``faults``: the
    signals that a fault of rulec has cost.
    """

    world: Mapping[str, SignalValues] = _NONE
    about: Mapping[str, SignalValues] = _NONE
    only: Mapping[str, Flags] = _NONE
    whom: Mapping[str, SignalColumn] = _NONE
    faults: Mapping[str, RulecError] = _NONE

    def __or__(self, other: SignalColumns) -> SignalColumns:
        return together((self, other))

    def each(self, change: Callable[[str, SignalValues], SignalValues]) -> SignalColumns:
        """The signals with changed values, by their names."""
        world, about = (
            {name: change(name, values) for name, values in signals.items()}
            for signals in (self.world, self.about)
        )
        return self._replace(world=world, about=about)


def world_signals(**signals: SignalValues | SignalColumn) -> SignalColumns:
    """Signals of the world by their names."""
    return SignalColumns({name: signal_values(values) for name, values in signals.items()})


class Caused(NamedTuple):
    """The values of a signal of the world, and ``whom`` as in ``SignalColumns``."""

    values: Truth
    whom: SignalColumn


class OfObjects(NamedTuple):
    """The values of a signal about objects, and ``only`` as in ``SignalColumns``."""

    values: SignalValues | SignalColumn
    only: Flags | None = None


OneSignal: TypeAlias = SignalValues | SignalColumn | Caused | OfObjects


def named_signal(name: str, signal: OneSignal) -> SignalColumns:
    """A signal under its name."""
    if isinstance(signal, Caused):
        return SignalColumns({name: signal.values}, whom={name: signal.whom})
    if isinstance(signal, OfObjects):
        only = _NONE if signal.only is None else {name: signal.only}
        return SignalColumns(about={name: signal_values(signal.values)}, only=only)
    return SignalColumns({name: signal_values(signal)})


def together(parts: Sequence[SignalColumns], names: SignalNames = None) -> SignalColumns:
    """The signals of all parts, optionally only those with some names."""
    kinds: list[dict[str, Any]] = []
    for of_kind in zip(*parts, strict=True):
        found: dict[str, Any] = {}
        for columns in filter(None, of_kind):
            found.update(columns)
        if names is not None and not names.issuperset(found):
            for name in found.keys() - names:
                del found[name]
        kinds.append(found)
    return SignalColumns(*kinds)


def end_to_end(parts: Sequence[SignalColumns]) -> SignalColumns:
    """The signals of drives with the same participants, end to end; all supply the same names.

    No part has numbers with bounds.
    """

    def joined(kind: str) -> dict[str, Any]:
        return {
            name: _laid_end_to_end([getattr(part, kind)[name] for part in parts])
            for name in getattr(parts[0], kind)
        }

    world, about, whom = map(joined, ("world", "about", "whom"))
    return SignalColumns(world, about, only=parts[0].only, whom=whom)


def _laid_end_to_end(parts: Sequence[Any]) -> Any:
    first, join = parts[0], partial(np.concatenate, axis=-1)
    if isinstance(first, Truth):
        if all(part.is_known for part in parts):
            return Truth.known(join([part.sure for part in parts]))
        return Truth(*(join([getattr(part, half) for part in parts]) for half in _HALVES))
    if isinstance(first, Measured):
        values = join([part.values for part in parts])
        flags = [np.zeros(x.values.shape, bool) if x.unknown is None else x.unknown for x in parts]
        return Measured(values, join(flags), texts=first.texts)
    return join(parts)


_HALVES = ("sure", "possible")


def known_only(signals: SignalColumns, names: frozenset[str]) -> SignalColumns:
    """The signals with values only for some names, and all others unknown."""

    def known(name: str, values: SignalValues) -> SignalValues:
        if name in names:
            return values
        if isinstance(values, Measured):
            values = replace(values, bounds=None)
        return values.unknown_at(np.ones(column_of(values).shape, dtype=bool))

    return signals.each(known)


def unknown_in(
    signals: SignalColumns, states: Flags, by_cell: Flags, names: frozenset[str]
) -> SignalColumns:
    """The signals, unknown in some states but for some names; ``by_cell``: in presence cells."""

    def masked(name: str, values: SignalValues) -> SignalValues:
        if name in names:
            return values
        column = column_of(values)
        flags = states if name in signals.world or column.ndim > 1 else by_cell
        return values.unknown_at(np.broadcast_to(flags, column.shape))

    return signals.each(masked)


def unknown_where_unlike(signals: SignalColumns, others: SignalColumns) -> SignalColumns:
    """The signals, unknown where others have another value or none."""
    theirs = {**others.world, **others.about}

    def alike(name: str, values: SignalValues) -> SignalValues:
        other = theirs.get(name)
        if other is None or column_of(other).shape != column_of(values).shape:
            return values
        if isinstance(values, Truth) and isinstance(other, Truth):
            return Truth(values.sure & other.sure, values.possible | other.possible)
        unlike = column_of(values) != column_of(other)
        lacks = unknown_flags(other)
        return values.unknown_at(unlike if lacks is None else unlike | lacks)

    return signals.each(alike)._replace(faults={**signals.faults, **others.faults})


def ids_by_state(flags: Flags, ids: Sequence[str]) -> SignalColumn:
    """The ids of the rows that are flagged, a tuple per state."""
    found = nobody(flags.shape[-1])
    if not flags.any():
        return found
    columns = flags.any(axis=0).nonzero()[0]
    places, rows = flags[:, columns].T.nonzero()
    begins = np.unique(places, return_index=True)[1].tolist()
    names = [ids[row] for row in rows.tolist()]
    for state, begin, end in zip(columns.tolist(), begins, [*begins, len(names)][1:], strict=True):
        found[state] = tuple(names[begin:end])
    return found


def nobody(states: int) -> SignalColumn:
    """No ids in any state."""
    none = np.empty(states, dtype=object)
    none.fill(())
    return none


def rounded(values: SignalColumn) -> SignalColumn:
    """Round numbers to a hundredth, their greatest accuracy, without negative zeros."""
    found: SignalColumn = values.round(2)
    found += 0.0
    return found


def rounded_outward(low: SignalColumn, high: SignalColumn) -> Bounds:
    """Round bounds to a hundredth, outward, so that they still enclose the same values."""
    least, most = low * 100, high * 100
    for ends, hair, rounds in ((least, _HAIR, np.floor), (most, -_HAIR, np.ceil)):
        ends += hair
        rounds(ends, out=ends)
        ends /= 100
        # Without negative zeros
        ends += 0.0
    return least, most


_HAIR = 1e-6
