"""Arrow arrays as NumPy arrays, taken directly from their buffers, and made by filling buffers.

Arrow's own conversions load pandas where installed (0.3 s and 40 MB), which takes longer than
reading most files. Its functions are called by name: ``pyarrow.compute`` first generates
descriptions of all (30 ms).
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import chain
from typing import Any

import numpy as np
import pyarrow
from numpy.typing import NDArray
from pyarrow import types
from pyarrow._compute import CastOptions, DictionaryEncodeOptions, call_function


def given_in(array: Any) -> NDArray[np.bool_]:
    """Mask of the cells that have a value."""
    if types.is_null(array.type):
        return np.zeros(len(array), dtype=bool)
    validity = array.buffers()[0]
    if validity is None or not array.null_count:
        return np.ones(len(array), dtype=bool)
    return _bits(validity, array)


def numbers_in(array: Any) -> NDArray[Any]:
    """The numbers of an array, arbitrary where a value is missing."""
    buffer = array.buffers()[1]
    kind = np.dtype(str(array.type).replace("double", "float64"))
    if buffer is None:
        return np.zeros(len(array), dtype=kind)
    return np.frombuffer(buffer, kind, len(array), array.offset * kind.itemsize)


def truths_in(array: Any) -> NDArray[np.bool_]:
    """The Booleans of an array, arbitrary where a value is missing."""
    buffer = array.buffers()[1]
    return np.zeros(len(array), dtype=bool) if buffer is None else _bits(buffer, array)


def ends_in(array: Any) -> NDArray[np.int32]:
    """The byte where the first text of an array begins, then where each text ends."""
    buffer = array.buffers()[1]
    if buffer is None:
        return np.zeros(len(array) + 1, dtype=np.int32)
    return np.frombuffer(buffer, np.int32, len(array) + 1, array.offset * 4)


def lengths_in(array: Any) -> NDArray[np.int32]:
    """The length of each text of an array, in bytes."""
    return np.diff(ends_in(array))


def list_lengths_in(array: Any) -> Any:
    """The number of values in each list of an array, as an Arrow array."""
    return call_function("list_value_length", [array])


def cast_to(array: Any, kind: Any) -> Any:
    """The array cast to another type. Raises ArrowInvalid."""
    return call_function("cast", [array], CastOptions.safe(kind))


def are_equal(array: Any, other: Any) -> NDArray[np.bool_]:
    """Mask of the cells that have a value equal to that of another array, or to a scalar."""
    return flags_in(call_function("equal", [array, other]))


def codes_in(array: Any) -> tuple[NDArray[Any], Sequence[Any]]:
    """Each cell's index among the distinct values, -1 if missing, and these values."""
    if types.is_null(array.type):
        return np.full(len(array), -1), ()
    is_dictionary = types.is_dictionary(array.type)
    encoded = array
    if not is_dictionary:
        encoded = call_function("dictionary_encode", [array], DictionaryEncodeOptions())
    codes, values = numbers_in(encoded.indices), encoded.dictionary.to_pylist()
    if codes.dtype != np.int32:
        codes = codes.astype(np.int64, copy=False)
    # There may be no cells, or no values; the codes of missing cells are arbitrary.
    if encoded.indices.null_count:
        codes = np.where(given_in(encoded.indices), codes, -1)
    if is_dictionary:  # a dictionary's values need not be distinct
        places = {value: place for place, value in enumerate(dict.fromkeys(values))}
        if len(places) < len(values) or None in places:
            own = np.array([-1 if value is None else places[value] for value in values] or [-1])
            codes = np.where(codes < 0, -1, own.take(codes))
            values = list(places)
    return codes, values


def runs_in(array: Any) -> tuple[NDArray[Any], Sequence[Any]]:
    """As ``codes_in``, but faster if many consecutive cells are the same."""
    runs = call_function("run_end_encode", [array])
    codes, values = codes_in(runs.values)
    return np.repeat(codes, np.diff(numbers_in(runs.run_ends), prepend=0)), values


def one_in(array: Any) -> tuple[NDArray[np.int8], str] | None:
    """Each cell's code (0, or -1 if empty) and the text, if all texts are the same; else None."""
    ends, data = ends_in(array), array.buffers()[2]
    lengths = np.diff(ends)
    size = int(lengths.max(initial=0))
    given = lengths > 0
    if not size or size * np.count_nonzero(given) != ends[-1] - ends[0]:
        return None
    text = np.frombuffer(data, np.uint8)[ends[0] : ends[-1]]
    # All of them have this length.
    if (text[size:] != text[:-size]).any():
        return None
    return given.astype(np.int8) - np.int8(1), text[:size].tobytes().decode()


def cells_in(column: Any) -> NDArray[Any]:
    """A table's column: numbers with NaN where missing, or objects with None where missing."""
    array = whole_array(column)
    kind = array.type.value_type if types.is_dictionary(array.type) else array.type
    if types.is_string(kind) or types.is_large_string(kind):
        codes, values = codes_in(array)
        objects = np.empty(len(values) + 1, dtype=object)
        objects[:-1] = values  # the last one stays None
        return objects.take(codes, mode="wrap")
    if types.is_integer(array.type) or types.is_float64(array.type):
        numbers, given = numbers_in(array), given_in(array)
        return numbers if given.all() else np.where(given, numbers, np.nan)
    cells: NDArray[Any] = column.to_numpy()
    return cells


def flags_in(column: Any) -> NDArray[np.bool_]:
    """Mask of the cells of a Boolean column that are True."""
    array = whole_array(column)
    return truths_in(array) & given_in(array)


def whole_array(column: Any) -> Any:
    """A table's column, which may be chunked, as one array."""
    return column.combine_chunks() if isinstance(column, pyarrow.ChunkedArray) else column


def array_of_truths(flags: NDArray[np.bool_]) -> Any:
    """Booleans as an Arrow array."""
    bits = pyarrow.py_buffer(np.packbits(flags, bitorder="little"))
    return pyarrow.Array.from_buffers(pyarrow.bool_(), len(flags), [None, bits])


def one_text(text: str) -> Any:
    """A text as an Arrow scalar."""
    data = text.encode()
    ends = pyarrow.py_buffer(np.array([0, len(data)], dtype=np.int32))
    whole = [None, ends, pyarrow.py_buffer(data)]
    return pyarrow.Array.from_buffers(pyarrow.string(), 1, whole)[0]


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


def _bits(buffer: Any, array: Any) -> NDArray[np.bool_]:
    start, stop = array.offset, array.offset + len(array)
    packed = np.frombuffer(buffer, np.uint8)[start // 8 : (stop + 7) // 8]
    bits = np.unpackbits(packed, bitorder="little")[start % 8 :][: len(array)]
    return bits.view(np.bool_)


def with_plain_texts(rows: Any) -> Any:
    """The table or batch with string views as plain strings; not all of Arrow accepts views."""
    is_view = types.is_string_view
    if not any(map(is_view, rows.schema.types)):
        return rows
    columns = [x.cast(pyarrow.string()) if is_view(x.type) else x for x in rows.columns]
    return type(rows).from_arrays(columns, names=rows.schema.names)
