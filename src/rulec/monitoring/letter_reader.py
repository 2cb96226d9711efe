"""Reader of the letters of a rule's machine for bound objects."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule
from rulec.automata.mealy_monitor import IMPOSSIBLE, Read
from rulec.automata.thresholds import ThresholdScale, scale
from rulec.diagnostics import RulecError, SourceLocation
from rulec.logic.kleene import Unknown, weighted_sum
from rulec.monitoring.axiom_violations import impossible_state
from rulec.monitoring.monitoring_messages import MISSING_VALUE
from rulec.monitoring.state_view import StateView
from rulec.trace import State, Value
from rulec.vocabulary import Vocabulary

NO_OBJECTS: Mapping[str, str] = MappingProxyType({})
ALWAYS_PRESENT: Mapping[str, tuple[int, int]] = MappingProxyType({})


Digits = int | list[int]
"""The digit of one read in the letter of every state; a number if it is one for all."""


class LetterReader:
    """A reader of states that have passed ``check_state``, column by column.

    The digits of some objects are looked up once, whatever rules and bindings ask for them.
    ``where`` names a state in messages, ``place`` is where they were read. ``objects`` and
    ``present`` are a trace's, ``axioms`` the rulebook's.
    """

    def __init__(
        self,
        states: Sequence[State],
        vocabulary: Vocabulary,
        where: Callable[[int], str],
        *,
        place: SourceLocation | None = None,
        objects: Mapping[str, str] = NO_OBJECTS,
        present: Mapping[str, tuple[int, int]] = ALWAYS_PRESENT,
        axioms: Sequence[CompiledAxiom] = (),
    ) -> None:
        self._states = states
        self._vocabulary = vocabulary
        self._where = where
        self._place = place
        self._objects = objects
        self._present = present
        self._axioms = axioms
        self._values: dict[tuple[object, ...], list[Value]] = {}
        self._digits_of_reads: dict[tuple[object, ...], Digits] = {}
        self._given: dict[str, list[Any]] = {}
        self._constant: dict[str, bool] = {}
        self._views: dict[int, StateView] = {}

    def view(self, number: int) -> StateView:
        """A state with the objects that are present."""
        if number not in self._views:
            present = present_in(number, self._objects, self._present)
            self._views[number] = StateView(self._states[number], present, self._vocabulary)
        return self._views[number]

    def word(
        self, rule: CompiledRule, objects: Mapping[str, str], first: int, last: int
    ) -> tuple[int, ...]:
        """The letter classes of states ``first`` to ``last`` (inclusive).

        Raises:
            RulecError: R0504 if a value is missing that has no default, R0508 if a state cannot be.
        """
        machine = rule.machine
        same, stride = 0, 1
        varying: list[int] | None = None
        for read in machine.reads:
            if isinstance(read, Read):
                items = tuple([objects[variable] for variable in read.variables])
                digits = self._digits(read, items, first, last, rule.name)
            else:
                digits = self._number_digits(scale(read), objects, first, last, rule.name)
            if isinstance(digits, int):
                same += stride * digits
            elif varying is None:
                varying = [stride * digit for digit in digits]
            else:
                varying = [n + stride * digit for n, digit in zip(varying, digits, strict=True)]
            stride *= read.size
        if varying is None:
            word = (machine.letters[same],) * (last - first + 1)
        else:
            word = tuple([machine.letters[same + number] for number in varying])
        if IMPOSSIBLE in word:
            number = first + word.index(IMPOSSIBLE)
            raise impossible_state(
                rule,
                objects,
                self._axioms,
                self.view(number),
                number=number,
                where=self._where(number),
                place=self._place,
            )
        return word

    def _digits(
        self, read: Read, items: tuple[str, ...], first: int, last: int, rule: str
    ) -> Digits:
        # Rules tell different values apart, so a column is known by the whole read, bar variables.
        key = (read.name, read.values, items, first, last)
        if key not in self._digits_of_reads:
            values = self._values_of(read.name, items, first, last, rule)
            digits = {value: read.digit(value) for value in set(values)}
            self._digits_of_reads[key] = _digits([digits[value] for value in values])
        return self._digits_of_reads[key]

    def _values_of(
        self, name: str, items: tuple[str, ...], first: int, last: int, rule: str
    ) -> list[Value]:
        """Values of a name by state; a single one if constant."""
        key = (name, items, first, last)
        if key not in self._values:
            numbers = self._numbers_of((name,), first, last)
            given: Iterable[Any] = self._given_by_states(name)[numbers.start : numbers.stop]
            for item in items:
                given = [None if inner is None else inner.get(item) for inner in given]
            default = self._vocabulary.declarations[name].default
            values: list[Any] = [default if value is None else value for value in given]
            if None in values:
                raise self._missing(name, items, numbers[values.index(None)], rule)
            self._values[key] = values
        return self._values[key]

    def _given_by_states(self, name: str) -> list[Any]:
        """The value that each state gives for a name, None if nothing."""
        if name not in self._given:
            self._given[name] = [state.get(name) for state in self._states]
        return self._given[name]

    def _number_digits(
        self, read: ThresholdScale, objects: Mapping[str, str], first: int, last: int, rule: str
    ) -> Digits:
        """The digits of a number, which are how many thresholds it passes."""
        items = tuple([objects[variable] for variable in read.variables])
        key = (read, items, first, last)
        if key not in self._digits_of_reads:
            if read.quantity is None:
                numbers = self._numbers_of(read.names, first, last)
                bound = dict(zip(read.variables, items, strict=True))
                self._digits_of_reads[key] = _digits(
                    self._digit(read, bound, n, rule) for n in numbers
                )
            else:
                name = read.quantity.name
                arguments = tuple([objects[variable] for variable in read.quantity.arguments])
                values = self._values_of(name, arguments, first, last, rule)
                self._digits_of_reads[key] = _digits(read.digit(value) for value in values)
        return self._digits_of_reads[key]

    def _numbers_of(self, names: Sequence[str], first: int, last: int) -> range:
        """Indices of the states to read; the first if all are identical."""
        if self._present or not all(self._is_constant(name) for name in names):
            return range(first, last + 1)
        return range(first, last + 1)[:1]

    def _is_constant(self, name: str) -> bool:
        """Tell whether all states share one value object for a name."""
        if name not in self._constant:
            given = self._given_by_states(name)
            self._constant[name] = all(value is given[0] for value in given)
        return self._constant[name]

    def _digit(self, read: ThresholdScale, bound: Mapping[str, str], number: int, rule: str) -> int:
        total = weighted_sum(read.read.terms, bound, self.view(number))
        if isinstance(total, Unknown):
            raise self._missing(total.name, total.objects, number, rule)
        return read.read.digit(total)

    def _missing(self, name: str, items: tuple[str, ...], number: int, rule: str) -> RulecError:
        of = f" of `{', '.join(items)}`" if items else ""
        return MISSING_VALUE.error(
            self._place,
            f"{self._where(number)} does not say the `{name}`{of}, which rule `{rule}` needs",
            help="supply it in every state, or declare a default in the vocabulary",
        )


def _digits(column: Iterable[int]) -> Digits:
    digits = list(column)
    return digits[0] if len(set(digits)) == 1 else digits


def present_in(
    number: int, objects: Mapping[str, str], present: Mapping[str, tuple[int, int]]
) -> Mapping[str, str]:
    """Objects present in a state, with types; ``present`` as in a trace."""
    if not present:
        return objects
    return {
        name: kind
        for name, kind in objects.items()
        if name not in present or present[name][0] <= number <= present[name][1]
    }
