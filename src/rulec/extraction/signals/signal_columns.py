"""The signals of a drive as named columns, of the world and of objects."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any, NamedTuple, TypeAlias

import numpy as np
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.diagnostics import RulecError
from rulec.trace.plain_arrays import are_new

SignalColumn = NDArray[Any]
Bounds: TypeAlias = tuple[SignalColumn, SignalColumn]

SignalNames: TypeAlias = frozenset[str] | None
"""The names of the signals that are read; None means all."""


_NONE: Mapping[str, Any] = MappingProxyType({})


class SignalColumns(NamedTuple):
    """The signals of a drive, in arrays with a column per state.

    ``world``: one value per state. ``about``: one row of values per participant, or only the values
    of the ``presence_cells`` one after the other.

    ``unknown``: where a signal has no value, in the shape of its own array. ``only``: the
    participants that a signal about objects applies to. ``bounds``: the least and the greatest
    possible value of a measured number, by the tolerances of its source, in the shape of its own
    array. ``texts``: the texts that a signal's values index. ``whom``: the ids of the participants
    that cause the value of a signal of the world, a tuple per state. ``faults``: the signals that a
    fault of rulec has cost.
    """

    world: Mapping[str, SignalColumn] = _NONE
    about: Mapping[str, SignalColumn] = _NONE
    unknown: Mapping[str, Flags] = _NONE
    only: Mapping[str, Flags] = _NONE
    bounds: Mapping[str, Bounds] = _NONE
    texts: Mapping[str, Sequence[str]] = _NONE
    whom: Mapping[str, SignalColumn] = _NONE
    faults: Mapping[str, RulecError] = _NONE

    def values(self, name: str) -> SignalColumn:
        """The values of a signal, as texts if they are indices of texts."""
        column = self.world[name] if name in self.world else self.about[name]
        return np.array(self.texts[name])[column] if name in self.texts else column

    def __or__(self, other: SignalColumns) -> SignalColumns:
        return together((self, other))


class WorldSignal(NamedTuple):
    """A signal of the world alone, with what ``SignalColumns`` have of it by its name."""

    world: SignalColumn
    unknown: Flags | None = None
    bounds: Bounds | None = None
    texts: Sequence[str] | None = None
    whom: SignalColumn | None = None


class ObjectSignal(NamedTuple):
    """A signal of objects alone, with what ``SignalColumns`` have of it by its name."""

    about: SignalColumn
    unknown: Flags | None = None
    bounds: Bounds | None = None
    texts: Sequence[str] | None = None
    only: Flags | None = None


OneSignal: TypeAlias = WorldSignal | ObjectSignal


def named_signal(name: str, signal: OneSignal) -> SignalColumns:
    """A signal under its name."""
    own = signal._asdict().items()
    return SignalColumns(**{kind: {name: part} for kind, part in own if part is not None})


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
    """The signals of drives with the same participants, end to end; all supply the same names."""

    def joined(kind: str) -> dict[str, Any]:
        columns = [getattr(part, kind) for part in parts]
        names = dict.fromkeys(name for own in columns for name in own)
        return {name: np.concatenate([own[name] for own in columns], axis=-1) for name in names}

    bounds = {name: (low, high) for name, (low, high) in joined("bounds").items()}
    world, about, unknown, whom = map(joined, ("world", "about", "unknown", "whom"))
    only, texts = parts[0].only, parts[0].texts
    return SignalColumns(world, about, unknown, only=only, bounds=bounds, texts=texts, whom=whom)


def known_only(signals: SignalColumns, names: frozenset[str]) -> SignalColumns:
    """The signals with values only for some names, and all others unknown."""
    columns = {**signals.world, **signals.about}
    unknown = {
        name: signals.unknown.get(name, np.zeros(column.shape, dtype=bool))
        if name in names
        else np.ones(column.shape, dtype=bool)
        for name, column in columns.items()
    }
    bounds = {name: ends for name, ends in signals.bounds.items() if name in names}
    return signals._replace(unknown=unknown, bounds=bounds)


def unknown_in(
    signals: SignalColumns, states: Flags, by_cell: Flags, names: frozenset[str]
) -> SignalColumns:
    """The signals, unknown in some states but for some names; ``by_cell``: in presence cells."""

    def masked(name: str, column: SignalColumn) -> Flags:
        flags = states if name in signals.world or column.ndim > 1 else by_cell
        known = signals.unknown.get(name)
        found: Flags = np.broadcast_to(flags, column.shape)
        return found if known is None else known | found

    columns = {**signals.world, **signals.about}
    unknown = {name: masked(name, own) for name, own in columns.items() if name not in names}
    return signals._replace(unknown={**signals.unknown, **unknown})


def unknown_where_unlike(signals: SignalColumns, others: SignalColumns) -> SignalColumns:
    """The signals, unknown where others have another value or none."""
    columns, theirs = {**signals.world, **signals.about}, {**others.world, **others.about}
    unknown = dict(signals.unknown)
    signals = signals._replace(faults={**signals.faults, **others.faults})
    for name, column in columns.items():
        if name not in theirs or theirs[name].shape != column.shape:
            continue
        unlike = column != theirs[name]
        if name in others.unknown:
            unlike = unlike | others.unknown[name]
        if unlike.any():
            unknown[name] = unlike | unknown[name] if name in unknown else unlike
    return signals._replace(unknown=unknown)


def ids_by_state(flags: Flags, ids: Sequence[str]) -> SignalColumn:
    """The ids of the rows that are flagged, a tuple per state."""
    found = nobody(flags.shape[-1])
    if not flags.any():
        return found
    columns = flags.any(axis=0).nonzero()[0]
    places, rows = flags[:, columns].T.nonzero()
    begins = are_new(places).nonzero()[0].tolist()
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
