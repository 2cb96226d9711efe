"""A fleet's work in units: a recording each, or a piece of a table with whole drives."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import blake2b, sha256
from typing import Any, NamedTuple

import numpy as np
from numpy import uint64
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.files import file_state
from rulec.fleet.fleet_messages import no_fleet_input
from rulec.fleet.table_kind import TableKind, keys_of, kind_of
from rulec.trace.formats.arrow.parquet import arrow

MOST_ROWS = 1 << 19
"""Of a larger table several units are made, so that none takes much memory."""

_BETWEEN_KEYS = "\x1f"

KeyHashes = NDArray[uint64]
"""Keys of drives as numbers: eight bytes each, however many drives there are."""


class TablePiece(NamedTuple):
    """Some row groups of a Parquet file, one after the other."""

    path: str
    row_groups: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class WorkUnit:
    """What is judged in one go, and whose findings are one file: a ``recording``, or a piece.

    The drives of a piece are all that begin in it and no earlier one: those with keys in ``others``
    do, and rows of those in ``spread`` are also in the ``further`` pieces.
    """

    path: str
    piece: TablePiece | None = None
    further: tuple[TablePiece, ...] = ()
    spread: frozenset[int] = frozenset()
    others: frozenset[int] = frozenset()

    @property
    def digest(self) -> str:
        """What its file of findings is called by: that of its path and of where it begins."""
        start = "" if self.piece is None else f"#{self.piece.row_groups[0]}"
        return sha256(f"{self.path}{start}".encode()).hexdigest()[:20]

    @property
    def paths(self) -> Sequence[str]:
        """The files of its rows, or the one of its recording."""
        return list(dict.fromkeys([self.path, *(piece.path for piece in self.further)]))

    def state(self) -> str:
        """What it reads, as far as names, sizes, times and places of rows tell."""
        about = [(path, *file_state(path)) for path in self.paths]
        content = (about, self.piece, self.further, sorted(self.spread), sorted(self.others))
        return sha256(repr(content).encode()).hexdigest()


def work_units(tables: Sequence[str], recordings: Sequence[str]) -> Iterator[WorkUnit | RulecError]:
    """The units of a fleet, or why a table has none."""
    pieces: list[TablePiece] = []
    hashes: list[KeyHashes] = []
    for path in tables:
        found = _pieces_or_reason(path)
        if isinstance(found, RulecError):
            yield found
        else:
            pieces += (piece for piece, _ in found)
            hashes += (own for _, own in found)
    yield from _units_of(pieces, hashes)
    yield from (WorkUnit(path) for path in recordings)


def _units_of(pieces: Sequence[TablePiece], hashes: Sequence[KeyHashes]) -> Iterator[WorkUnit]:
    """A unit for each piece: its drives, and their rows wherever they are."""
    if not pieces:
        return
    every = np.concatenate(hashes)
    owners = np.repeat(np.arange(len(hashes)), [len(own) for own in hashes])
    order = np.lexsort((owners, every))
    every, owners = every[order], owners[order]
    # Only those that are in several pieces are looked at one by one.
    again = np.flatnonzero(every[1:] == every[:-1]) + 1
    first: dict[int, int] = {}
    further: dict[int, set[int]] = {}
    spread: dict[int, set[int]] = {}
    others: dict[int, set[int]] = {}
    for place in again.tolist():
        key, owned = int(every[place]), int(owners[place])
        owner = first.setdefault(key, int(owners[place - 1]))
        further.setdefault(owner, set()).add(owned)
        spread.setdefault(owner, set()).add(key)
        others.setdefault(owned, set()).add(key)
    for number, piece in enumerate(pieces):
        yield WorkUnit(
            piece.path,
            piece,
            tuple(pieces[one] for one in sorted(further.get(number, ()))),
            spread=frozenset(spread.get(number, ())),
            others=frozenset(others.get(number, ())),
        )


def _pieces_or_reason(path: str) -> list[tuple[TablePiece, KeyHashes]] | RulecError:
    try:
        return list(_pieces(path))
    except RulecError as error:
        return error


def _pieces(path: str) -> Iterator[tuple[TablePiece, KeyHashes]]:
    """The pieces of a file with the keys in them. Raises RulecError R0710."""
    with _opened(path) as source:
        names = source.schema_arrow.names
        kind = kind_of(names)
        keys = keys_of(names, kind)
        groups: list[int] = []
        found: list[KeyHashes] = []
        rows = 0
        for number in range(source.num_row_groups):
            groups.append(number)
            rows += source.metadata.row_group(number).num_rows
            # Names and times of nothing but keys are read here
            table = source.read_row_group(number, columns=keys)
            found.append(_different(table, keys, kind))
            if rows >= MOST_ROWS or number + 1 == source.num_row_groups:
                yield TablePiece(path, tuple(groups)), np.unique(np.concatenate(found))
                groups, found, rows = [], [], 0


@contextmanager
def _opened(path: str) -> Iterator[Any]:
    """A Parquet file; what Arrow says of it becomes a RulecError R0710."""
    pyarrow, parquet = arrow(path)
    try:
        with parquet.ParquetFile(path) as source:
            yield source
    except (pyarrow.ArrowException, OSError) as reason:
        raise no_fleet_input(path, str(reason).split("\n")[0]) from None


def _different(table: Any, keys: Sequence[str], kind: TableKind) -> KeyHashes:
    # Arrow, 0.1 s: where there is a table of it, it is loaded.
    from rulec.trace.formats.arrow.table_groups import key_texts

    _, texts = key_texts(table, keys, _BETWEEN_KEYS)
    return np.unique(np.fromiter((_hash(kind, text) for text in texts), uint64, len(texts)))


def _hash(kind: TableKind, text: str) -> int:
    return int.from_bytes(blake2b(f"{kind}{text}".encode(), digest_size=8).digest(), "little")


def table_of_unit(unit: WorkUnit) -> Any:
    """The rows of all drives of a unit, as one Arrow table. Raises RulecError R0710."""
    # As above.
    from rulec.trace.formats.arrow.table_groups import joined, key_texts, rows_where

    assert unit.piece is not None, "it is of a table"
    tables = []
    for number, piece in enumerate((unit.piece, *unit.further)):
        with _opened(piece.path) as source:
            table = source.read_row_groups(list(piece.row_groups))
        kind = kind_of(table.column_names)
        keys = keys_of(table.column_names, kind)
        codes, texts = key_texts(table, keys, _BETWEEN_KEYS)
        hashes = (_hash(kind, text) for text in texts)
        if number:
            kept = [one in unit.spread for one in hashes]
        else:
            kept = [one not in unit.others for one in hashes]
        tables.append(table if all(kept) else rows_where(table, codes, kept))
    return joined(tables)
