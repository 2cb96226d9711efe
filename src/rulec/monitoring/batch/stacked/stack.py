"""The columns of traces in arrays laid end to end: what is told, and what follows from it."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from functools import cached_property
from math import isfinite
from typing import Any

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.automata.thresholds import EXACT_IN_FLOATS, exact_step
from rulec.logic.bounds import in_steps
from rulec.monitoring.batch.columns.encoded_columns import (
    PartlyKnown,
    UnencodableError,
    column_dtype,
    either,
    encode_values,
)
from rulec.monitoring.batch.joined.joined_traces import JoinedTraces
from rulec.monitoring.batch.joined.meant_columns import meant
from rulec.monitoring.batch.joined.object_pairs import ObjectPairs
from rulec.monitoring.batch.joined.trace_places import TracePlaces
from rulec.trace.partly_known.column_values import partly_known
from rulec.trace.partly_known.partly_known_values import NameValues
from rulec.trace.partly_known.temporal_operators import Beyond
from rulec.trace.trace_columns import Array
from rulec.vocabulary import Declaration, Enumeration, Signal, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN
from rulec.vocabulary.vocabulary_model import least_value

_NOWHERE = np.zeros(0, dtype=bool)


class Stack(TracePlaces):
    """Traces with the same names, end to end; ``vocabulary`` has the defaults of other names.

    ``defaults`` caches these, encoded as in columns, for all traces judged with the vocabulary;
    ``meant`` are the words that their meanings give in these traces.
    ``arity`` is the number of objects that each name in the traces is about.
    """

    def __init__(
        self,
        traces: JoinedTraces,
        vocabulary: Vocabulary,
        meant: Sequence[str],
        defaults: dict[str, Any],
    ) -> None:
        super().__init__(traces.lengths, traces.n_objects, traces.spans, traces.types, vocabulary)
        self._defaults = defaults
        self._pieces = traces.pieces
        piece = traces.pieces[0]
        parts = piece.world, piece.about, piece.between
        self.arity = {name: n for n, part in enumerate(parts) for name in part}
        self._kind = traces.kind
        self._meant = meant
        for name in meant:
            self.arity.setdefault(name, len(vocabulary.declarations[name].parameters))
        self._columns: dict[str, PartlyKnown] = {}
        self._ends: dict[str, tuple[float, float]] = {}

    def untold(self, names: Iterable[str]) -> set[str]:
        """The names among these whose values cannot be read from arrays.

        Raises UnencodableError.
        """
        declarations, columns = self.vocabulary.declarations, self.columns
        untold = {x for x in names if x not in columns and declarations[x].default is None}
        for name in self.vocabulary.constants:
            apart = columns[name].apart if name in columns else None
            if apart is not None and apart.any():
                untold.add(name)
        return untold

    def odd_traces(self) -> set[int]:
        """Traces with a missing value or a constant that changes. Raises UnencodableError."""
        odd: set[int] = set()
        constants = self.vocabulary.constants
        for name, column in self.columns.items():
            if column.missing is not None:
                odd.update(self.traces_at(name, column.missing.nonzero()[0]))
            if name in constants:
                starts = (self.begins, self.starts, self.pairs.starts)[self.arity[name]]
                lengths = starts[1:] - starts[:-1]
                for own in (column.values, column.unknown):
                    if own is not None:
                        values = own[: starts[-1]]
                        changed = values != values[starts[:-1]].repeat(lengths)
                        if changed.any():
                            odd.update(self.traces_at(name, changed.nonzero()[0]))
        return odd

    def partial_traces(self) -> set[int]:
        """Traces in which a value is unknown or an interval. Raises UnencodableError."""
        doubts = ((name, own.partial) for name, own in self.columns.items())
        known = ((name, flags) for name, flags in doubts if flags is not None)
        return {x for name, flags in known for x in self.traces_at(name, flags.nonzero()[0])}

    def traces_at(self, name: str, places: Indices) -> list[int]:
        """The traces of a name's values at some places."""
        places = self.states_at(name, places)
        traces: list[int] = np.unique(self.begins.searchsorted(places, side="right") - 1).tolist()
        return traces

    def states_at(self, name: str, places: Indices) -> Indices:
        """The states of a name's values at some places."""
        if self.arity[name] < 2:
            return self.state_of[places] if self.arity[name] else places
        states: Indices = self.pairs.state_of[places[places < self.pairs.starts[-1]]]
        return states

    @cached_property
    def pairs(self) -> ObjectPairs:
        """The pairs of objects that something is said about."""
        return self.pairs_of(self._pieces[0].pairs)

    def column(self, name: str) -> PartlyKnown | None:
        """The column of a name; None if no state contains it. Raises UnencodableError."""
        if name not in self.arity:
            return None
        if name not in self._columns:
            is_meant = name in self._meant
            self._columns[name] = self._meant_column(name) if is_meant else self._column(name)
        return self._columns[name]

    def _meant_column(self, name: str) -> PartlyKnown:
        """The column of a word, by its meaning where no state tells it."""
        own = self.vocabulary.meanings[name]
        formula = in_steps(own.formula, exact_step(self._kind.step_s))
        beyond: Beyond = "cut" if self._kind.ends == "cut" else "over"
        meaning = meant(own.variables, formula, self, self.named, beyond)
        is_about = np.ones(len(meaning.sure), dtype=bool)
        for kind in self.vocabulary.declarations[name].parameters:
            is_about = self.of_type(kind)[self.object_of]
        sure, possible = meaning.sure & is_about, meaning.possible & is_about
        if self._is_told(name):
            told = self._column(name)
            untold = told.missing
            if untold is None:
                return told
            unknown = np.zeros(len(sure), dtype=bool) if told.unknown is None else told.unknown
            sure = np.where(untold, sure, told.values & ~unknown)
            possible = np.where(untold, possible, told.values | unknown)
        unknown = possible & ~sure
        return PartlyKnown(sure, unknown=unknown if unknown.any() else None)

    def _is_told(self, name: str) -> bool:
        piece = self._pieces[0]
        return any(name in part for part in (piece.world, piece.about, piece.between))

    def named(self, name: str, at: Indices | None = None) -> NameValues:
        """A name's values ``at`` places, or at all of its places; its default if none is given.

        Raises UnencodableError.
        """
        declaration, column = self.vocabulary.declarations[name], self.column(name)
        if column is None:
            default, n_places = self.default(name), self.n_states
            if declaration.parameters:
                n_places = int(self.starts[-1])
            is_known = default is not None and default is not UNKNOWN
            shape = n_places if at is None else at.shape
            values = np.full(shape, default if is_known else _anything(declaration))
            unknown = None if is_known else np.ones(shape, dtype=bool)
            return partly_known(declaration, values, values, unknown)
        column = column if at is None else column.at(at)
        values, upper = column.values, column.upper
        unknown = either(column.unknown, column.missing)
        # One array for both ends says that they are equal
        return partly_known(declaration, values, values if upper is None else upper, unknown)

    @cached_property
    def columns(self) -> Mapping[str, PartlyKnown]:
        """The columns of all names in the traces. Raises UnencodableError."""
        if len(self._pieces) == 1:
            self._columns |= self._whole_signals()
        for name in self.arity:
            self.column(name)
        return self._columns

    def _whole_signals(self) -> dict[str, PartlyKnown]:
        """The signals of the only piece that are known in all states, of all objects."""
        (piece,), declarations = self._pieces, self.vocabulary.declarations
        others = set().union(*self._flagged, self._partly, piece.texts)
        return {
            name: PartlyKnown(values)
            for arity, part in enumerate((piece.world, piece.about))
            for name, values in part.items()
            if name not in others
            and values.dtype == bool
            and isinstance(own := declarations.get(name), Signal)
            and len(own.parameters) == arity
            and all(map(self.all_are, own.parameters))
        }

    def ends(self, name: str) -> tuple[float, float] | None:
        """The least and greatest number of a quantity; None if some are unknown or none is given.

        Raises UnencodableError.
        """
        column = self.column(name)
        if column is None or column.unknown is not None or not len(column.values):
            return None
        if name not in self._ends:
            self._ends[name] = _ends(column.values, column.upper)
        return self._ends[name]

    @cached_property
    def _flagged(self) -> tuple[set[str], set[str]]:
        """The names with an unknown value, and those with an absent one, in the only piece."""
        (piece,) = self._pieces
        # Bytes are looked at faster than arrays, however short
        dark, absent = (
            {name for name, own in flags.items() if 1 in own.tobytes()}
            for flags in (piece.unknown, piece.absent)
        )
        return dark, absent

    @cached_property
    def _partly(self) -> set[str]:
        """The names that are given for some objects only, in the only piece."""
        (piece,) = self._pieces
        return {name for name, own in piece.only.items() if 0 in own.tobytes()}

    def default(self, name: str) -> Any:
        """The default of a name, encoded as in columns; None if it has none."""
        if name not in self._defaults:
            declaration = self.vocabulary.declarations[name]
            default: Any = declaration.default
            if default is not None and default is not UNKNOWN:
                default = encode_values([default], declaration)[0]
            self._defaults[name] = default
        return self._defaults[name]

    def _column(self, name: str) -> PartlyKnown:
        declaration = self.vocabulary.declarations.get(name)
        arity = self.arity[name]
        if declaration is None or len(declaration.parameters) != arity:
            raise UnencodableError
        parts = [(piece.world, piece.about, piece.between)[arity][name] for piece in self._pieces]
        unknown, unsaid = self._unknown_and_unsaid(name, parts)
        if arity == 1:
            unsaid = either(unsaid, self._not_about(name, declaration))
        upper = None
        if isinstance(declaration, Enumeration):
            values = self._places(name, declaration, parts)
            is_fit = not len(values) or np.maximum.reduce(values) < len(declaration.values)
            unfit = _NOWHERE if is_fit else values >= len(declaration.values)
        elif isinstance(declaration, Signal):
            values = _end_to_end(parts)
            if values.dtype != bool or any(name in piece.texts for piece in self._pieces):
                raise UnencodableError
            unfit = _NOWHERE
        else:
            values, upper = self._numbers(name, parts)
            unfit = _NOWHERE
            ends = _ends(values, upper)
            if not all(map(isfinite, ends)) or (upper is not None and (values > upper).any()):
                unfit = ~np.isfinite(values)
                if upper is not None:
                    unfit |= ~(values <= upper) | ~np.isfinite(upper)
            elif unsaid is None and len(values):
                self._ends[name] = ends
        if unfit is not _NOWHERE and unfit.any():
            nowhere = either(unknown, unsaid)
            if nowhere is None or (unfit & ~nowhere).any():
                raise UnencodableError
            values = np.where(unfit, _anything(declaration), values)
            upper = None if upper is None else np.where(unfit, values, upper)
        column = PartlyKnown(values, upper, unknown)
        column = column if unsaid is None else self._with_default(name, column, unsaid)
        return column if arity < 2 else self._with_strangers(name, column)

    def _with_strangers(self, name: str, column: PartlyKnown) -> PartlyKnown:
        """The column about pairs, with a last value for all pairs of which nothing is said."""
        default, unknown, upper = self.default(name), column.unknown, column.upper
        is_dark = default is UNKNOWN
        if default is None or is_dark:
            default = _anything(self.vocabulary.declarations[name])
        if unknown is not None or is_dark:
            known = np.zeros(len(column.values), dtype=bool)
            unknown = np.append(known if unknown is None else unknown, is_dark)
        values = np.append(column.values, column.values.dtype.type(default))
        upper = None if upper is None else np.append(upper, float(default))
        return PartlyKnown(values, upper, unknown, column.missing)

    def _unknown_and_unsaid(
        self, name: str, parts: Sequence[Array]
    ) -> tuple[Flags | None, Flags | None]:
        if len(self._pieces) == 1:
            (piece,), (dark, absent) = self._pieces, self._flagged
            return (
                piece.unknown[name] if name in dark else None,
                piece.absent[name] if name in absent else None,
            )
        return (
            _joined(name, [piece.unknown for piece in self._pieces], parts),
            _joined(name, [piece.absent for piece in self._pieces], parts),
        )

    def _with_default(self, name: str, column: PartlyKnown, unsaid: Flags) -> PartlyKnown:
        """The column with the default where no value is given."""
        default, unknown = self.default(name), column.unknown
        declaration = self.vocabulary.declarations[name]
        if default is None:
            missing = unsaid & self._suits(declaration)
            return column._replace(missing=missing if missing.any() else None)
        if default is UNKNOWN:  # it is not told, and yet said of somebody
            return column._replace(unknown=either(unknown, unsaid))
        values = np.where(unsaid, default, column.values).astype(column_dtype(declaration))
        upper = None if column.upper is None else np.where(unsaid, default, column.upper)
        unknown = None if unknown is None else unknown & ~unsaid
        return PartlyKnown(values, upper, unknown)

    def _suits(self, declaration: Declaration) -> Flags:
        """Which values of a name's column are about different objects of its types."""
        kinds = declaration.parameters
        if not kinds:
            return np.ones(self.n_states, dtype=bool)
        if len(kinds) == 1:
            return self.of_type(kinds[0]).repeat(self.n_cells)
        first, second = self.pairs.objects.T
        suits: Flags = (first != second) & self.of_type(kinds[0])[first]
        suits &= self.of_type(kinds[1])[second]
        return suits.repeat(np.diff(self.pairs.starts))

    def _places(self, name: str, declaration: Enumeration, parts: Sequence[Array]) -> Array:
        """The places among the declared values; one past the last for any other text."""
        mapped = []
        for piece, part in zip(self._pieces, parts, strict=True):
            texts = piece.texts.get(name)
            if texts is None:
                raise UnencodableError
            if texts != declaration.values:
                places = {value: place for place, value in enumerate(declaration.values)}
                table = [places.get(text, len(places)) for text in texts]
                part = np.array(table, dtype=np.intp).take(part)
            mapped.append(part)
        return _end_to_end(mapped)

    def _numbers(self, name: str, parts: Sequence[Array]) -> tuple[Array, Array | None]:
        """The numbers, or their least values, and their greatest values if some are intervals."""
        for piece, part in zip(self._pieces, parts, strict=True):
            if part.dtype.kind not in "fiu" or name in piece.texts:
                raise UnencodableError
            if part.dtype.kind != "f" and (np.abs(part) > EXACT_IN_FLOATS).any():
                raise UnencodableError
        if not any(name in piece.bounds for piece in self._pieces):
            return _end_to_end(parts).astype(np.float64, copy=False), None
        bounds = [
            piece.bounds.get(name, (part, part))
            for piece, part in zip(self._pieces, parts, strict=True)
        ]
        low, high = (
            _end_to_end(ends).astype(np.float64, copy=False) for ends in zip(*bounds, strict=True)
        )
        return low, high

    def _not_about(self, name: str, declaration: Declaration) -> Flags | None:
        """The cells of the objects for which a name is not given."""
        (kind,) = declaration.parameters
        if len(self._pieces) == 1 and name not in self._partly and self.all_are(kind):
            return None
        every = [
            piece.only[name] if name in piece.only else np.ones(piece.n_objects, dtype=bool)
            for piece in self._pieces
        ]
        is_about = _end_to_end(every)
        if not self.all_are(kind) and (is_about & ~self.of_type(kind)).any():
            raise UnencodableError
        return None if is_about.all() else (~is_about).repeat(self.n_cells)


def _joined(
    name: str, flags: Sequence[Mapping[str, Flags]], parts: Sequence[Array]
) -> Flags | None:
    """The flags of all pieces; None if none is set."""
    if not any(name in own for own in flags):
        return None
    nowhere = [np.zeros(len(part), dtype=bool) for part in parts]
    joined = _end_to_end([own.get(name, x) for own, x in zip(flags, nowhere, strict=True)])
    return joined if joined.any() else None


def _end_to_end(parts: Sequence[Array]) -> Array:
    return parts[0] if len(parts) == 1 else np.concatenate(parts)


def _ends(low: Array, high: Array | None) -> tuple[float, float]:
    """The least and the greatest number; NaN if one is."""
    most = low if high is None else high
    if not len(low):
        return 0.0, 0.0
    return np.minimum.reduce(low).item(), np.maximum.reduce(most).item()


def _anything(declaration: Declaration) -> Any:
    return encode_values([least_value(declaration)], declaration)[0]
