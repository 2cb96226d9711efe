"""Which letters a rule's machine reads, for the objects that it is bound to."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

from rulec.automata.compiled import CompiledRule
from rulec.automata.machine import Read
from rulec.diagnostics import Diagnostic, Place, RulecError
from rulec.trace import State, Value
from rulec.vocabulary import Declaration, Vocabulary


class Columns:
    """States that have passed ``check_state``, read column by column.

    What some objects contribute to letters is looked up once, whatever rules and bindings ask.
    ``where`` names a state in messages, ``place`` is where they were read.
    """

    def __init__(
        self,
        states: Sequence[State],
        vocabulary: Vocabulary,
        where: Callable[[int], str],
        place: Place | None = None,
    ) -> None:
        self._states = states
        self._vocabulary = vocabulary
        self._where = where
        self._place = place
        self._known: dict[tuple[object, ...], list[int]] = {}

    def word(
        self, rule: CompiledRule, objects: Mapping[str, str], first: int, last: int
    ) -> tuple[int, ...]:
        """The letter classes of states ``first`` to ``last`` (inclusive).

        Raises:
            RulecError: R0504 if a value is missing that has no default.
        """
        machine = rule.machine
        numbers, stride = [0] * (last - first + 1), 1
        for read in machine.reads:
            items = tuple([objects[variable] for variable in read.variables])
            digits = self._digits(read, items, first, last, rule.name)
            numbers = [n + stride * digit for n, digit in zip(numbers, digits, strict=True)]
            stride *= read.size
        return tuple([machine.letters[number] for number in numbers])

    def _digits(
        self, read: Read, items: tuple[str, ...], first: int, last: int, rule: str
    ) -> list[int]:
        # Rules tell different values apart, so a column is known by the whole read, bar variables.
        key = (read.name, read.values, items, first, last)
        if key not in self._known:
            declaration = self._vocabulary.declarations[read.name]
            self._known[key] = [
                self._digit(read, items, number, declaration, rule)
                for number in range(first, last + 1)
            ]
        return self._known[key]

    def _digit(
        self, read: Read, items: tuple[str, ...], number: int, declaration: Declaration, rule: str
    ) -> int:
        value = value_in(self._states[number], read.name, items, declaration)
        if value is None:
            of = f" of `{', '.join(items)}`" if items else ""
            raise RulecError(
                Diagnostic(
                    "R0504",
                    f"{self._where(number)} does not say the `{read.name}`{of}, "
                    f"which rule `{rule}` needs",
                    self._place,
                    help="supply it in every state, or declare a default in the vocabulary",
                )
            )
        return read.digit(value)


def value_in(
    state: State, name: str, objects: Sequence[str], declaration: Declaration
) -> Value | None:
    """The value that a state gives, or the declared default; None if there is neither."""
    value: Any = state.get(name)
    for item in objects:
        value = value.get(item) if value is not None else None
    return declaration.default if value is None else value
