"""Joint codes: one number (cell) for everything that rules read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod

import numpy as np

from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead
from rulec.automata.thresholds import scale
from rulec.monitoring.batch.columns.column_reader import ColumnReader, NotGivenError
from rulec.monitoring.batch.rule_bindings import RuleBinding
from rulec.monitoring.batch.verdict_columns import JointCells
from rulec.trace.trace_columns import Array, smallest_unsigned
from rulec.vocabulary import Enumeration, Vocabulary

MOST_CELLS = 1 << 16
"""More combinations of what is read than these are not told apart by one number."""

_BYTE = 256

_Key = tuple[object, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Digit:
    """Joint read's digits below ``size``: a column, or a constant for all.

    ``meanings`` are the digits of a machine's letter that these numbers stand for.
    """

    key: _Key
    size: int
    values: Array | int
    meanings: Array


_Digits = Sequence[_Digit]
"""The digits of the letters of a binding's machine, in its order."""


@dataclass(frozen=True, slots=True, eq=False)
class _Alphabet:
    """Letter classes of a machine, and the ``meanings`` of its reads."""

    letters: Array
    meanings: Sequence[Array]


def _alphabet(machine: MealyMonitor, vocabulary: Vocabulary) -> _Alphabet:
    meanings = [
        np.arange(read.size)
        if isinstance(read, NumberRead)
        else np.array([read.digit(value) for value in _values(read.name, vocabulary)])
        for read in machine.reads
    ]
    return _Alphabet(np.array(machine.letters), meanings)


def _values(name: str, vocabulary: Vocabulary) -> Sequence[bool | str]:
    declaration = vocabulary.declarations[name]
    return declaration.values if isinstance(declaration, Enumeration) else (False, True)


def joint_cells_of(
    reader: ColumnReader, bindings: Sequence[RuleBinding], vocabulary: Vocabulary
) -> Iterator[JointCells]:
    """Cells from which all bindings can be verified. Raises NotGivenError.

    Tasks about the same objects on the same stretch share one, unless they read too much.
    """
    together: dict[_Key, list[RuleBinding]] = {}
    for binding in bindings:
        together.setdefault((frozenset(binding.objects.values()), *binding.stretch), []).append(
            binding
        )
    # Rules have many bindings: a machine's letters become an array once.
    rules = {binding.rule.name: binding.rule for binding in bindings}
    known = {name: _alphabet(rule.machine, vocabulary) for name, rule in rules.items()}
    for group in together.values():
        alphabets = [known[binding.rule.name] for binding in group]
        all_digits = [
            _digits_of(binding, reader, alphabet)
            for binding, alphabet in zip(group, alphabets, strict=True)
        ]
        if _size(_columns(all_digits)) <= MOST_CELLS:
            yield _joint_cells(reader, group, all_digits, alphabets)
            continue
        for binding, digits, alphabet in zip(group, all_digits, alphabets, strict=True):
            if _size(_columns([digits])) <= MOST_CELLS:
                yield _joint_cells(reader, [binding], [digits], [alphabet])
            else:
                yield _class_cells(reader, binding, digits, alphabet)


def _digits_of(binding: RuleBinding, reader: ColumnReader, alphabet: _Alphabet) -> _Digits:
    digits = []
    for read, meanings in zip(binding.rule.machine.reads, alphabet.meanings, strict=True):
        if isinstance(read, NumberRead):
            items = tuple([binding.objects[variable] for variable in scale(read).variables])
            key: _Key = (read.terms, read.thresholds, scale(read).variables, items)
            digits.append(_Digit(key, read.size, reader.digits(read, binding.objects), meanings))
            continue
        items = tuple([binding.objects[variable] for variable in read.variables])
        values = reader.values(read.name, items)
        if values is None:
            raise NotGivenError(read.name, items)
        column = values if isinstance(values, np.ndarray) else int(values)
        digits.append(_Digit((read.name, items), len(meanings), column, meanings))
    return digits


def _columns(all_digits: Sequence[_Digits]) -> Mapping[_Key, _Digit]:
    """All that is read and is not the same in all states."""
    return {
        digit.key: digit
        for digits in all_digits
        for digit in digits
        if isinstance(digit.values, np.ndarray)
    }


def _size(columns: Mapping[_Key, _Digit]) -> int:
    return prod(digit.size for digit in columns.values())


def _joint_cells(
    reader: ColumnReader,
    bindings: Sequence[RuleBinding],
    all_digits: Sequence[_Digits],
    alphabets: Sequence[_Alphabet],
) -> JointCells:
    columns = _columns(all_digits)
    strides: dict[_Key, int] = {}
    stride = 1
    for key, digit in columns.items():
        strides[key] = stride
        stride *= digit.size
    layout = reader.columns.layout
    cells = np.zeros(layout.n_states, dtype=smallest_unsigned(stride))
    for key, digit in columns.items():
        assert isinstance(digit.values, np.ndarray)
        part = digit.values.astype(cells.dtype, copy=False)
        cells += part * cells.dtype.type(strides[key]) if strides[key] > 1 else part
    codes = np.arange(stride)
    if stride > _BYTE:
        # Few of the combinations occur.
        codes = np.flatnonzero(np.bincount(cells, minlength=stride))
        numbers = np.zeros(stride, dtype=smallest_unsigned(len(codes)))
        numbers[codes] = np.arange(len(codes))
        cells = numbers.take(cells)
    varying = {key: codes // strides[key] % digit.size for key, digit in columns.items()}
    letters = [
        alphabet.letters.take(_numbers(binding.rule.machine, digits, varying, len(codes))).tolist()
        for binding, digits, alphabet in zip(bindings, all_digits, alphabets, strict=True)
    ]
    return JointCells(layout, cells, bindings, letters)


def _numbers(
    machine: MealyMonitor, digits: _Digits, varying: Mapping[_Key, Array], n_codes: int
) -> Array:
    """For each code the letter that the machine reads.

    ``varying`` has those of its digits that are not the same in all states. They are numbers below
    the size of what is read.
    """
    numbers, stride = np.zeros(n_codes, dtype=np.int64), 1
    for digit, read in zip(digits, machine.reads, strict=True):
        numbers += stride * digit.meanings.take(varying.get(digit.key, digit.values))
        stride *= read.size
    return numbers


def _class_cells(
    reader: ColumnReader, binding: RuleBinding, digits: _Digits, alphabet: _Alphabet
) -> JointCells:
    """Cells that are letter classes, for a machine with very many letters."""
    layout, machine = reader.columns.layout, binding.rule.machine
    given = {digit.key: digit.values for digit in digits if isinstance(digit.values, np.ndarray)}
    numbers = _numbers(machine, digits, given, layout.n_states)
    # One more than the class, so that what is impossible is a cell, too.
    n_cells = len(machine.successors[0]) + 1
    cells = (alphabet.letters - IMPOSSIBLE).astype(smallest_unsigned(n_cells))
    return JointCells(
        layout, cells.take(numbers), [binding], [range(IMPOSSIBLE, n_cells + IMPOSSIBLE)]
    )
