"""The letters that a rule's machine may read in each state, where values are not all known."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom, CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import scale
from rulec.diagnostics import RulecError
from rulec.logic import formula as ltl
from rulec.logic.free_names import names_in
from rulec.logic.kleene import Between, Unknown, holds, weighted_sum
from rulec.monitoring.axiom_violations import StatePlace, impossible_state
from rulec.monitoring.letter_reader import missing_value, present_in
from rulec.monitoring.state_view import StateView
from rulec.monitoring.uncertainty.completions import (
    MissingValueError,
    PossibleDigits,
    joint_digits,
    unknown_in_read,
)
from rulec.monitoring.uncertainty.entanglement import Entanglement, NothingKnown, entanglement
from rulec.monitoring.uncertainty.letter_classes import Letters
from rulec.trace import Trace
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval, PartialValue


@dataclass(frozen=True, slots=True)
class PossibleWord:
    """The letters that a rule may read of its objects, state by state.

    ``unknown`` are, for each read, the names of values of which some are unknown. ``exact`` is
    false if there are letters that are not possible, because there was too much to look at.
    """

    states: tuple[Letters, ...]
    unknown: tuple[frozenset[str], ...]
    exact: bool = True


def untold_names(vocabulary: Vocabulary, told: frozenset[str] | None) -> frozenset[str]:
    """The names that a source which tells these cannot tell, and that are not presumed."""
    if told is None:
        return frozenset()
    names = vocabulary.declarations.items()
    return frozenset(name for name, item in names if name not in told and not item.presumed)


def with_untold(vocabulary: Vocabulary, untold: frozenset[str]) -> Vocabulary:
    """The vocabulary in which untold names are unknown where no state says them."""
    unknown: Any = UNKNOWN
    declarations = {
        name: replace(item, default=unknown) if name in untold else item
        for name, item in vocabulary.declarations.items()
    }
    return Vocabulary(vocabulary.name, vocabulary.types, declarations)


class PossibleLetters:
    """A reader of the possible letters of a checked trace.

    ``states`` stand for the trace's own, in which more may be supposed. ``vocabulary`` has the
    defaults of what they do not say.
    """

    def __init__(
        self,
        trace: Trace,
        rulebook: CompiledRulebook,
        vocabulary: Vocabulary,
        where: Callable[[int], str] = "state {}".format,
        *,
        entangled: dict[tuple[str, tuple[str, ...]], Entanglement] | None = None,
    ) -> None:
        self._trace = trace
        self._rulebook = rulebook
        self._vocabulary = vocabulary
        self._where = where
        self._views: dict[int, StateView] = {}
        self._given: dict[tuple[str, tuple[str, ...]], list[PartialValue | None]] = {}
        self._columns: dict[tuple[object, ...], tuple[list[int], bool]] = {}
        self._joint: dict[str, bool] = {}
        self._entangled = {} if entangled is None else entangled

    def view(self, number: int) -> StateView:
        """A state with the objects that are present."""
        if number not in self._views:
            trace = self._trace
            present = present_in(number, trace.objects, trace.present)
            self._views[number] = StateView(trace.states[number], present, self._vocabulary)
        return self._views[number]

    def word(
        self, rule: CompiledRule, objects: Mapping[str, str], first: int, last: int
    ) -> PossibleWord:
        """The letters of states ``first`` to ``last`` (inclusive).

        Raises RulecError R0504 if a value without default is missing, R0508 if a state cannot be.
        """
        reads = rule.machine.reads
        columns, unknown = [], []
        for read in reads:
            masks, some = self._masks(read, objects, (first, last), rule.name)
            columns.append(masks)
            unknown.append(
                self._unknown_names(read, objects, (first, last)) if some else frozenset()
            )
        states: list[Letters] = [(cube,) for cube in zip(*columns, strict=True)]
        states = states or [((),)] * (last - first + 1)
        is_exact = True
        if any(unknown) and self._is_joint(rule):
            about = self._entanglement(rule, objects)
            for index, (cube,) in enumerate(states):
                if all(mask & (mask - 1) == 0 for mask in cube):
                    continue
                if not about.is_met(self.view(first + index)):
                    continue
                joint = self._joint_digits(rule, objects, first + index)
                is_exact &= joint.exact
                states[index] = tuple(
                    [tuple([1 << digit for digit in digits]) for digits in sorted(joint.digits)]
                )
        return PossibleWord(tuple(states), tuple(unknown), is_exact)

    def _entanglement(self, rule: CompiledRule, objects: Mapping[str, str]) -> Entanglement:
        key = rule.name, tuple(objects.values())
        if key not in self._entangled:
            everybody = NothingKnown(self._trace.objects, self._vocabulary)
            axioms = self._rulebook.axioms
            self._entangled[key] = entanglement(rule.machine.reads, objects, axioms, everybody)
        return self._entangled[key]

    def _joint_digits(
        self, rule: CompiledRule, objects: Mapping[str, str], number: int
    ) -> PossibleDigits:
        try:
            return joint_digits(
                rule.machine.reads, objects, self.view(number), self._rulebook.axioms
            )
        except MissingValueError as error:
            where = self._where(number)
            raise missing_value(error.subject, where, rule.name, self._trace.place) from None

    def impossible(self, rule: CompiledRule, objects: Mapping[str, str], number: int) -> RulecError:
        """The error (R0508) about a state that contradicts a fact."""
        types = {objects[variable.name]: variable.type for variable in rule.variables}
        place = StatePlace(number, self._where(number), self._trace.place)
        return impossible_state(rule, types, self._rulebook.axioms, self.view(number), place)

    def values(self, name: str, items: tuple[str, ...]) -> list[PartialValue | None]:
        """What every state says of a name, None where nothing, defaults included."""
        if (name, items) not in self._given:
            default: Any = self._vocabulary.declarations[name].default
            given: Any = [state.get(name) for state in self._trace.states]
            for item in items:
                given = [x if x is None or x is UNKNOWN else x.get(item) for x in given]
            self._given[name, items] = [default if value is None else value for value in given]
        return self._given[name, items]

    def _masks(
        self, read: Read | NumberRead, objects: Mapping[str, str], span: tuple[int, int], rule: str
    ) -> tuple[list[int], bool]:
        """The digits of a read in each state, and whether any is unknown."""
        about = read if isinstance(read, Read) else scale(read)
        items = tuple([objects[variable] for variable in about.variables])
        kind = (read.name, read.values) if isinstance(read, Read) else read
        key = (kind, items, span)
        if key not in self._columns:
            first, last = span
            if isinstance(read, Read):
                values = self.values(read.name, items)[first : last + 1]
                known = {value: possible_digits(read, value) for value in set(values)}
                masks = [known[value] for value in values]
                missing = (read.name, items)
            elif (quantity := scale(read).quantity) is not None:
                arguments = tuple([objects[variable] for variable in quantity.arguments])
                values = self.values(quantity.name, arguments)[first : last + 1]
                masks = [possible_digits(read, value) for value in values]
                missing = (quantity.name, arguments)
            else:
                masks = [self._sum(read, objects, n, rule) for n in range(first, last + 1)]
                missing = ("", ())
            if 0 in masks:
                where = self._where(first + masks.index(0))
                raise missing_value(missing, where, rule, self._trace.place)
            self._columns[key] = masks, any(mask & (mask - 1) for mask in masks)
        return self._columns[key]

    def _sum(self, read: NumberRead, objects: Mapping[str, str], number: int, rule: str) -> int:
        """The digits of a sum or a count; all of them if a sum has a count that is unknown."""
        view = self.view(number)
        total = weighted_sum(read.terms, objects, view)
        if not isinstance(total, Unknown):
            return 1 << read.digit(total)
        if isinstance(total, Between):
            return _digits_between(read.digit(total.low), read.digit(total.high))
        if view.given(total.name, total.objects) is None:
            subject = total.name, total.objects
            raise missing_value(subject, self._where(number), rule, self._trace.place)
        match read.terms:
            case ((_, ltl.Count() as count),):
                low, high = counted_range(count, objects, view)
                return _digits_between(read.digit(low), read.digit(high))
        return (1 << read.size) - 1

    def _unknown_names(
        self, read: Read | NumberRead, objects: Mapping[str, str], span: tuple[int, int]
    ) -> frozenset[str]:
        names = names_of_read(read)
        if len(names) == 1:
            return frozenset(names)
        numbers = range(span[0], span[1] + 1)
        subjects = [unknown_in_read(read, objects, self.view(number)) for number in numbers]
        return frozenset(name for each in subjects for name, _ in each)

    def _is_joint(self, rule: CompiledRule) -> bool:
        if rule.name not in self._joint:
            self._joint[rule.name] = is_joint(rule, self._rulebook.axioms)
        return self._joint[rule.name]


def possible_digits(read: Read | NumberRead, value: PartialValue | None) -> int:
    """The digits, as bits, that a read may have of a value; none of one that is missing."""
    if value is None:
        return 0
    if value is UNKNOWN:
        return (1 << read.size) - 1
    if isinstance(value, Interval):
        assert isinstance(read, NumberRead)
        known = scale(read)
        return _digits_between(known.digit(value.low), known.digit(value.high))
    return 1 << (read if isinstance(read, Read) else scale(read)).digit(value)


def is_joint(rule: CompiledRule, axioms: Sequence[CompiledAxiom]) -> bool:
    """Whether one read may bear on what another one, or a value that is not read, can be."""
    terms = [
        term
        for read in rule.machine.reads
        if isinstance(read, NumberRead)
        for _, term in read.terms
    ]
    if any(isinstance(term, ltl.Count) for term in terms) or len(set(terms)) < len(terms):
        return True
    in_axioms = {name for axiom in axioms for name in names_in(axiom.formula)}
    return not in_axioms.isdisjoint(
        name for read in rule.machine.reads for name in names_of_read(read)
    )


def names_of_read(read: Read | NumberRead) -> tuple[str, ...]:
    """The names that a read depends on."""
    return (read.name,) if isinstance(read, Read) else scale(read).names


def counted_range(
    count: ltl.Count, objects: Mapping[str, str], view: StateView
) -> tuple[Fraction, Fraction]:
    """How many objects count for sure, and how many may."""
    low = high = 0
    for item, kind in view.objects.items():
        if view.vocabulary.is_subtype(kind, count.type):
            truth = holds(count.body, {**objects, count.variable: item}, view)
            low += truth is True
            high += truth is not False
    return Fraction(low), Fraction(high)


def _digits_between(first: int, last: int) -> int:
    return ((1 << (last - first + 1)) - 1) << first
