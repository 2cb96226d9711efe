"""The signals of a drive in the words of a vocabulary, as traces in arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.array_types import Flags
from rulec.extraction.signals.signal_columns import SignalColumn, SignalColumns
from rulec.scenario.paper_words import PAPER_SURFACE
from rulec.trace import Value
from rulec.trace.end_to_end import EndToEnd, UnlikeDrivesError
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


@dataclass(frozen=True, slots=True)
class WrittenSignals:
    """Signals in columns; values that are texts are stored as indices into their ``texts``."""

    columns: SignalColumns
    texts: Mapping[str, tuple[str, ...]] = field(default_factory=dict)

    def kinds(self) -> dict[str, type]:
        """The Python types of the signals' values."""
        columns = {**self.columns.world, **self.columns.about}
        return {
            name: str if name in self.texts else _KINDS[column.dtype.kind]
            for name, column in columns.items()
        }


def written(
    signals: SignalColumns,
    types: Sequence[Sequence[str]],
    vocabulary: Vocabulary | None,
    names: frozenset[str] | None,
    spans: EndToEnd,
) -> WrittenSignals:
    """The signals that a vocabulary declares, optionally only those in ``names``.

    ``types`` are the objects' types, one row per object, the most specific first. Raises
    UnlikeDrivesError if the drives do not all supply the same signals.
    """
    if vocabulary is None:
        return _all(signals)
    # Many objects share few types
    known = {own: known_type(own, vocabulary) for own in {tuple(row) for row in types}}
    own_types = [known[tuple(row)] for row in types]
    suits_of: dict[tuple[str, ...], Flags] = {}
    world, about, only = {}, {}, dict(signals.only)
    texts: dict[str, tuple[str, ...]] = {}
    for name, declaration in vocabulary.declarations.items():
        if names is not None and name not in names:
            continue
        if name in signals.world and not declaration.parameters:
            column = _in_paper_words(name, signals.world[name], declaration)
            numbers = _numbers(name, column, signals, declaration, spans)
            if numbers is not None:
                world[name] = numbers
        if name in signals.about and len(declaration.parameters) == 1:
            numbers = _numbers(name, signals.about[name], signals, declaration, spans)
            if numbers is not None:
                about[name] = numbers
                suits = suits_of.get(declaration.parameters)
                if suits is None:
                    fit = {own: is_about(declaration, own, vocabulary) for own in set(own_types)}
                    suits = np.array([fit[own] for own in own_types], dtype=bool)
                    suits_of[declaration.parameters] = suits
                only[name] = suits & only[name] if name in only else suits
        if isinstance(declaration, Enumeration) and (name in world or name in about):
            texts[name] = declaration.values
    return WrittenSignals(signals._replace(world=world, about=about, only=only), texts)


def _all(signals: SignalColumns) -> WrittenSignals:
    texts: dict[str, tuple[str, ...]] = {}

    def numbers(name: str) -> SignalColumn:
        column = signals.values(name)
        if column.dtype.kind != "U":
            return column
        found, places = np.unique(column, return_inverse=True)
        texts[name] = tuple(found.tolist())
        return places.reshape(column.shape)

    world, about = (
        {name: numbers(name) for name in columns} for columns in (signals.world, signals.about)
    )
    return WrittenSignals(signals._replace(world=world, about=about), texts)


def _numbers(
    name: str,
    column: SignalColumn,
    signals: SignalColumns,
    declaration: Declaration,
    spans: EndToEnd,
) -> SignalColumn | None:
    """A column, with texts as indices into the declared values; None if some value does not fit."""
    texts = signals.texts.get(name)
    if isinstance(declaration, Signal) and texts is None and column.dtype == bool:
        return column
    if not isinstance(declaration, Enumeration) or (texts is None and column.dtype.kind != "U"):
        # All values that are not texts have the same type
        fit = texts is None and fits(name, column.flat[:1].tolist(), declaration)
        return column if fit else None
    n_values = len(declaration.values)
    dtype = smallest_unsigned(n_values + 1)
    if texts is not None and tuple(texts) == declaration.values:
        return column.astype(dtype, copy=False)
    if texts is None:
        places = _places_of_texts(column, declaration.values).astype(dtype)
    else:
        known = {value: place for place, value in enumerate(declaration.values)}
        table = np.array([known.get(text, n_values) for text in texts], dtype=dtype)
        places = table.take(column)
    strange = places == n_values
    if strange.any():
        unknown = signals.unknown.get(name, np.zeros_like(strange))
        if spans.n_drives > 1 and strange.ndim > 1:
            raise UnlikeDrivesError  # perhaps: objects far away in a drive have no values in it
        told = [_is_told(strange[..., own], unknown[..., own]) for own in spans.slices]
        if not spans.agreed(told):
            return None
        places[strange] = 0
    return places


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


def _in_paper_words(name: str, column: SignalColumn, declaration: Declaration) -> SignalColumn:
    """Surfaces in the paper's two words, for vocabularies that declare only these."""
    if name != "surface" or not isinstance(declaration, Enumeration):
        return column
    if not set(PAPER_SURFACE.values()).issuperset(declaration.values):
        return column
    return np.array([PAPER_SURFACE.get(surface, "R_cw") for surface in column.tolist()])


def with_assumed(
    signals: WrittenSignals, assumed: Mapping[str, Value], states: int
) -> WrittenSignals:
    """The signals with the assumed values in every state, whatever the recording contains."""
    if not assumed:
        return signals
    columns = signals.columns
    texts = {name: own for name, own in signals.texts.items() if name not in assumed}
    texts |= {name: (value,) for name, value in assumed.items() if isinstance(value, str)}
    values = {
        name: np.full(states, 0 if isinstance(value, str) else value)
        for name, value in assumed.items()
    }
    known = columns._replace(
        world={**columns.world, **values},
        unknown={name: own for name, own in columns.unknown.items() if name not in assumed},
        bounds={name: own for name, own in columns.bounds.items() if name not in assumed},
        faults={name: own for name, own in columns.faults.items() if name not in assumed},
    )
    return WrittenSignals(known, texts)


def with_likeliest(signals: WrittenSignals, vocabulary: Vocabulary) -> WrittenSignals:
    """The signals with measured values in place of unknown ones that have no default."""
    declared = vocabulary.declarations
    unknown = {
        name: own
        for name, own in signals.columns.unknown.items()
        if name not in declared or declared[name].default is not None
    }
    return replace(signals, columns=signals.columns._replace(unknown=unknown))


def signal_parts(
    signals: WrittenSignals, present: WrittenPresences, spans: EndToEnd, *, defaults: bool
) -> list[dict[str, Any]]:
    """The arguments for traces in arrays that depend on signals, one mapping per drive.

    With ``defaults`` unknown values are left out, and numbers are as measured.
    """
    columns, ranges = signals.columns, present.ranges
    lengths = ranges[:, 1] - ranges[:, 0] + 1
    bounds = np.append(0, lengths.cumsum())[np.array(present.bounds)].tolist()
    never = np.zeros(len(present.cells), dtype=bool)

    def gathered(name: str, column: SignalColumn) -> SignalColumn:
        """A signal's values end to end: of the world, or of the objects present."""
        if name in columns.world:
            return column
        if column.ndim == 1:
            return column if present.kept is None else column.take(present.kept)
        # Many signals are true of no object: checking this is faster than gathering values
        is_never = column.dtype == bool and not np.count_nonzero(column)
        return never if is_never else column.take(present.cells)

    world = {name: gathered(name, own) for name, own in columns.world.items()}
    about = {name: gathered(name, own) for name, own in columns.about.items()}
    names = world.keys() | about.keys()
    unknown = {x: gathered(x, own) for x, own in columns.unknown.items() if x in names}
    intervals = {
        x: (gathered(x, low), gathered(x, high))
        for x, (low, high) in columns.bounds.items()
        if x in names
    }
    only = {name: flags[present.rows] for name, flags in columns.only.items() if name in about}
    about_names = frozenset(name for name in names if name not in columns.world)
    nothing: dict[str, SignalColumn] = {}
    is_one, states_of = spans.n_drives == 1, spans.slices
    cells_of = list(map(slice, bounds[:-1], bounds[1:]))

    def part(values: Mapping[str, Any], k: int) -> Mapping[str, Any]:
        return values if is_one else SharedColumns(values, about_names, states_of[k], cells_of[k])

    own_objects = list(map(slice, present.bounds[:-1], present.bounds[1:]))
    return [
        {
            "spans": ranges[own],
            "world": part(world, k),
            "about": part(about, k),
            "texts": signals.texts,
            "unknown": nothing if defaults else part(unknown, k),
            "absent": part(unknown, k) if defaults else nothing,
            "bounds": {} if defaults else part(intervals, k),
            "only": only if is_one else SharedColumns(only, about_names, own, own),
            "faults": columns.faults,
        }
        for k, own in enumerate(own_objects)
    ]
