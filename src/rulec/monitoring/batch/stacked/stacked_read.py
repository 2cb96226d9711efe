"""A read of a rule, and what numbers stand for what it may find."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import TypeAlias

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import ThresholdScale, exact, scale
from rulec.logic import formula as ltl
from rulec.trace import Value
from rulec.vocabulary import Declaration, Vocabulary
from rulec.vocabulary.vocabulary_model import values_of

ReadKeys: TypeAlias = dict[object, int]
"""Numbers of reads by what makes them equal, shared by all rules that are judged together."""


@dataclass(frozen=True, slots=True, eq=False)
class StackedRead:
    """A read, and the digits, as bits, that its numbers stand for; ``unknown`` means any digit.

    ``variables`` are the rule's variables that it is asked about, ``names`` what it depends on.
    ``count`` is the counted condition, if it is a count: of objects that any variable may stand for
    or, if it ``counts_itself``, of only the object that its one variable stands for. Reads with the
    same ``key`` have the same numbers; those with the same ``digits_key`` also the same digits.
    ``ready`` are the thresholds of a number. A read that ``is_composed`` depends on several values
    of an object: it is a sum, or counts itself. ``of_counts`` caches the digits of a count by the
    values of its ``names`` anywhere, as bits; ``of_met`` those of a signal by its own values.
    """

    read: Read | NumberRead
    variables: tuple[str, ...]
    names: tuple[str, ...]
    meanings: tuple[int, ...]
    unknown: int
    count: ltl.Count | None
    ready: ThresholdScale | None
    key: int
    digits_key: int
    is_composed: bool
    of_counts: dict[tuple[int | None, ...], int] = field(default_factory=dict, init=False)
    of_met: dict[int, int] = field(default_factory=dict, init=False)

    @property
    def every(self) -> int:
        """All digits."""
        return (1 << self.read.size) - 1

    def of_values(self, met: int) -> int:
        """The digits of some values of a signal, both as bits."""
        known = self.of_met.get(met)
        if known is None:
            known = 0
            for number in range(met.bit_length()):
                if met >> number & 1:
                    known |= self.meanings[number]
            self.of_met[met] = known
        return known

    def number_of(self, value: Value, declarations: Mapping[str, Declaration]) -> int:
        """The number that stands for a value."""
        if isinstance(self.read, NumberRead):
            return self.read.digit(exact(value)) * (self.read.size + 1)  # type: ignore[arg-type]
        values: Sequence[Value] = values_of(declarations[self.read.name])
        return values.index(value)

    @property
    def is_value(self) -> bool:
        """Whether it is a single value, not a sum or a count."""
        return self.ready is None or self.ready.quantity is not None

    @property
    def repeats(self) -> bool:
        """Whether a value is about two objects that are the same one."""
        own = self.read
        terms = (
            [own.variables]
            if isinstance(own, Read)
            else [term.arguments for _, term in own.terms if isinstance(term, ltl.QuantityTerm)]
        )
        return any(len(set(variables)) < len(variables) for variables in terms)

    @property
    def counts_itself(self) -> bool:
        """Whether only the object that it is asked about can count."""
        return self.count is not None and bool(self.variables)


def stacked_read(read: Read | NumberRead, vocabulary: Vocabulary, keys: ReadKeys) -> StackedRead:
    """A read of a rule, with a number among the ``keys``."""
    meanings = tuple(_meanings_of(read, vocabulary))
    count: ltl.Count | None = None
    key: object
    names: tuple[str, ...]
    if isinstance(read, Read):
        unknown = len(values_of(vocabulary.declarations[read.name]))
        ready, variables, names = None, read.variables, (read.name,)
        key = read.name, len(read.variables)
    else:
        unknown, ready = read.size - 1, scale(read)
        variables, names = tuple(dict.fromkeys(ready.variables)), ready.names
        term = ready.quantity
        key = id(read) if term is None else (term.name, len(term.arguments), ready.floors)
        counts = [term for _, term in read.terms if isinstance(term, ltl.Count)]
        count = counts[0] if len(read.terms) == 1 and counts else None
    return StackedRead(
        read,
        variables,
        names,
        meanings=meanings,
        unknown=unknown,
        count=count,
        ready=ready,
        key=keys.setdefault(key, len(keys)),
        digits_key=keys.setdefault((key, meanings), len(keys)),
        is_composed=bool(variables) and ready is not None and ready.quantity is None,
    )


def _meanings_of(read: Read | NumberRead, vocabulary: Vocabulary) -> Sequence[int]:
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
