"""Values in arrays, each with the state and the objects that it is about, laid end to end."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.monitoring.batch.columns.encoded_columns import PartlyKnown, UnencodableError
from rulec.monitoring.batch.joined.joined_traces import JoinedPiece
from rulec.monitoring.batch.joined.object_pairs import ObjectPairs
from rulec.monitoring.batch.joined.piece_columns import PieceColumns
from rulec.monitoring.batch.joined.trace_places import TracePlaces
from rulec.trace.trace_columns import Array
from rulec.vocabulary import Declaration


class GivenValues(NamedTuple):
    """Values of a name in these ``states``, about these ``objects``: one array per parameter.

    States and objects are numbered among those of all traces.
    """

    states: Indices
    objects: tuple[Indices, ...]
    column: PartlyKnown

    def part(self, kept: Flags) -> GivenValues:
        """Some of the values."""
        objects = tuple(own[kept] for own in self.objects)
        return GivenValues(self.states[kept], objects, self.column.at(kept))


def piece_of(given: Mapping[str, Sequence[GivenValues]], places: TracePlaces) -> JoinedPiece:
    """The values by name, those of an object that is absent left out.

    Raises UnencodableError for names that the vocabulary lacks, for values about other objects, for
    a value that is given twice, and if axioms imply more than is given.
    """
    vocabulary, columns = places.vocabulary, PieceColumns()
    named: list[tuple[Declaration, Sequence[GivenValues]]] = []
    for name, parts in given.items():
        declaration = vocabulary.declarations.get(name)
        if declaration is None or len(declaration.parameters) > 2:
            raise UnencodableError
        for part in parts:
            if len(part.objects) != len(declaration.parameters):
                raise UnencodableError
            for kind, own in zip(declaration.parameters, part.objects, strict=True):
                if not places.of_type(kind)[own].all():
                    raise UnencodableError
        named.append((declaration, [_present(part, places) for part in parts]))
    pairs = _pairs(named, places)
    lengths = places.n_states, int(places.starts[-1]), int(pairs.starts[-1])
    for declaration, parts in named:
        arity = len(declaration.parameters)
        column = _laid_out(parts, [_at(x, places, pairs) for x in parts], lengths[arity])
        if column.missing is not None and declaration.constant:
            raise UnencodableError  # a state that lacks it has the value of the others
        suits = places.of_type(declaration.parameters[0]) if arity == 1 else None
        columns.add_encoded(column, declaration, suits)
    piece = columns.piece(len(places.types), pairs.objects)
    for cause, effects in vocabulary.implied.items():
        if any(_lacks(piece, cause, effect) for effect in effects):
            raise UnencodableError
    return piece


def _present(part: GivenValues, places: TracePlaces) -> GivenValues:
    """The values about those who are present."""
    there = np.ones(len(part.states), dtype=bool)
    for own in part.objects:
        there &= (places.firsts[own] <= part.states) & (part.states <= places.lasts[own])
    return part if there.all() else part.part(there)


def _pairs(
    named: Iterable[tuple[Declaration, Sequence[GivenValues]]], places: TracePlaces
) -> ObjectPairs:
    """The pairs that something is said about, and those of which a value may be missing."""
    n_objects, numbers = len(places.types), [np.empty(0, dtype=np.intp)]
    for declaration, parts in named:
        if len(declaration.parameters) == 2:
            pairs = [part.objects for part in parts]
            if declaration.default is None:
                first, second = (places.of_type(x).nonzero()[0] for x in declaration.parameters)
                pairs.append(places.pairs_present(first, second))
            numbers += [np.unique(first * n_objects + second) for first, second in pairs]
    every = np.unique(np.concatenate(numbers))
    return places.pairs_of(np.stack([every // (n_objects or 1), every % (n_objects or 1)], axis=1))


def _at(part: GivenValues, places: TracePlaces, pairs: ObjectPairs) -> Indices:
    """Where the values are in their column."""
    if not part.objects:
        return part.states
    if len(part.objects) == 2:
        return pairs.places(*part.objects, part.states)
    (own,) = part.objects
    at: Indices = part.states + (places.starts[:-1] - places.firsts)[own]
    return at


def _laid_out(parts: Sequence[GivenValues], at: Sequence[Indices], length: int) -> PartlyKnown:
    """The column of these values, of which some may be missing."""
    given = [part.column for part in parts]
    values: Array = np.zeros(length, dtype=np.result_type(*[own.values for own in given]))
    missing, unknown = np.ones(length, dtype=bool), np.zeros(length, dtype=bool)
    for own, where in zip(given, at, strict=True):
        values[where], missing[where] = own.values, False
        if own.unknown is not None:
            unknown[where] = own.unknown
    if np.count_nonzero(missing) + sum(map(len, at)) != length:
        raise UnencodableError  # something is said twice
    upper = values.copy() if any(own.upper is not None for own in given) else None
    for own, where in zip(given, at, strict=True):
        if upper is not None and own.upper is not None:
            upper[where] = own.upper
    flags = [part if part.any() else None for part in (unknown, missing)]
    return PartlyKnown(values, upper, *flags)


def _lacks(piece: JoinedPiece, cause: str, effect: str) -> bool:
    """Whether some state has a true signal but lacks another signal that it implies."""
    for part in (piece.world, piece.about, piece.between):
        if cause in part:
            holds, lacking = part[cause], ~part.get(effect, np.False_)
            return bool((holds & (lacking | piece.absent.get(effect, False))).any())
    return False
