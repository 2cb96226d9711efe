"""From Arrow's columns to ours."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np
import pyarrow
from pyarrow import compute, types

from rulec.trace.formats.table_blocks import Coded, Column, Numbers, OddTableError
from rulec.trace.formats.table_reader import NAMES, Table
from rulec.trace.trace_model import Value

NUMBER = r"\A[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?\z"
"""A number in a text, as ``csv_table`` knows it."""

_FEW = 1 << 10


def columns_of(piece: Any, table: Table) -> Mapping[str, Column]:
    """The columns of a piece (a record batch). Raises OddTableError."""
    columns: dict[str, Column] = {}
    for name, array in zip(table.columns, piece.columns, strict=True):
        if types.is_dictionary(array.type):
            array = array.dictionary_decode()  # whose values need not be distinct
        if name in NAMES:
            columns[name] = coded(array)
        elif table.has_texts:
            columns[name] = _read(coded(array), table.value)
        elif types.is_integer(array.type) or types.is_floating(array.type):
            columns[name] = _numbers(array)
        else:
            columns[name] = coded(array)
    return columns


def coded(array: Any) -> Coded:
    """Column of dictionary codes; empty texts are no value."""
    if types.is_null(array.type):
        return Coded(np.full(len(array), -1), ())
    encoded = array.dictionary_encode()
    values = encoded.dictionary.to_pylist()
    codes = encoded.indices.fill_null(-1).to_numpy(zero_copy_only=False)
    if "" in values:
        codes = np.where(codes == values.index(""), -1, codes)
    return Coded(codes, values)


def _numbers(array: Any) -> Numbers:
    try:
        numbers = array.cast(pyarrow.float64()).fill_null(0)
    except pyarrow.ArrowInvalid:  # floats cannot tell such whole numbers apart
        raise OddTableError from None
    given = compute.is_valid(array)
    return Numbers(numbers.to_numpy(zero_copy_only=False), given.to_numpy(zero_copy_only=False))


def _read(texts: Coded, value: Callable[[str], Value]) -> Column:
    """Texts as the values that they stand for."""
    if len(texts.values) > _FEW:
        written = pyarrow.array([text or "0" for text in texts.values])
        if compute.all(compute.match_substring_regex(written, NUMBER)).as_py():
            try:
                numbers = written.cast(pyarrow.float64()).to_numpy()
                return Numbers(numbers.take(texts.codes, mode="clip"), texts.given)
            except pyarrow.ArrowInvalid:  # such as `.5`, which Arrow does not read
                pass
    return Coded(texts.codes, [value(text) if text else "" for text in texts.values])
