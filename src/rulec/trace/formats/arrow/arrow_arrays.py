"""Arrow's arrays as numpy's, from their buffers.

Arrow's own ways load pandas, where that is installed, which takes longer than to read most files.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pyarrow
from numpy.typing import NDArray
from pyarrow import types


def given_in(array: Any) -> NDArray[np.bool_]:
    """Where an array has a value."""
    if types.is_null(array.type):
        return np.zeros(len(array), dtype=bool)
    validity = array.buffers()[0]
    if validity is None or not array.null_count:
        return np.ones(len(array), dtype=bool)
    return _bits(validity, array)


def numbers_in(array: Any) -> NDArray[Any]:
    """The numbers of an array, anything where there is none."""
    buffer = array.buffers()[1]
    kind = np.dtype(str(array.type).replace("double", "float64"))
    if buffer is None:
        return np.zeros(len(array), dtype=kind)
    return np.frombuffer(buffer, kind, len(array), array.offset * kind.itemsize)


def truths_in(array: Any) -> NDArray[np.bool_]:
    """The truth values of an array, anything where there is none."""
    buffer = array.buffers()[1]
    return np.zeros(len(array), dtype=bool) if buffer is None else _bits(buffer, array)


def lengths_in(array: Any) -> NDArray[np.int32]:
    """The bytes of each text of an array."""
    buffer = array.buffers()[1]
    if buffer is None:
        return np.zeros(len(array), dtype=np.int32)
    ends = np.frombuffer(buffer, np.int32, len(array) + 1, array.offset * 4)
    return np.diff(ends)


def codes_in(array: Any) -> tuple[NDArray[Any], Sequence[Any]]:
    """For each cell a place among distinct values, or -1 for none, and these values."""
    if types.is_null(array.type):
        return np.full(len(array), -1), ()
    is_dictionary = types.is_dictionary(array.type)
    encoded = array if is_dictionary else array.dictionary_encode()
    codes, values = numbers_in(encoded.indices), encoded.dictionary.to_pylist()
    # There may be no cells, or no values; codes of what is not given are arbitrary.
    if encoded.indices.null_count:
        codes = np.where(given_in(encoded.indices), codes, -1)
    if is_dictionary:  # whose values need not be distinct
        places = {value: place for place, value in enumerate(dict.fromkeys(values))}
        if len(places) < len(values) or None in places:
            own = np.array([-1 if one is None else places[one] for one in values] or [-1])
            codes = np.where(codes < 0, -1, own.take(codes))
            values = list(places)
    return codes.astype(np.int64, copy=False), values


def cells_in(column: Any) -> NDArray[Any]:
    """A table's column: numbers, NaN where one is missing, or objects, None where one is."""
    array = whole_array(column)
    kind = array.type.value_type if types.is_dictionary(array.type) else array.type
    if types.is_string(kind) or types.is_large_string(kind):
        codes, values = codes_in(array)
        found = np.empty(len(values) + 1, dtype=object)
        found[:-1] = values  # the last one stays None
        return found.take(codes, mode="wrap")
    if types.is_integer(array.type) or types.is_float64(array.type):
        numbers, given = numbers_in(array), given_in(array)
        return numbers if given.all() else np.where(given, numbers, np.nan)
    cells: NDArray[Any] = column.to_numpy()
    return cells


def flags_in(column: Any) -> NDArray[np.bool_]:
    """Where a column of truth values has a true one."""
    array = whole_array(column)
    return truths_in(array) & given_in(array)


def whole_array(column: Any) -> Any:
    """A column of a table, which may be in pieces, as one array."""
    return column.combine_chunks() if isinstance(column, pyarrow.ChunkedArray) else column


def array_of_truths(flags: NDArray[np.bool_]) -> Any:
    """Truth values as Arrow's array."""
    bits = pyarrow.py_buffer(np.packbits(flags, bitorder="little"))
    return pyarrow.Array.from_buffers(pyarrow.bool_(), len(flags), [None, bits])


def one_text(text: str) -> Any:
    """A text as Arrow's scalar."""
    data = text.encode()
    ends = pyarrow.py_buffer(np.array([0, len(data)], dtype=np.int32))
    whole = [None, ends, pyarrow.py_buffer(data)]
    return pyarrow.Array.from_buffers(pyarrow.string(), 1, whole)[0]


def _bits(buffer: Any, array: Any) -> NDArray[np.bool_]:
    start, stop = array.offset, array.offset + len(array)
    packed = np.frombuffer(buffer, np.uint8)[start // 8 : (stop + 7) // 8]
    bits = np.unpackbits(packed, bitorder="little")[start % 8 :][: len(array)]
    return bits.view(np.bool_)
