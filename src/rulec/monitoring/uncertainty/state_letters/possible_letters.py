"""The letters that a rule's machine may read in each state, when values are unknown."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import repeat
from typing import Any, NamedTuple, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.diagnostics import RulecError
from rulec.monitoring.axiom_violations import StatePlace, impossible_state
from rulec.monitoring.bindings import Binding
from rulec.monitoring.monitoring_messages import missing_value
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.entangled_reads import (
    MOST_COUNTED,
    EntangledReads,
    NothingKnown,
    known_parts,
    local_reads,
)
from rulec.monitoring.uncertainty.state_letters.letter_classes import (
    LetterClasses,
    PossibleWord,
    RuleLetters,
)
from rulec.monitoring.uncertainty.state_letters.read_digits import (
    ReadDigits,
    read_digits,
)
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    MissingValueError,
    Subject,
    unknown_in_read,
)
from rulec.trace import Trace, Value
from rulec.trace.interned import Interned
from rulec.trace.remembered import Remembered
from rulec.trace.trace_model import present_in
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, PartialValue

NOTHING: Mapping[Subject, Value] = {}
"""No supposed values."""


BoundLetters: TypeAlias = dict[tuple[object, ...], RuleLetters]
"""The letters of rules, by the rule and its objects."""

MOST_SCENES = 1 << 4
"""For how many sets of objects letters are kept before all are discarded."""


def bound_letters(
    rulebook: CompiledRulebook, objects: Mapping[str, str], vocabulary: Vocabulary
) -> BoundLetters:
    """The letters of a rulebook's rules about these objects, shared by several traces."""
    if len(objects) > MOST_COUNTED:
        return {}
    scenes: dict[object, tuple[Vocabulary, BoundLetters]]
    scenes = rulebook.prepared.setdefault(PossibleLetters, {})
    key = id(vocabulary), *objects.items()
    if key not in scenes:
        if len(scenes) >= MOST_SCENES:
            scenes.clear()
        # An object keeps its constants for as long as it is present
        scenes[key] = vocabulary, {}
    return scenes[key][1]


def letters_of_rule(
    rule: CompiledRule,
    classes: LetterClasses,
    objects: Mapping[str, str],
    rulebook: CompiledRulebook,
    *,
    everybody: NothingKnown,
    bound: BoundLetters,
) -> RuleLetters:
    """The letters of a rule for some objects among ``everybody``."""
    reads = local_reads(rule, rulebook)
    if reads is not None:
        return classes.of_rule(rule, reads)
    key = rule.name, classes, tuple(objects.values())
    if key not in bound:
        reads = EntangledReads(
            rule, objects, rulebook.axioms, everybody, known=known_parts(rulebook)
        )
        bound[key] = RuleLetters(classes, rule, reads)
    return bound[key]


@dataclass(frozen=True, slots=True)
class _About:
    """A rule's objects and their states, and the supposed values of constants."""

    rule: CompiledRule
    binding: Binding
    supposed: Mapping[Subject, Value]

    @property
    def stretch(self) -> slice:
        """The states."""
        return slice(self.binding.first, self.binding.last + 1)


class _Column(NamedTuple):
    """A read's digits, or the places of joint letters, in each state, with the column's number."""

    number: int
    items: tuple[int, ...]


class PossibleLetters:
    """A reader of the possible letters of a checked trace.

    ``vocabulary`` has the defaults of values missing in its states. ``bound`` is shared by traces
    with the same objects.
    """

    def __init__(
        self,
        trace: Trace,
        rulebook: CompiledRulebook,
        vocabulary: Vocabulary,
        where: Callable[[int], str] = "state {}".format,
        *,
        bound: BoundLetters | None = None,
    ) -> None:
        self._trace = trace
        self._rulebook = rulebook
        self._vocabulary = vocabulary
        self._where = where
        self._views: dict[tuple[object, ...], StateView] = {}
        self._named: Remembered[str, list[Any]] = Remembered(
            lambda name: [state.get(name) for state in trace.states]
        )
        self._given = Remembered(self._values, None)
        self._columns: dict[tuple[object, ...], _Column] = {}
        self._distinct_columns: dict[tuple[int, ...], _Column] = {}
        self._classes: dict[tuple[object, ...], tuple[int, ...]] = {}
        if bound is None:
            bound = bound_letters(rulebook, trace.objects, vocabulary)
        self._bound = bound

    def view(self, number: int, supposed: Mapping[Subject, Value] = NOTHING) -> StateView:
        """A state with the objects that are present, and with supposed values."""
        key = number, *supposed.items()
        if key not in self._views:
            trace = self._trace
            present = present_in(number, trace.objects, trace.present)
            state = with_values(trace.states[number], supposed)
            self._views[key] = StateView(state, present, self._vocabulary)
        return self._views[key]

    def word(
        self,
        rule: CompiledRule,
        classes: LetterClasses,
        binding: Binding,
        supposed: Mapping[Subject, Value] = NOTHING,
    ) -> PossibleWord:
        """The letters of a rule for some objects, where constants have the values ``supposed``.

        Raises RulecError R0504 if a value without default is missing.
        """
        about = _About(rule, binding, supposed)
        letters = self._letters_of(rule, classes, binding.objects)
        columns = [self._column(letters.reads[n], about) for n in letters.independent]
        is_exact = True
        if letters.entangled.numbers:
            columns.append(self._distinct(self._entangled_numbers(letters.entangled, about)))
            joint = letters.entangled.joint_letters
            is_exact = all(joint[number][1] for number in set(columns[-1].items))
        length = binding.last - binding.first + 1

        def keys() -> list[tuple[int, ...]]:
            return list(zip(*[own.items for own in columns], strict=True)) or [()] * length

        # Among many objects, most are alike for a rule
        alike = Interned(letters), length, *[own.number for own in columns]
        if alike not in self._classes:
            self._classes[alike] = tuple(map(letters.classes.__getitem__, keys()))
        return PossibleWord(
            self._classes[alike],
            is_exact,
            lambda: tuple([letters.letters(key) for key in keys()]),
            lambda: tuple([self._unknown_names(read, about) for read in letters.reads]),
        )

    def bits_of(
        self, rule: CompiledRule
    ) -> Callable[[Read | NumberRead, Mapping[str, str], tuple[int, int]], list[int]]:
        """A reader of the digits, as bits, of a rule's single reads.

        It takes the read, the objects and the stretch of states.
        """

        def read_bits(
            read: Read | NumberRead, chosen: Mapping[str, str], stretch: tuple[int, int]
        ) -> list[int]:
            about = _About(rule, Binding(chosen, *stretch), NOTHING)
            return self._digits(read_digits(read), about)

        return read_bits

    def _letters_of(
        self, rule: CompiledRule, classes: LetterClasses, objects: Mapping[str, str]
    ) -> RuleLetters:
        everybody = NothingKnown(self._trace.objects, self._vocabulary)
        return letters_of_rule(
            rule, classes, objects, self._rulebook, everybody=everybody, bound=self._bound
        )

    def impossible(self, rule: CompiledRule, objects: Mapping[str, str], number: int) -> RulecError:
        """The error (R0508) about a state that contradicts an axiom."""
        types = {objects[variable.name]: variable.type for variable in rule.variables}
        place = StatePlace(number, self._where(number), self._trace.place)
        return impossible_state(rule, types, self._rulebook.axioms, self.view(number), place)

    def values(
        self, name: str, items: tuple[str, ...], supposed: Mapping[Subject, Value] = NOTHING
    ) -> list[PartialValue | None]:
        """The value of a name in every state, defaults included; None if it is missing."""
        if (name, items) in supposed:
            return [supposed[name, items]] * len(self._trace.states)
        return self._given[name, items]

    def _values(self, subject: Subject) -> list[PartialValue | None]:
        name, items = subject
        default: Any = self._vocabulary.declarations[name].default
        given: Any = self._named[name]
        for item in items:
            given = [x if x is None or x is UNKNOWN else x.get(item) for x in given]
        return [default if value is None else value for value in given] if None in given else given

    def _distinct(self, items: Sequence[int]) -> _Column:
        """The one column with these items."""
        items = tuple(items)
        return self._distinct_columns.setdefault(items, _Column(len(self._distinct_columns), items))

    def _digits(self, read: ReadDigits, about: _About) -> list[int]:
        """The digits of a read in each state."""
        return list(self._column(read, about).items)

    def _column(self, read: ReadDigits, about: _About) -> _Column:
        """The digits of a read in each state."""
        objects, binding = about.binding.objects, about.binding
        items = tuple([objects[variable] for variable in read.variables])
        key: tuple[object, ...] = (read.kind, items, binding.first, binding.last)
        if about.supposed:
            key += tuple([own for own in about.supposed.items() if own[0][0] in read.names])
        column = self._columns.get(key)
        if column is None:
            if read.subject is None:
                digits = self._digits_of_sums(read, about)
            else:
                name, variables = read.subject
                subject = name, tuple([objects[variable] for variable in variables])
                digits = read.of_values(self.values(*subject, about.supposed)[about.stretch])
                if 0 in digits:
                    raise self._missing(subject, binding.first + digits.index(0), about.rule)
            column = self._columns[key] = self._distinct(digits)
        return column

    def _digits_of_sums(self, read: ReadDigits, about: _About) -> list[int]:
        """The digits of a sum in each state; exact numbers are used only near a limit."""
        numbers, objects = self._numbers(about), about.binding.objects
        columns = [
            self.values(name, tuple([objects[x] for x in variables]), about.supposed)[about.stretch]
            for name, variables in read.summands
        ]
        sums: list[int] = []
        rows = zip(*columns, strict=True) if columns else repeat((), len(numbers))
        for number, row in zip(numbers, rows, strict=True):
            digits = read.of_sum(row)
            sums.append(self._digits_of_sum(read, number, about) if digits is None else digits)
        return sums

    def _digits_of_sum(self, read: ReadDigits, number: int, about: _About) -> int:
        try:
            return read.in_state(about.binding.objects, self.view(number, about.supposed))
        except MissingValueError as error:
            raise self._missing(error.subject, number, about.rule) from None

    def _entangled_numbers(self, reads: EntangledReads, about: _About) -> list[int]:
        """The places of the joint letters of entangled reads in each state."""
        objects = about.binding.objects
        columns = [
            self.values(*subject, about.supposed)[about.stretch]
            for subject in reads.subjects_of(objects)
        ]
        numbers = self._numbers(about)
        rows = zip(*columns, strict=True) if columns else [()] * len(numbers)
        places: list[int] = []
        try:
            # One after the other, so that the state with a missing value is known.
            if reads.is_local:
                places.extend(map(reads.number, rows))
            else:
                there = [self.view(number).objects for number in numbers]
                places.extend(map(reads.number, rows, there))
        except MissingValueError as error:
            name, variables = error.subject
            subject = name, tuple([objects.get(variable, variable) for variable in variables])
            number = about.binding.first + len(places)
            raise self._missing(subject, number, about.rule) from None
        return places

    def _numbers(self, about: _About) -> range:
        return range(about.binding.first, about.binding.last + 1)

    def _unknown_names(self, read: ReadDigits, about: _About) -> frozenset[str]:
        if all(digits & (digits - 1) == 0 for digits in self._digits(read, about)):
            return frozenset()
        if len(read.names) == 1:
            return frozenset(read.names)
        objects = about.binding.objects
        return frozenset(
            name
            for number in self._numbers(about)
            for name, _ in unknown_in_read(read.read, objects, self.view(number, about.supposed))
        )

    def _missing(self, subject: Subject, number: int, rule: CompiledRule) -> RulecError:
        return missing_value(subject, self._where(number), rule.name, self._trace.place)
