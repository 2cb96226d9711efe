"""The signals of a drive in the words of a vocabulary, as traces in arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.signals.signal_columns import (
    Measured,
    SignalColumn,
    SignalColumns,
    SignalValues,
    column_of,
    signal_values,
    unknown_flags,
)
from rulec.scenario.paper_words import PAPER_SURFACE
from rulec.trace import Value
from rulec.trace.end_to_end import EndToEnd, UnlikeDrivesError
from rulec.trace.partly_known.partly_known_values import Truth
from rulec.trace.shared_columns import SharedColumns
from rulec.trace.trace_columns import smallest_unsigned
from rulec.trace.vocabulary_projection import fits, is_about, known_type
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary

_KINDS: Mapping[str, type] = {"b": bool, "f": float, "i": float, "u": float}


@dataclass(frozen=True, eq=False, slots=True)
class WrittenPresences:
    """The presences that traces contain, ordered by drive.

    ``bounds`` are the numbers at which those of each drive begin, and the end of the last. Each
    presence has a row, and its first and last state in its drive as ``ranges``. ``cells`` are the
    flat indices of all their cells in arrays with a row per participant; ``kept`` are their numbers
    among the ``presence_cells``, None for all.
    """

    bounds: Sequence[int]
    rows: NDArray[intp]
    ranges: NDArray[intp]
    cells: NDArray[intp]
    kept: NDArray[intp] | None


_Texts = Mapping[str, tuple[str, ...]]
"""The texts that a signal's written values index."""


def kinds_of(signals: SignalColumns, texts: _Texts) -> dict[str, type]:
    """The Python types of written signals' values."""
    return {
        name: str if name in texts else _KINDS[column_of(values).dtype.kind]
        for name, values in {**signals.world, **signals.about}.items()
    }


def written(
    signals: SignalColumns,
    types: Sequence[Sequence[str]],
    vocabulary: Vocabulary | None,
    names: frozenset[str] | None,
    spans: EndToEnd,
) -> tuple[SignalColumns, _Texts]:
    """The signals that a vocabulary declares, optionally only those in ``names``, and their texts.

    ``types`` are the objects' types, one row per object, the most specific first. Raises
    UnlikeDrivesError if the drives do not all supply the same signals.
    """
    if vocabulary is None:
        return _all(signals)
    # Many objects share few types
    known = {own: known_type(own, vocabulary) for own in {tuple(row) for row in types}}
    own_types = [known[tuple(row)] for row in types]
    suits_of: dict[tuple[str, ...], Flags] = {}
    world: dict[str, SignalValues] = {}
    about: dict[str, SignalValues] = {}
    only, texts = dict(signals.only), dict[str, tuple[str, ...]]()
    for name, declaration in vocabulary.declarations.items():
        if names is not None and name not in names:
            continue
        if name in signals.world and not declaration.parameters:
            values = _in_paper_words(name, signals.world[name], declaration)
            places = _in_places(name, values, declaration, spans)
            if places is not None:
                world[name] = places
        if name in signals.about and len(declaration.parameters) == 1:
            places = _in_places(name, signals.about[name], declaration, spans)
            if places is not None:
                about[name] = places
                suits = suits_of.get(declaration.parameters)
                if suits is None:
                    fit = {own: is_about(declaration, own, vocabulary) for own in set(own_types)}
                    suits = np.array([fit[own] for own in own_types], dtype=bool)
                    suits_of[declaration.parameters] = suits
                only[name] = suits & only[name] if name in only else suits
        if isinstance(declaration, Enumeration) and (name in world or name in about):
            texts[name] = declaration.values
    return signals._replace(world=world, about=about, only=only), texts


def _all(signals: SignalColumns) -> tuple[SignalColumns, _Texts]:
    texts: dict[str, tuple[str, ...]] = {}

    def in_places(name: str, values: SignalValues) -> SignalValues:
        if isinstance(values, Truth):
            return values
        column = values.values
        if values.texts is not None:
            column = np.array(values.texts)[column]
        if column.dtype.kind != "U":
            return values
        found, places = np.unique(column, return_inverse=True)
        texts[name] = tuple(found.tolist())
        return Measured(places.reshape(column.shape), values.unknown)

    return signals.each(in_places), texts


def _in_places(
    name: str, values: SignalValues, declaration: Declaration, spans: EndToEnd
) -> SignalValues | None:
    """Values with texts as indices into the declared ones; None if some value does not fit."""
    if isinstance(values, Truth):
        return values if isinstance(declaration, Signal) else None
    column, texts = values.values, values.texts
    if not isinstance(declaration, Enumeration) or (texts is None and column.dtype.kind != "U"):
        # All values that are not texts have the same type
        fit = texts is None and fits(name, column.flat[:1].tolist(), declaration)
        return values if fit else None
    n_values = len(declaration.values)
    dtype = smallest_unsigned(n_values + 1)
    if texts is not None and tuple(texts) == declaration.values:
        return replace(values, values=column.astype(dtype, copy=False))
    if texts is None:
        places = _places_of_texts(column, declaration.values).astype(dtype)
    else:
        known = {value: place for place, value in enumerate(declaration.values)}
        table = np.array([known.get(text, n_values) for text in texts], dtype=dtype)
        places = table.take(column)
    strange = places == n_values
    if strange.any():
        unknown = np.zeros_like(strange) if values.unknown is None else values.unknown
        if spans.n_drives > 1 and strange.ndim > 1:
            raise UnlikeDrivesError  # perhaps: objects far away in a drive have no values in it
        told = [_is_told(strange[..., own], unknown[..., own]) for own in spans.slices]
        if not spans.agreed(told):
            return None
        places[strange] = 0
    return replace(values, values=places)


def _places_of_texts(column: SignalColumn, values: Sequence[str]) -> NDArray[intp]:
    """The indices of texts among ``values``; their number for any other text."""
    every = column.ravel()
    if not len(every):
        return np.zeros(column.shape, dtype=intp)
    # Texts seldom change, and comparing them is slow
    changes = (every[1:] != every[:-1]).nonzero()[0] + 1
    edges = np.concatenate(((0,), changes, (len(every),)))
    known = {value: place for place, value in enumerate(values)}
    own = [known.get(text, len(values)) for text in every[edges[:-1]].tolist()]
    return np.array(own, dtype=intp).repeat(edges[1:] - edges[:-1]).reshape(column.shape)


def _is_told(strange: Flags, unknown: Flags) -> bool:
    """Whether no value is strange, or only some unknown ones are while others are known."""
    return not strange.any() or not (unknown.all() or (strange & ~unknown).any())


def _in_paper_words(name: str, values: SignalValues, declaration: Declaration) -> SignalValues:
    """Surfaces in the paper's two words, for vocabularies that declare only these."""
    if name != "surface" or not isinstance(declaration, Enumeration):
        return values
    if not set(PAPER_SURFACE.values()).issuperset(declaration.values):
        return values
    assert isinstance(values, Measured)
    words = [PAPER_SURFACE.get(surface, "R_cw") for surface in values.values.tolist()]
    return replace(values, values=np.array(words))


def with_assumed(
    signals: SignalColumns, texts: _Texts, assumed: Mapping[str, Value], states: int
) -> tuple[SignalColumns, _Texts]:
    """The signals with the assumed values in every state, whatever the recording contains."""
    if not assumed:
        return signals, texts
    texts = {name: own for name, own in texts.items() if name not in assumed}
    texts |= {name: (value,) for name, value in assumed.items() if isinstance(value, str)}
    values = {
        name: signal_values(np.full(states, 0 if isinstance(value, str) else value))
        for name, value in assumed.items()
    }
    faults = {name: own for name, own in signals.faults.items() if name not in assumed}
    return signals._replace(world={**signals.world, **values}, faults=faults), texts


def with_likeliest(signals: SignalColumns, vocabulary: Vocabulary) -> SignalColumns:
    """The signals with measured values in place of unknown ones that have no default."""
    declared = vocabulary.declarations

    def likeliest(name: str, values: SignalValues) -> SignalValues:
        if name not in declared or declared[name].default is not None:
            return values
        return (
            Truth.known(values.sure) if isinstance(values, Truth) else replace(values, unknown=None)
        )

    return signals.each(likeliest)


def signal_parts(
    columns: SignalColumns,
    texts: _Texts,
    present: WrittenPresences,
    spans: EndToEnd,
    *,
    defaults: bool,
) -> list[dict[str, Any]]:
    """The arguments for traces in arrays that depend on signals, one mapping per drive.

    With ``defaults`` unknown values are left out, and numbers are as measured.
    """
    ranges = present.ranges
    lengths = ranges[:, 1] - ranges[:, 0] + 1
    bounds = np.append(0, lengths.cumsum())[np.array(present.bounds)].tolist()
    never = np.zeros(len(present.cells), dtype=bool)

    def gathered(column: SignalColumn) -> SignalColumn:
        """The values of the objects present, end to end."""
        if column.ndim == 1:
            return column if present.kept is None else column.take(present.kept)
        # Many signals are true of no object: checking this is faster than gathering values
        is_never = column.dtype == bool and not np.count_nonzero(column)
        return never if is_never else column.take(present.cells)

    about = {name: values.each(gathered) for name, values in columns.about.items()}
    every: dict[str, SignalValues] = {**about, **columns.world}
    unknown = {x: flags for x, own in every.items() if (flags := unknown_flags(own)) is not None}
    intervals = {
        name: own.bounds
        for name, own in every.items()
        if isinstance(own, Measured) and own.bounds is not None
    }
    only = {name: flags[present.rows] for name, flags in columns.only.items() if name in about}
    about_names = frozenset(every.keys() - columns.world.keys())
    nothing: dict[str, SignalColumn] = {}
    is_one, states_of = spans.n_drives == 1, spans.slices
    cells_of = list(map(slice, bounds[:-1], bounds[1:]))

    def part(values: Mapping[str, Any], k: int) -> Mapping[str, Any]:
        return values if is_one else SharedColumns(values, about_names, states_of[k], cells_of[k])

    world, of_objects = (
        {name: column_of(values) for name, values in own.items()} for own in (columns.world, about)
    )
    own_objects = list(map(slice, present.bounds[:-1], present.bounds[1:]))
    return [
        {
            "spans": ranges[own],
            "world": part(world, k),
            "about": part(of_objects, k),
            "texts": texts,
            "unknown": nothing if defaults else part(unknown, k),
            "absent": part(unknown, k) if defaults else nothing,
            "bounds": {} if defaults else part(intervals, k),
            "only": only if is_one else SharedColumns(only, about_names, own, own),
            "faults": columns.faults,
        }
        for k, own in enumerate(own_objects)
    ]
