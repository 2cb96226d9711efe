"""From columns to cells: one number for all that some tasks read of a state."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from math import prod

import numpy as np

from rulec.automata.machine import IMPOSSIBLE, NumberRead
from rulec.runtime.batch.judged import Walk
from rulec.runtime.batch.reading import NotGivenError, Reading
from rulec.runtime.batch.tasks import Task
from rulec.runtime.numbers import scale
from rulec.trace.columns import Array, smallest_unsigned
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
    meanings: Sequence[int]


_Spelling = Sequence[_Digit]
"""The digits of the letters of a task's machine, in its order."""


def walks(reading: Reading, tasks: Sequence[Task], vocabulary: Vocabulary) -> Iterator[Walk]:
    """Walks on which all tasks can be judged. Raises NotGivenError.

    Tasks about the same objects on the same stretch share one, unless they read too much.
    """
    together: dict[_Key, list[Task]] = {}
    for task in tasks:
        together.setdefault((frozenset(task.objects.values()), *task.stretch), []).append(task)
    for group in together.values():
        spellings = [_spelling(task, reading, vocabulary) for task in group]
        if _size(_columns(spellings)) <= MOST_CELLS:
            yield _walk(reading, group, spellings)
            continue
        for task, spelling in zip(group, spellings, strict=True):
            if _size(_columns([spelling])) <= MOST_CELLS:
                yield _walk(reading, [task], [spelling])
            else:
                yield _walk_of_classes(reading, task, spelling)


def _spelling(task: Task, reading: Reading, vocabulary: Vocabulary) -> _Spelling:
    found = []
    for read in task.rule.machine.reads:
        if isinstance(read, NumberRead):
            items = tuple([task.objects[one] for one in scale(read).variables])
            key: _Key = (read.terms, read.thresholds, scale(read).variables, items)
            digits = reading.digits(read, task.objects)
            found.append(_Digit(key, read.size, digits, range(read.size)))
            continue
        items = tuple([task.objects[one] for one in read.variables])
        values = reading.values(read.name, items)
        if values is None:
            raise NotGivenError(read.name, items)
        declaration = vocabulary.declarations[read.name]
        names = declaration.values if isinstance(declaration, Enumeration) else (False, True)
        meanings = [read.digit(name) for name in names]
        column = values if isinstance(values, np.ndarray) else int(values)
        found.append(_Digit((read.name, items), len(names), column, meanings))
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


def _walk(reading: Reading, tasks: Sequence[Task], spellings: Sequence[_Spelling]) -> Walk:
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
    letters = [
        _letters(task, spelling, strides, codes)
        for task, spelling in zip(tasks, spellings, strict=True)
    ]
    return Walk(layout, cells, tasks, letters)


def _letters(
    task: Task, spelling: _Spelling, strides: Mapping[_Key, int], codes: Array
) -> list[int]:
    """For each code the class of the letter that the task's machine reads."""
    numbers, stride = np.zeros(len(codes), dtype=np.int64), 1
    machine = task.rule.machine
    for digit, read in zip(spelling, machine.reads, strict=True):
        if isinstance(digit.values, np.ndarray):
            meant: Array | int = np.take(digit.meanings, codes // strides[digit.key] % digit.size)
        else:
            meant = digit.meanings[digit.values]
        numbers += stride * meant
        stride *= read.size
    classes: list[int] = np.take(machine.letters, numbers).tolist()
    return classes


def _walk_of_classes(reading: Reading, task: Task, spelling: _Spelling) -> Walk:
    """For a machine with very many letters: its classes themselves are the cells."""
    layout, machine = reading.columns.layout, task.rule.machine
    numbers, stride = np.zeros(layout.n_states, dtype=np.int64), 1
    for digit, read in zip(spelling, machine.reads, strict=True):
        numbers += stride * np.take(digit.meanings, digit.values)
        stride *= read.size
    # One more than the class, so that what is impossible is a cell, too.
    n_cells = len(machine.following[0]) + 1
    cells = (np.array(machine.letters) - IMPOSSIBLE).astype(smallest_unsigned(n_cells))
    return Walk(layout, cells.take(numbers), [task], [range(IMPOSSIBLE, n_cells + IMPOSSIBLE)])
