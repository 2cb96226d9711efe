"""What rules read of a state, each thing once, and what it adds to the number of a letter."""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import scale
from rulec.monitoring.online.breakpoints import Floors
from rulec.vocabulary import Enumeration, Vocabulary

Weigh: TypeAlias = Callable[[Any], int]
"""From the digit of an input its weight in the number of a letter; LookupError if there is none."""


@dataclass(frozen=True, slots=True)
class Input:
    """Something that is read about variables, given by their places among the rule's variables.

    ``name`` is the declaration; None if ``number`` is a count or a sum, whose ``variables`` these
    are. A number's digit is how many thresholds it passes; that of anything else is its value.
    """

    name: str | None
    places: tuple[int, ...]
    number: NumberRead | None = None
    variables: tuple[str, ...] = ()

    def digit(self, told: Any, floors: Floors) -> Any:
        """Its digit, by what is told of it; of a count or a sum this is the digit.

        Raises a TypeError where a number is missing.
        """
        if self.name is None or self.number is None:
            return told
        those = floors[self.name]
        # A number has reached just these of its own floors that the highest one of all has reached.
        reached = told if those is None else those[told - 1]
        return bisect_right(scale(self.number).floors, reached)


def inputs_of(rule: CompiledRule, vocabulary: Vocabulary) -> list[tuple[Input, Weigh]]:
    """What a rule reads, and what each digit weighs for it."""
    places = {variable.name: place for place, variable in enumerate(rule.variables)}
    found: list[tuple[Input, Weigh]] = []
    stride = 1
    for read in rule.machine.reads:
        if isinstance(read, Read):
            about = tuple([places[variable] for variable in read.variables])
            declaration = vocabulary.declarations[read.name]
            values: Sequence[bool | str] = (
                declaration.values if isinstance(declaration, Enumeration) else (False, True)
            )
            weights = {value: stride * read.digit(value) for value in values}
            found.append((Input(read.name, about), weights.__getitem__))
        else:
            about_it = scale(read)
            if about_it.quantity is None:
                names = about_it.variables
                input_ = Input(None, tuple([places[one] for one in names]), read, names)
            else:
                names = about_it.quantity.arguments
                about = tuple([places[one] for one in names])
                input_ = Input(about_it.quantity.name, about, read)
            found.append((input_, stride.__mul__))
        stride *= read.size
    return found
