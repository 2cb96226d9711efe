"""A fleet's work in units: each a recording, or a piece of a table with whole drives."""

from __future__ import annotations

import os
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from hashlib import blake2b, sha256
from typing import Any, NamedTuple

import numpy as np
from numpy import uint64
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.files.read_files import file_state
from rulec.fleet.fleet_messages import no_fleet_input, unnamed_drives
from rulec.fleet.table_recordings import TableKind, keys_of, kind_of
from rulec.trace.formats import arrow as arrow_tables
from rulec.trace.formats.arrow.parquet import arrow

MOST_ROWS = 1 << 19
"""A table with more rows is divided into several units, so that several processes have work."""


class TablePiece(NamedTuple):
    """Some consecutive row groups of a Parquet file."""

    path: str
    row_groups: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class WorkUnit:
    """What is judged in one go into one file of findings: a recording, or a ``piece`` of a table.

    A piece's drives are those whose first row is in it. Keys in ``others`` are of drives that begin
    in an earlier piece; drives with keys in ``spread`` have more rows in the ``further`` pieces.
    """

    path: str
    piece: TablePiece | None = None
    further: tuple[TablePiece, ...] = ()
    spread: frozenset[int] = frozenset()
    others: frozenset[int] = frozenset()

    @property
    def digest(self) -> str:
        """The name of its file of findings: a hash of its path and of its first row group."""
        start = "" if self.piece is None else f"#{self.piece.row_groups[0]}"
        return sha256(os.fsencode(f"{self.path}{start}")).hexdigest()[:20]

    @property
    def paths(self) -> Sequence[str]:
        """The files of its rows, or the file of its recording."""
        return list(dict.fromkeys([self.path, *(piece.path for piece in self.further)]))

    def state(self) -> str:
        """A hash of what it reads: the files' names, sizes and times, and which row groups."""
        about = [(path, *file_state(path)) for path in self.paths]
        content = (about, self.piece, self.further, sorted(self.spread), sorted(self.others))
        return sha256(repr(content).encode()).hexdigest()


def work_units(tables: Sequence[str], recordings: Sequence[str]) -> Iterator[WorkUnit | RulecError]:
    """The units of a fleet, or why a table has none."""
    pieces: list[TablePiece] = []
    hashes: list[KeyHashes] = []
    for path in tables:
        pieces_of_table = _pieces_or_reason(path)
        if isinstance(pieces_of_table, RulecError):
            yield pieces_of_table
        else:
            pieces += (piece for piece, _ in pieces_of_table)
            hashes += (own for _, own in pieces_of_table)
    yield from _units_of(pieces, hashes)
    yield from (WorkUnit(path) for path in recordings)


def _units_of(pieces: Sequence[TablePiece], hashes: Sequence[KeyHashes]) -> Iterator[WorkUnit]:
    """A unit for each piece: the drives that begin in it, with their rows from all pieces."""
    if not pieces:
        return
    every = np.concatenate(hashes)
    owners = np.repeat(np.arange(len(hashes)), [len(own) for own in hashes])
    order = np.lexsort((owners, every))
    every, owners = every[order], owners[order]
    # Only keys that occur in several pieces are looked at one by one.
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
            tuple(pieces[number_] for number_ in sorted(further.get(number, ()))),
            spread=frozenset(spread.get(number, ())),
            others=frozenset(others.get(number, ())),
        )


def _pieces_or_reason(path: str) -> list[tuple[TablePiece, KeyHashes]] | RulecError:
    try:
        return list(_pieces(path))
    except RulecError as error:
        return error


def _pieces(path: str) -> Iterator[tuple[TablePiece, KeyHashes]]:
    """The pieces of a file, each with its keys. Raises RulecError R0710."""
    with opened_table(path) as source:
        groups: list[int] = []
        hashes: list[KeyHashes] = []
        rows = 0
        for number in range(source.num_row_groups):
            groups.append(number)
            rows += source.metadata.row_group(number).num_rows
            # Only the key columns are read here
            hashes += (
                batch.key_hashes() for batch in keyed_rows(source, [number], path, whole=False)
            )
            # A table without rows has no drives
            if hashes and (rows >= MOST_ROWS or number + 1 == source.num_row_groups):
                yield TablePiece(path, tuple(groups)), np.unique(np.concatenate(hashes))
                groups, hashes, rows = [], [], 0


ROWS_AT_ONCE = 1 << 14
"""Number of rows kept in memory, however large a file's row groups are."""

_BYTES_AT_ONCE = 1 << 16

_BETWEEN_KEYS = "\x1f"

KeyHashes = NDArray[uint64]
"""Keys of drives as numbers of eight bytes each, whatever the length of the texts."""


class KeyedRows(NamedTuple):
    """Rows of a file; ``codes`` gives for each row the index of its key in ``texts``."""

    rows: Any
    codes: NDArray[np.int64]
    kind: TableKind
    texts: Sequence[str]

    def key_hashes(self) -> KeyHashes:
        """The keys as numbers that are the same in all processes."""
        hashes = (_hash(self.kind, text) for text in self.texts)
        return np.fromiter(hashes, uint64, len(self.texts))

    def local_hashes(self) -> NDArray[np.int64]:
        """The keys as numbers valid in this process only, computed in a tenth of the time."""
        return np.fromiter(map(hash, self.texts), np.int64, len(self.texts)) ^ hash(self.kind)


@contextmanager
def memory_given_back() -> Iterator[None]:
    """A block in which Arrow takes memory from the system and returns it there.

    The memory that Arrow's own pool keeps for reuse would grow over millions of rows.
    """
    pyarrow, _ = arrow("tables of drives")
    before = pyarrow.default_memory_pool()
    pyarrow.set_memory_pool(pyarrow.system_memory_pool())
    try:
        yield
    finally:
        pyarrow.set_memory_pool(before)


@contextmanager
def opened_table(path: str) -> Iterator[Any]:
    """A Parquet file; errors from Arrow become a RulecError R0710."""
    pyarrow, parquet = arrow(path)
    try:
        with parquet.ParquetFile(path, buffer_size=_BYTES_AT_ONCE) as source:
            yield source
    except (pyarrow.ArrowException, OSError) as reason:
        raise no_fleet_input(path, str(reason).split("\n")[0]) from None


def keyed_rows(
    source: Any, row_groups: Sequence[int], path: str, *, whole: bool
) -> Iterator[KeyedRows]:
    """The rows of some row groups in order: ``whole``, or only the key columns.

    Raises RulecError R0710 for a table of something else, or keys that are not UTF-8.
    """
    names = source.schema_arrow.names
    kind = kind_of(names, path)
    keys = keys_of(names, kind)
    batches = source.iter_batches(
        ROWS_AT_ONCE, list(row_groups), columns=None if whole else keys, use_threads=False
    )
    for batch in batches:
        rows = arrow_tables.table_of_batch(batch)
        if why := arrow_tables.not_utf8(rows, keys):
            raise unnamed_drives(why, path)
        codes, texts = arrow_tables.key_texts(rows, keys, _BETWEEN_KEYS)
        yield KeyedRows(rows, codes, kind, texts)


def _hash(kind: TableKind, text: str) -> int:
    return int.from_bytes(blake2b(f"{kind}{text}".encode(), digest_size=8).digest(), "little")
