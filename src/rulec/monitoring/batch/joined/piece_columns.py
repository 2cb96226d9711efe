"""Columns of a piece, built name by name."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import Any

import numpy as np

from rulec.array_types import Flags, Indices
from rulec.monitoring.batch.columns.encoded_columns import PartlyKnown, encode_partly_known
from rulec.monitoring.batch.joined.joined_traces import JoinedPiece
from rulec.monitoring.state_validation import TRUTHS
from rulec.trace.trace_columns import Array
from rulec.vocabulary import Declaration, Enumeration, Signal
from rulec.vocabulary.vocabulary_model import least_value

NOT_GIVEN = object()
"""Stands for a value that is not given."""


class PieceColumns:
    """The columns of a piece, name by name."""

    def __init__(self) -> None:
        self._world: dict[str, Array] = {}
        self._about: dict[str, Array] = {}
        self._between: dict[str, Array] = {}
        self._unknown: dict[str, Flags] = {}
        self._absent: dict[str, Flags] = {}
        self._bounds: dict[str, tuple[Array, Array]] = {}
        self._only: dict[str, Flags] = {}
        self._texts: dict[str, tuple[str, ...]] = {}
        self._truths: tuple[dict[str, Sequence[bool]], ...] = ({}, {}, {})

    def add(
        self, values: Sequence[Any], declaration: Declaration, suits: Flags | None = None
    ) -> None:
        """Add a name's values, some ``NOT_GIVEN``; ``suits``: the objects that it can be about."""
        kinds, absent = set(map(type, values)), None
        if kinds == TRUTHS and isinstance(declaration, Signal):
            # Most names are, and one array of all of them takes fewer calls
            self._truths[len(declaration.parameters)][declaration.name] = values
            if suits is not None:
                self._only[declaration.name] = suits
            return
        if type(NOT_GIVEN) in kinds:
            absent = np.array([value is NOT_GIVEN for value in values], dtype=bool)
            anything = least_value(declaration)
            values = [anything if value is NOT_GIVEN else value for value in values]
        column = encode_partly_known(values, declaration)
        self.add_encoded(column._replace(missing=absent), declaration, suits)

    def add_encoded(
        self, column: PartlyKnown, declaration: Declaration, suits: Flags | None = None
    ) -> None:
        """Add a name's column."""
        name, arity = declaration.name, len(declaration.parameters)
        (self._world, self._about, self._between)[arity][name] = column.values
        if suits is not None:
            self._only[name] = suits
        if column.unknown is not None:
            self._unknown[name] = column.unknown
        if column.upper is not None:
            self._bounds[name] = column.values, column.upper
        if column.missing is not None:
            self._absent[name] = column.missing
        if isinstance(declaration, Enumeration):
            self._texts[name] = declaration.values

    def piece(self, n_objects: int, pairs: Indices) -> JoinedPiece:
        """The piece of these columns."""
        for part, truths in zip(
            (self._world, self._about, self._between), self._truths, strict=True
        ):
            rows = [*truths.values()]
            length = len(rows[0]) if rows else 0
            flat = np.fromiter(chain.from_iterable(rows), bool, len(rows) * length)
            part |= zip(truths, flat.reshape(len(rows), length), strict=True)
        return JoinedPiece(
            self._world,
            self._about,
            unknown=self._unknown,
            absent=self._absent,
            bounds=self._bounds,
            only=self._only,
            texts=self._texts,
            n_objects=n_objects,
            between=self._between,
            pairs=pairs,
        )
