"""Reader of the letters of a rule's machine for bound objects."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import KW_ONLY, dataclass, field
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import IMPOSSIBLE, NumberRead, Read
from rulec.automata.thresholds import scale
from rulec.diagnostics import RulecError, SourceLocation
from rulec.logic.kleene import Unknown, weighted_sum
from rulec.monitoring.axiom_violations import StatePlace, impossible_state
from rulec.monitoring.monitoring_messages import MISSING_VALUE
from rulec.monitoring.state_view import StateView
from rulec.trace import State, Value
from rulec.trace.trace_model import present_in

Digits = int | list[int]
"""The digits of one read in all states; a single number if they are equal."""


@dataclass(eq=False)
class LetterReader:
    """A reader, column by column, of states that have passed ``check_state``.

    The digits for some objects are computed once for all rules and bindings. ``where`` names a
    state in messages, ``place`` is where the states were read. ``objects`` and ``present`` are
    those of a trace.
    """

    states: Sequence[State]
    rulebook: CompiledRulebook
    where: Callable[[int], str]
    _: KW_ONLY
    place: SourceLocation | None = None
    objects: Mapping[str, str] = field(default_factory=dict)
    present: Mapping[str, tuple[int, int]] = field(default_factory=dict)

    def __post_init__(self) -> None:
        self._values: dict[tuple[object, ...], list[Value]] = {}
        self._digits_of_reads: dict[tuple[object, ...], Digits] = {}
        self._given: dict[str, list[Any]] = {}
        self._constant: dict[str, bool] = {}
        self._views: dict[int, StateView] = {}

    def view(self, number: int) -> StateView:
        """A state with the objects that are present."""
        if number not in self._views:
            present = present_in(number, self.objects, self.present)
            self._views[number] = StateView(self.states[number], present, self.rulebook.vocabulary)
        return self._views[number]

    def word(
        self, rule: CompiledRule, objects: Mapping[str, str], first: int, last: int
    ) -> tuple[int, ...]:
        """The letter classes of states ``first`` to ``last`` (inclusive).

        Raises RulecError R0504 if a value without default is missing, R0508 if a state is
        impossible.
        """
        machine = rule.machine
        same, stride = 0, 1
        varying: list[int] | None = None
        for read in machine.reads:
            digits = self.digits(read, objects, (first, last), rule.name)
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
            types = {objects[variable.name]: variable.type for variable in rule.variables}
            place = StatePlace(number, self.where(number), self.place)
            raise impossible_state(rule, types, self.rulebook.axioms, self.view(number), place)
        return word

    def digits(
        self,
        read: Read | NumberRead,
        objects: Mapping[str, str],
        stretch: tuple[int, int],
        rule: str,
    ) -> Digits:
        """The digits of one read in the states of a stretch, both ends included.

        Raises RulecError R0504 if a value without default is missing.
        """
        first, last = stretch
        # Rules distinguish different values, so the key is the whole read without variables.
        about = read if isinstance(read, Read) else scale(read)
        items = tuple([objects[variable] for variable in about.variables])
        kind = (about.name, about.values) if isinstance(about, Read) else about
        key = (kind, items, first, last)
        digits = self._digits_of_reads.get(key)
        if digits is None:
            if isinstance(about, Read):
                values = self._values_of(about.name, items, first, last, rule)
                digit_of = {value: about.digit(value) for value in set(values)}
                column = [digit_of[value] for value in values]
            elif about.quantity is None:
                bound = dict(zip(about.variables, items, strict=True))
                numbers = self._numbers_of(about.names, first, last)
                column = [self._digit(about.read, bound, number, rule) for number in numbers]
            else:
                arguments = tuple([objects[variable] for variable in about.quantity.arguments])
                values = self._values_of(about.quantity.name, arguments, first, last, rule)
                column = [about.digit(value) for value in values]
            digits = column[0] if len(set(column)) == 1 else column
            self._digits_of_reads[key] = digits
        return digits

    def _values_of(
        self, name: str, items: tuple[str, ...], first: int, last: int, rule: str
    ) -> list[Value]:
        """The values of a name by state; a single one if it is constant."""
        key = (name, items, first, last)
        if key not in self._values:
            numbers = self._numbers_of((name,), first, last)
            given: Iterable[Any] = self._given_by_states(name)[numbers.start : numbers.stop]
            for item in items:
                given = [None if inner is None else inner.get(item) for inner in given]
            default = self.rulebook.vocabulary.declarations[name].default
            values: list[Any] = [default if value is None else value for value in given]
            if None in values:
                raise self._missing(name, items, numbers[values.index(None)], rule)
            self._values[key] = values
        return self._values[key]

    def _given_by_states(self, name: str) -> list[Any]:
        if name not in self._given:
            self._given[name] = [state.get(name) for state in self.states]
        return self._given[name]

    def _numbers_of(self, names: Sequence[str], first: int, last: int) -> range:
        """The indices of the states to read; only the first if all states are identical."""
        if self.present or not all(self._is_constant(name) for name in names):
            return range(first, last + 1)
        return range(first, last + 1)[:1]

    def _is_constant(self, name: str) -> bool:
        if name not in self._constant:
            given = self._given_by_states(name)
            self._constant[name] = all(value is given[0] for value in given)
        return self._constant[name]

    def _digit(self, read: NumberRead, bound: Mapping[str, str], number: int, rule: str) -> int:
        total = weighted_sum(read.terms, bound, self.view(number))
        if isinstance(total, Unknown):
            raise self._missing(total.name, total.objects, number, rule)
        return read.digit(total)

    def _missing(self, name: str, items: tuple[str, ...], number: int, rule: str) -> RulecError:
        return missing_value((name, items), self.where(number), rule, self.place)


def missing_value(
    subject: tuple[str, tuple[str, ...]], where: str, rule: str, place: SourceLocation | None
) -> RulecError:
    """The error (R0504) about a state that lacks the value of a name for some objects."""
    name, items = subject
    of = f" of `{', '.join(map(str, items))}`" if items else ""  # a program may count its objects
    return MISSING_VALUE.error(
        place,
        f"{where} does not say the `{name}`{of}, which rule `{rule}` needs",
        help="say it in every state, `null` where it is not known, or declare a default for it",
    )
