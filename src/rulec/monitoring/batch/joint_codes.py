"""From columns to cells: one number for all that some tasks read of a state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod

import numpy as np

from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead
from rulec.automata.thresholds import scale
from rulec.monitoring.batch.column_reader import ColumnReader, NotGivenError
from rulec.monitoring.batch.rule_bindings import RuleBinding
from rulec.monitoring.batch.verdict_columns import Walk
from rulec.trace.trace_columns import Array, smallest_unsigned
from rulec.vocabulary import Enumeration, Vocabulary

MOST_CELLS = 1 << 16
"""More combinations of what is read than these are not told apart by one number."""

_BYTE = 256

_Key = tuple[object, ...]


@dataclass(frozen=True, slots=True, eq=False)
class _Digit:
    """A thing that is read: a column of numbers below ``size``, or one number for all states.

    ``meanings`` are the digits of a machine's letter that these numbers stand for.
    """

    key: _Key
    size: int
    values: Array | int
    meanings: Array


_Spelling = Sequence[_Digit]
"""The digits of the letters of a task's machine, in its order."""


@dataclass(frozen=True, slots=True, eq=False)
class _Alphabet:
    """A machine's classes of letters, and the ``meanings`` of each thing that it reads."""

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


def walks(
    reading: ColumnReader, tasks: Sequence[RuleBinding], vocabulary: Vocabulary
) -> Iterator[Walk]:
    """Walks on which all tasks can be judged. Raises NotGivenError.

    Tasks about the same objects on the same stretch share one, unless they read too much.
    """
    together: dict[_Key, list[RuleBinding]] = {}
    for task in tasks:
        together.setdefault((frozenset(task.objects.values()), *task.stretch), []).append(task)
    # Rules have many tasks: a machine's letters become an array once.
    rules = {id(task.rule): task.rule for task in tasks}
    known = {one: _alphabet(rule.machine, vocabulary) for one, rule in rules.items()}
    for group in together.values():
        alphabets = [known[id(task.rule)] for task in group]
        spellings = [
            _spelling(task, reading, alphabet)
            for task, alphabet in zip(group, alphabets, strict=True)
        ]
        if _size(_columns(spellings)) <= MOST_CELLS:
            yield _walk(reading, group, spellings, alphabets)
            continue
        for task, spelling, alphabet in zip(group, spellings, alphabets, strict=True):
            if _size(_columns([spelling])) <= MOST_CELLS:
                yield _walk(reading, [task], [spelling], [alphabet])
            else:
                yield _walk_of_classes(reading, task, spelling, alphabet)


def _spelling(task: RuleBinding, reading: ColumnReader, alphabet: _Alphabet) -> _Spelling:
    found = []
    for read, meanings in zip(task.rule.machine.reads, alphabet.meanings, strict=True):
        if isinstance(read, NumberRead):
            items = tuple([task.objects[one] for one in scale(read).variables])
            key: _Key = (read.terms, read.thresholds, scale(read).variables, items)
            found.append(_Digit(key, read.size, reading.digits(read, task.objects), meanings))
            continue
        items = tuple([task.objects[one] for one in read.variables])
        values = reading.values(read.name, items)
        if values is None:
            raise NotGivenError(read.name, items)
        column = values if isinstance(values, np.ndarray) else int(values)
        found.append(_Digit((read.name, items), len(meanings), column, meanings))
    return found


def _columns(spellings: Sequence[_Spelling]) -> Mapping[_Key, _Digit]:
    """All that is read and is not the same in all states."""
    return {
        digit.key: digit
        for spelling in spellings
        for digit in spelling
        if isinstance(digit.values, np.ndarray)
    }


def _size(columns: Mapping[_Key, _Digit]) -> int:
    return prod(one.size for one in columns.values())


def _walk(
    reading: ColumnReader,
    tasks: Sequence[RuleBinding],
    spellings: Sequence[_Spelling],
    alphabets: Sequence[_Alphabet],
) -> Walk:
    columns = _columns(spellings)
    strides: dict[_Key, int] = {}
    stride = 1
    for key, digit in columns.items():
        strides[key] = stride
        stride *= digit.size
    layout = reading.columns.layout
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
    said = {key: codes // strides[key] % digit.size for key, digit in columns.items()}
    letters = [
        alphabet.letters.take(_numbers(task.rule.machine, spelling, said, len(codes))).tolist()
        for task, spelling, alphabet in zip(tasks, spellings, alphabets, strict=True)
    ]
    return Walk(layout, cells, tasks, letters)


def _numbers(
    machine: MealyMonitor, spelling: _Spelling, said: Mapping[_Key, Array], n_codes: int
) -> Array:
    """For each code the letter that the machine reads; of its digits ``said`` has those that vary.

    They are numbers below the size of what is read.
    """
    numbers, stride = np.zeros(n_codes, dtype=np.int64), 1
    for digit, read in zip(spelling, machine.reads, strict=True):
        numbers += stride * digit.meanings.take(said.get(digit.key, digit.values))
        stride *= read.size
    return numbers


def _walk_of_classes(
    reading: ColumnReader, task: RuleBinding, spelling: _Spelling, alphabet: _Alphabet
) -> Walk:
    """For a machine with very many letters: its classes themselves are the cells."""
    layout, machine = reading.columns.layout, task.rule.machine
    given = {digit.key: digit.values for digit in spelling if isinstance(digit.values, np.ndarray)}
    numbers = _numbers(machine, spelling, given, layout.n_states)
    # One more than the class, so that what is impossible is a cell, too.
    n_cells = len(machine.successors[0]) + 1
    cells = (alphabet.letters - IMPOSSIBLE).astype(smallest_unsigned(n_cells))
    return Walk(layout, cells.take(numbers), [task], [range(IMPOSSIBLE, n_cells + IMPOSSIBLE)])
