"""Joint codes: one number (cell) for everything that rules read in a state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod

import numpy as np

from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead
from rulec.automata.thresholds import scale
from rulec.monitoring.batch.columns.column_reader import ColumnReader
from rulec.monitoring.batch.verdict_columns import JointCells, RuleBinding
from rulec.trace.trace_columns import Array, Layout, smallest_unsigned
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.vocabulary_model import values_of

MOST_CELLS = 1 << 16
"""If there are more combinations of values, no single number is used for them."""

_BYTE = 256

_Key = tuple[object, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Digit:
    """The numbers of a joint read: a column, or one constant for all states.

    ``meanings`` are the digits of a machine's letter that these numbers stand for.
    """

    key: _Key
    values: Array | int
    meanings: Array


@dataclass(frozen=True, slots=True, eq=False)
class _ReadBinding:
    """A binding, the digits of its machine's letters, and the classes of these letters."""

    binding: RuleBinding
    digits: Sequence[_Digit]
    classes: Array

    def classes_at(self, varying: Mapping[_Key, Array], n_codes: int) -> Array:
        """For each code the class of the letter that the machine reads.

        ``varying`` has those of its digits that are not the same in all states.
        """
        numbers, stride = np.zeros(n_codes, dtype=np.int64), 1
        for digit, read in zip(self.digits, self.binding.rule.machine.reads, strict=True):
            numbers += stride * digit.meanings.take(varying.get(digit.key, digit.values))
            stride *= read.size
        return self.classes.take(numbers)


def joint_cells_of(
    reader: ColumnReader, bindings: Sequence[RuleBinding], vocabulary: Vocabulary
) -> Iterator[JointCells]:
    """Cells from which all bindings can be verified. Raises NotGivenError.

    Tasks about the same objects on the same stretch share one cell column, unless they read too
    much.
    """
    together: dict[_Key, list[RuleBinding]] = {}
    for binding in bindings:
        key = (frozenset(binding.objects.values()), *binding.stretch)
        together.setdefault(key, []).append(binding)
    # Rules have many bindings, so a machine's letters are converted to an array once.
    machines = {binding.rule.name: binding.rule.machine for binding in bindings}
    classes = {name: np.array(machine.letters) for name, machine in machines.items()}
    meanings = {name: _meanings(machine, vocabulary) for name, machine in machines.items()}
    layout = reader.columns.layout
    for group in together.values():
        read_bindings = [
            _ReadBinding(
                binding,
                _digits_of(binding, reader, meanings[binding.rule.name]),
                classes[binding.rule.name],
            )
            for binding in group
        ]
        if _size(_columns(read_bindings)) <= MOST_CELLS:
            yield _joint_cells(layout, read_bindings)
            continue
        for read_binding in read_bindings:
            if _size(_columns([read_binding])) <= MOST_CELLS:
                yield _joint_cells(layout, [read_binding])
            else:
                yield _class_cells(layout, read_binding)


def _meanings(machine: MealyMonitor, vocabulary: Vocabulary) -> list[Array]:
    meanings = []
    for read in machine.reads:
        if isinstance(read, NumberRead):
            meanings.append(np.arange(read.size))
        else:
            values = values_of(vocabulary.declarations[read.name])
            meanings.append(np.array([read.digit(value) for value in values]))
    return meanings


def _digits_of(
    binding: RuleBinding, reader: ColumnReader, all_meanings: Sequence[Array]
) -> list[_Digit]:
    digits = []
    for read, meanings in zip(binding.rule.machine.reads, all_meanings, strict=True):
        if isinstance(read, NumberRead):
            items = tuple([binding.objects[variable] for variable in scale(read).variables])
            key: _Key = (read.terms, read.thresholds, scale(read).variables, items)
            digits.append(_Digit(key, reader.digits(read, binding.objects), meanings))
        else:
            items = tuple([binding.objects[variable] for variable in read.variables])
            values = reader.given(read.name, items)
            column = values if isinstance(values, np.ndarray) else int(values)
            digits.append(_Digit((read.name, items), column, meanings))
    return digits


def _columns(read_bindings: Sequence[_ReadBinding]) -> Mapping[_Key, _Digit]:
    return {
        digit.key: digit
        for read_binding in read_bindings
        for digit in read_binding.digits
        if isinstance(digit.values, np.ndarray)
    }


def _size(columns: Mapping[_Key, _Digit]) -> int:
    return prod(len(digit.meanings) for digit in columns.values())


def _joint_cells(layout: Layout, read_bindings: Sequence[_ReadBinding]) -> JointCells:
    columns = _columns(read_bindings)
    size = _size(columns)
    strides: dict[_Key, int] = {}
    cells = np.zeros(layout.n_states, dtype=smallest_unsigned(size))
    stride = 1
    for key, digit in columns.items():
        assert isinstance(digit.values, np.ndarray)
        part = digit.values.astype(cells.dtype, copy=False)
        cells += part * cells.dtype.type(stride) if stride > 1 else part
        strides[key] = stride
        stride *= len(digit.meanings)
    codes = np.arange(size)
    if size > _BYTE:
        # Few of the combinations occur.
        codes = np.flatnonzero(np.bincount(cells, minlength=size))
        numbers = np.zeros(size, dtype=smallest_unsigned(len(codes)))
        numbers[codes] = np.arange(len(codes))
        cells = numbers.take(cells)
    varying = {key: codes // strides[key] % len(digit.meanings) for key, digit in columns.items()}
    return JointCells(
        layout,
        cells,
        [read_binding.binding for read_binding in read_bindings],
        [read_binding.classes_at(varying, len(codes)).tolist() for read_binding in read_bindings],
    )


def _class_cells(layout: Layout, read_binding: _ReadBinding) -> JointCells:
    # One more than the class, so that impossible letters have a cell, too.
    n_cells = len(read_binding.binding.rule.machine.successors[0]) + 1
    columns = {key: np.asarray(digit.values) for key, digit in _columns([read_binding]).items()}
    cells = read_binding.classes_at(columns, layout.n_states) - IMPOSSIBLE
    letters = range(IMPOSSIBLE, n_cells + IMPOSSIBLE)
    return JointCells(
        layout, cells.astype(smallest_unsigned(n_cells)), [read_binding.binding], [letters]
    )
