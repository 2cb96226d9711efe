"""Read Parquet tables of drives a few rows at a time, with the drive of each row."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from hashlib import blake2b
from typing import Any, NamedTuple

import numpy as np
from numpy import uint64
from numpy.typing import NDArray

from rulec.fleet.fleet_messages import no_fleet_input, unnamed_drives
from rulec.fleet.table_kind import TableKind, keys_of, kind_of
from rulec.trace.formats import arrow as arrow_tables
from rulec.trace.formats.arrow.parquet import arrow

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
