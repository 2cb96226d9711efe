"""What one read of a machine adds to the number of a letter: its digit times its stride."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import partial
from itertools import repeat
from typing import Any, TypeAlias

from rulec.automata.machine import Machine, NumberRead, Read
from rulec.runtime.numbers import EXACT_IN_FLOATS, Scale, scale
from rulec.vocabulary import Declaration, Enumeration, Vocabulary

WeighOne: TypeAlias = Callable[[Any], int]
WeighMany: TypeAlias = Callable[[Sequence[Any]], Iterable[int]]


@dataclass(frozen=True, slots=True, eq=False)
class Weighing:
    """A read, ready for any objects.

    ``name`` is the declaration that it reads, asked about ``variables`` of the rule; if it is
    ``None``, ``computed`` says what has to be counted or added up. ``one`` weighs a value that
    passed ``check_state``, ``many`` several; both raise a LookupError or a TypeError if there is
    none. ``digits`` are the weights of all values if there are only a few.
    """

    name: str | None
    variables: tuple[str, ...]
    one: WeighOne
    many: WeighMany
    computed: NumberRead | None = None
    digits: Mapping[Any, int] | None = None


def weighings(machine: Machine, vocabulary: Vocabulary) -> Iterator[Weighing]:
    """Those of a machine's reads."""
    stride = 1
    for read in machine.reads:
        if isinstance(read, Read):
            yield _state(read, vocabulary.declarations[read.name], stride)
        else:
            yield _number(scale(read), stride)
        stride *= read.size


def _state(read: Read, declaration: Declaration, stride: int) -> Weighing:
    values: tuple[bool | str, ...] = (
        declaration.values if isinstance(declaration, Enumeration) else (False, True)
    )
    weights = {value: stride * read.digit(value) for value in values}
    weigh = weights.__getitem__
    return Weighing(read.name, read.variables, weigh, partial(map, weigh), digits=weights)


def _number(about: Scale, stride: int) -> Weighing:
    if about.quantity is None:
        counted_off = about.read.digit

        def weigh(value: Fraction) -> int:
            return stride * counted_off(value)

        return Weighing(None, about.variables, weigh, partial(map, weigh), about.read)

    def one(value: float) -> int:
        return stride * about.digit(value)

    def many(values: Sequence[float]) -> Iterable[int]:
        if min(values) >= -EXACT_IN_FLOATS and max(values) <= EXACT_IN_FLOATS:
            return map(weights.__getitem__, map(bisect_right, repeat(about.floors), values))
        return map(one, values)

    weights = [stride * digit for digit in range(about.read.size)]
    return Weighing(about.quantity.name, about.quantity.arguments, one, many)
