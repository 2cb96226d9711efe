"""Which letters a rule's machine reads, for the objects that it is bound to."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule
from rulec.automata.mealy_monitor import IMPOSSIBLE, Read
from rulec.automata.thresholds import ThresholdScale, scale
from rulec.diagnostics import RulecError, SourceLocation
from rulec.logic.kleene import Unknown, weighted_sum
from rulec.monitoring.axioms import impossible
from rulec.monitoring.monitoring_messages import MISSING_VALUE
from rulec.monitoring.state_view import StateView
from rulec.trace import State, Value
from rulec.vocabulary import Vocabulary

NOBODY: Mapping[str, str] = MappingProxyType({})
ALWAYS_THERE: Mapping[str, tuple[int, int]] = MappingProxyType({})


Digits = int | list[int]
"""What one read contributes to the letter of every state; a number if it is one for all."""


class LetterReader:
    """States that have passed ``check_state``, read column by column.

    What some objects contribute to letters is looked up once, whatever rules and bindings ask.
    ``where`` names a state in messages, ``place`` is where they were read. ``objects`` and
    ``present`` are a trace's, ``facts`` what the rulebook knows of every state.
    """

    def __init__(
        self,
        states: Sequence[State],
        vocabulary: Vocabulary,
        where: Callable[[int], str],
        place: SourceLocation | None = None,
        objects: Mapping[str, str] = NOBODY,
        present: Mapping[str, tuple[int, int]] = ALWAYS_THERE,
        axioms: Sequence[CompiledAxiom] = (),
    ) -> None:
        self._states = states
        self._vocabulary = vocabulary
        self._where = where
        self._place = place
        self._objects = objects
        self._present = present
        self._facts = axioms
        self._values: dict[tuple[object, ...], list[Value]] = {}
        self._known: dict[tuple[object, ...], Digits] = {}
        self._given: dict[str, list[Any]] = {}
        self._one: dict[str, bool] = {}
        self._moments: dict[int, StateView] = {}

    def moment(self, number: int) -> StateView:
        """A state with the objects that are there."""
        if number not in self._moments:
            there = present_in(number, self._objects, self._present)
            self._moments[number] = StateView(self._states[number], there, self._vocabulary)
        return self._moments[number]

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
                digits = self._counted_off(scale(read), objects, first, last, rule.name)
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
            where = self._where(number)
            there = self.moment(number)
            raise impossible(rule, objects, self._facts, there, number, where, self._place)
        return word

    def _digits(
        self, read: Read, items: tuple[str, ...], first: int, last: int, rule: str
    ) -> Digits:
        # Rules tell different values apart, so a column is known by the whole read, bar variables.
        key = (read.name, read.values, items, first, last)
        if key not in self._known:
            values = self._told(read.name, items, first, last, rule)
            digits = {value: read.digit(value) for value in set(values)}
            self._known[key] = _digits([digits[value] for value in values])
        return self._known[key]

    def _told(
        self, name: str, items: tuple[str, ...], first: int, last: int, rule: str
    ) -> list[Value]:
        """What states say of a name; one value for all, if they say the very same."""
        key = (name, items, first, last)
        if key not in self._values:
            numbers = self._telling((name,), first, last)
            found: Iterable[Any] = self._said(name)[numbers.start : numbers.stop]
            for item in items:
                found = [None if inner is None else inner.get(item) for inner in found]
            default = self._vocabulary.declarations[name].default
            values: list[Any] = [default if value is None else value for value in found]
            if None in values:
                raise self._missing(name, items, numbers[values.index(None)], rule)
            self._values[key] = values
        return self._values[key]

    def _said(self, name: str) -> list[Any]:
        """What each state gives for a name, None if nothing."""
        if name not in self._given:
            self._given[name] = [state.get(name) for state in self._states]
        return self._given[name]

    def _counted_off(
        self, read: ThresholdScale, objects: Mapping[str, str], first: int, last: int, rule: str
    ) -> Digits:
        """The digits of a number: how many thresholds it passes."""
        items = tuple([objects[variable] for variable in read.variables])
        key = (read, items, first, last)
        if key not in self._known:
            if read.quantity is None:
                numbers = self._telling(read.names, first, last)
                bound = dict(zip(read.variables, items, strict=True))
                self._known[key] = _digits(self._digit(read, bound, n, rule) for n in numbers)
            else:
                name = read.quantity.name
                arguments = tuple([objects[variable] for variable in read.quantity.arguments])
                values = self._told(name, arguments, first, last, rule)
                self._known[key] = _digits(read.digit(value) for value in values)
        return self._known[key]

    def _telling(self, names: Sequence[str], first: int, last: int) -> range:
        """Of these states enough to know what all say of some names: one, if it is in all."""
        if self._present or not all(self._is_one(name) for name in names):
            return range(first, last + 1)
        return range(first, last + 1)[:1]

    def _is_one(self, name: str) -> bool:
        """Do all states say the very same of a name, or nothing? As cells do of a whole scene."""
        if name not in self._one:
            self._one[name] = len(set(map(id, self._said(name)))) <= 1
        return self._one[name]

    def _digit(self, read: ThresholdScale, bound: Mapping[str, str], number: int, rule: str) -> int:
        found = weighted_sum(read.read.terms, bound, self.moment(number))
        if isinstance(found, Unknown):
            raise self._missing(found.name, found.objects, number, rule)
        return read.read.digit(found)

    def _missing(self, name: str, items: tuple[str, ...], number: int, rule: str) -> RulecError:
        of = f" of `{', '.join(items)}`" if items else ""
        return MISSING_VALUE.error(
            self._place,
            f"{self._where(number)} does not say the `{name}`{of}, which rule `{rule}` needs",
            help="supply it in every state, or declare a default in the vocabulary",
        )


def _digits(column: Iterable[int]) -> Digits:
    found = list(column)
    return found[0] if len(set(found)) == 1 else found


def present_in(
    number: int, objects: Mapping[str, str], present: Mapping[str, tuple[int, int]]
) -> Mapping[str, str]:
    """The objects that are there in a state, with their types; ``present`` as in a trace."""
    if not present:
        return objects
    return {
        name: kind
        for name, kind in objects.items()
        if name not in present or present[name][0] <= number <= present[name][1]
    }
