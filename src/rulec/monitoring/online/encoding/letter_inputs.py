"""Distinct reads of rules, and their weights in a letter."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import scale
from rulec.monitoring.online.encoding.encoded_values import Breakpoints
from rulec.vocabulary import Enumeration, Vocabulary

DigitWeight: TypeAlias = Callable[[Any], int]
"""From an input's digit its weight in the number of a letter; LookupError if there is none."""


@dataclass(frozen=True, slots=True)
class MonitorInput:
    """Read of a rule, with variables given by their places.

    ``name`` is the declaration; None if ``number`` is a count or a sum, whose ``variables`` these
    are. A number's digit is how many thresholds it passes; that of anything else is its value.
    """

    name: str | None
    places: tuple[int, ...]
    number: NumberRead | None = None
    variables: tuple[str, ...] = ()

    def digit(self, encoded: Any, breakpoints: Breakpoints) -> Any:
        """Digit of an encoded value; counts and sums are their own.

        Raises a TypeError where a number is missing.
        """
        if self.name is None or self.number is None:
            return encoded
        floors = breakpoints[self.name]
        # A number has reached just these of its own floors that the highest one of all has reached.
        reached = encoded if floors is None else floors[encoded - 1]
        return bisect_right(scale(self.number).floors, reached)


def monitor_inputs(
    rule: CompiledRule, vocabulary: Vocabulary
) -> list[tuple[MonitorInput, DigitWeight]]:
    """The inputs of a rule, with the weights of their digits."""
    places = {variable.name: place for place, variable in enumerate(rule.variables)}

    def places_of(variables: Sequence[str]) -> tuple[int, ...]:
        return tuple([places[variable] for variable in variables])

    inputs: list[tuple[MonitorInput, DigitWeight]] = []
    stride = 1
    for read in rule.machine.reads:
        if isinstance(read, Read):
            declaration = vocabulary.declarations[read.name]
            values: Sequence[bool | str] = (
                declaration.values if isinstance(declaration, Enumeration) else (False, True)
            )
            weights = {value: stride * read.digit(value) for value in values}
            inputs.append((MonitorInput(read.name, places_of(read.variables)), weights.__getitem__))
        else:
            quantity, variables = scale(read).quantity, scale(read).variables
            if quantity is None:
                number = MonitorInput(None, places_of(variables), read, variables)
            else:
                number = MonitorInput(quantity.name, places_of(quantity.arguments), read)
            inputs.append((number, stride.__mul__))
        stride *= read.size
    return inputs
