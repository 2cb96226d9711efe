"""The numbers that stand for what reads may find: values by their places, and bounds of digits."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import exact
from rulec.trace import Value
from rulec.vocabulary import Declaration, Vocabulary
from rulec.vocabulary.vocabulary_model import values_of


def meanings_of(read: Read | NumberRead, vocabulary: Vocabulary) -> Sequence[int]:
    """The digits, as bits, that each number of a read stands for.

    A value's number is its place among those declared; the next number stands for unknown. A number
    whose digit lies between two is encoded as ``lowest * read.size + highest``.
    """
    every = (1 << read.size) - 1
    if isinstance(read, Read):
        values = values_of(vocabulary.declarations[read.name])
        return [*(1 << read.digit(value) for value in values), every]
    return [
        every >> low << low & (1 << high + 1) - 1
        for low in range(read.size)
        for high in range(read.size)
    ]


def number_of_value(
    read: Read | NumberRead, value: Value, vocabulary: Vocabulary
) -> tuple[int, int]:
    """The number that stands for unknown, and that of a value."""
    if isinstance(read, NumberRead):
        digit = read.digit(exact(value))  # type: ignore[arg-type]
        return read.size - 1, digit * (read.size + 1)
    return _number_of_word(vocabulary.declarations[read.name], value)


def _number_of_word(declaration: Declaration, value: Value) -> tuple[int, int]:
    values: Sequence[Value] = values_of(declaration)
    return len(values), values.index(value)
