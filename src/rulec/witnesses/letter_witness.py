"""Letters of one rule's monitor as states of the world.

A letter fixes what the rule reads. If the rule counts objects, the values that the counts read of
the rule's own objects are chosen too, so that further objects can give the right counts.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import compress, product
from math import prod

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.mealy_monitor import IMPOSSIBLE, NumberRead
from rulec.logic.formula import Count
from rulec.rulebook.rulebook_model import ExampleState, Variable
from rulec.vocabulary import Vocabulary
from rulec.witnesses import letter_functions, state_synthesis
from rulec.witnesses.counted_objects import CountedObjectKinds, fewest_counted_objects
from rulec.witnesses.joint_reads import JointReads, joint_reads
from rulec.witnesses.letter_functions import Digits
from rulec.witnesses.object_universe import ObjectUniverse
from rulec.witnesses.trace_synthesis import place_objects
from rulec.witnesses.undecided import UndecidedError

MOST_CHOICES = 4096
"""The most combinations tried of values that counts read of a rule's own objects."""


@dataclass(frozen=True, slots=True)
class WitnessTrace:
    """A trace in the form of an example: further objects, and the states.

    If the objects for the counts cannot be determined, ``required`` has for each state the number
    of objects for each count, including the rule's own.
    """

    objects: tuple[Variable, ...]
    states: tuple[ExampleState, ...]
    required: tuple[Mapping[Count, int], ...] = ()


class LetterWitnesses:
    """Witness states for the possible letters of a rule's monitor."""

    def __init__(self, rule: CompiledRule, vocabulary: Vocabulary) -> None:
        self._monitor = rule.machine
        self._counts = letter_functions.counts_read(rule.machine.reads)
        objects = {variable.name: variable.type for variable in rule.variables}
        self._universe = ObjectUniverse(objects, vocabulary)
        self._object_kinds = CountedObjectKinds(self._universe)
        self._states: dict[int, state_synthesis.JointState | None] = {}
        self._undecided: set[int] = set()
        self._digits = list(letter_functions.all_digits(rule.machine.reads))
        natural = [
            [letter_functions.is_natural(read, digit) for digit in range(read.size)]
            for read in rule.machine.reads
        ]
        self._constant = letter_functions.constant_reads(rule.machine.reads, vocabulary)
        self._below_zero = [
            not all(known[digit] for known, digit in zip(natural, digits, strict=True))
            for digits in self._digits
        ]
        self._members: list[list[int]] = [[] for _ in rule.machine.successors[0]]
        for letter, letter_class in enumerate(rule.machine.letters):
            if letter_class != IMPOSSIBLE:
                self._members[letter_class].append(letter)
        self._plain = [
            known.index(True)
            if isinstance(read, NumberRead)
            else state_synthesis.default_digit(read, vocabulary) or 0
            for read, known in zip(rule.machine.reads, natural, strict=True)
        ]

    def constants(self, letter: int) -> Digits:
        """The digits of what is constant in a trace; all letters of one trace share them."""
        return tuple(compress(self._digits[letter], self._constant))

    def plainest(self, letter_class: int, constants: Digits | None = None) -> int | None:
        """A class's possible letter with most defaults (with these ``constants``), or None."""
        return self._nearest_of(letter_class, self._plain, constants)

    def state(self, letter: int) -> state_synthesis.JointState | None:
        """A state that has this letter; None if there is none."""
        if letter not in self._states:
            self._states[letter] = self._state(letter)
        return self._states[letter]

    def trace(self, word: Sequence[int]) -> WitnessTrace:
        """A trace with these letters, all of which are possible."""
        states = [state for letter in word if (state := self.state(letter)) is not None]
        assert len(states) == len(word), "only possible letters are read"
        if self._undecided.isdisjoint(word):
            try:
                objects, values = place_objects(states, self._universe, self._stem)
            except UndecidedError:
                pass
            else:
                further = tuple(Variable(name, kind) for name, kind in objects.items())
                return WitnessTrace(further, tuple(values))
        vocabulary = self._universe.vocabulary
        required = tuple(state_synthesis.required_counts(state, vocabulary) for state in states)
        return WitnessTrace((), tuple(state.values for state in states), required)

    def _state(self, letter: int) -> state_synthesis.JointState | None:
        digits = self._digits[letter]
        if self._counts:
            try:
                return self._counted_state(digits)
            except UndecidedError:
                self._undecided.add(letter)
        at_least = tuple((count, 0) for count in self._counts)
        reads = list(zip(self._monitor.reads, digits, strict=True))
        return state_synthesis.synthesize_state(self._universe.vocabulary, reads, at_least)

    @cached_property
    def _joint_counts(self) -> tuple[list[letter_functions.CountFunction], JointReads]:
        counts = [letter_functions.count_function(count, self._universe) for count in self._counts]
        own = letter_functions.LetterFunction(self._monitor.reads, self._monitor.letters)
        functions = [own, *(count.function for count in counts)]
        return counts, joint_reads(functions, self._universe.vocabulary)

    def _counted_state(self, digits: Sequence[int]) -> state_synthesis.JointState | None:
        """A state with these digits of the monitor's reads and fitting counts.

        What the monitor leaves open has its default where possible.
        """
        counts, joint = self._joint_counts
        choices = [self._allowed(level, digits) for level in range(len(joint.reads))]
        if prod(map(len, choices)) > MOST_CHOICES:
            raise UndecidedError("too many states of the counted objects have to be distinguished")
        for joint_digits in product(*choices):
            counted = tuple(
                (count.count, count.counted_in(joint.own_digits(index, joint_digits)))
                for index, count in enumerate(counts, 1)
            )
            reads = list(zip(joint.reads, joint_digits, strict=True))
            state = state_synthesis.synthesize_state(self._universe.vocabulary, reads, counted)
            if state is not None and fewest_counted_objects(state, self._object_kinds) is not None:
                return state
        return None

    def _allowed(self, level: int, digits: Sequence[int]) -> list[int]:
        """The digits of a joint read that are compatible with the monitor's, default first."""
        _, joint = self._joint_counts
        read = joint.reads[level]
        default = state_synthesis.default_digit(read, self._universe.vocabulary)
        allowed = [
            joint_digit
            for joint_digit in range(read.size)
            if all(
                view.digits[joint_digit] == digit
                for view, digit in zip(joint.views[0], digits, strict=True)
                if view.joint == level
            )
        ]
        return sorted(allowed, key=lambda joint_digit: joint_digit != default)

    def _stem(self, kind: str) -> str:
        """The variable with which the rule counts objects of a type."""
        is_subtype = self._universe.vocabulary.is_subtype
        return next(count.variable for count in self._counts if is_subtype(kind, count.type))

    def _nearest_of(
        self, letter_class: int, digits: Sequence[int], constants: Digits | None
    ) -> int | None:
        letters = sorted(
            [
                letter
                for letter in self._members[letter_class]
                if constants is None or self.constants(letter) == constants
            ],
            key=lambda letter: (
                _distance(self._digits[letter], digits),
                self._below_zero[letter],
                letter,
            ),
        )
        return next((letter for letter in letters if self.state(letter) is not None), None)


def _distance(digits: Sequence[int], others: Sequence[int]) -> int:
    return sum(digit != other for digit, other in zip(digits, others, strict=True))
