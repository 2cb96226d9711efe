"""Arrow arrays built from Python values through buffers.

Arrow's own constructors load pandas where it is installed: 0.3 s and 40 MB.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import Any

import numpy as np
import pyarrow


def array_of_numbers(cells: Sequence[float | None], kind: type) -> Any:
    """An array of integers or floats, by ``kind``, of which some may be missing."""
    of, dtype = (pyarrow.int64(), np.int64) if kind is int else (pyarrow.float64(), np.float64)
    given = np.array([cell is not None for cell in cells], dtype=bool)
    numbers = np.array([cell or 0 for cell in cells], dtype=dtype)
    bits = None if given.all() else pyarrow.py_buffer(np.packbits(given, bitorder="little"))
    return pyarrow.Array.from_buffers(of, len(cells), [bits, pyarrow.py_buffer(numbers)])


def array_of_texts(cells: Sequence[str]) -> Any:
    """An array of texts; unpaired surrogates, which UTF-8 cannot encode, are escaped."""
    known = {cell: cell.encode("utf-8", "backslashreplace") for cell in {*cells}}
    texts = [known[cell] for cell in cells]
    buffers = [None, _ends(texts), pyarrow.py_buffer(b"".join(texts))]
    return pyarrow.Array.from_buffers(pyarrow.string(), len(cells), buffers)


def array_of_lists(cells: Sequence[Sequence[str]]) -> Any:
    """An array of lists of texts."""
    kind = pyarrow.list_(pyarrow.string())
    texts = array_of_texts([*chain.from_iterable(cells)])
    return pyarrow.Array.from_buffers(kind, len(cells), [None, _ends(cells)], children=[texts])


def _ends(cells: Sequence[Sequence[object]]) -> Any:
    """Offsets: where the first cell begins, then where each cell ends."""
    ends = np.zeros(len(cells) + 1, dtype=np.int32)
    np.cumsum([len(cell) for cell in cells], out=ends[1:])
    return pyarrow.py_buffer(ends)
