"""What words and truths may be together, as bits of all the ways in which they can be.

Each way to give the subjects values has a bit, as in a truth table: what is said of a subject, what
a fact allows and where a read has a digit are sets of bits. So what a partly known state allows is
found by a few conjunctions, even where it has not been seen before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from itertools import product
from math import prod
from typing import Any, NamedTuple, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom
from rulec.logic.kleene import holds
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.completions import MOST_COMPLETIONS, Digits
from rulec.monitoring.uncertainty.state_letters.read_digits import ReadDigits
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    MissingValueError,
    Subject,
    subjects_in,
    subjects_of_read,
)
from rulec.trace import Value
from rulec.vocabulary import Enumeration, Quantity, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, OneOf, PartialValue
from rulec.vocabulary.vocabulary_model import choices

_Bits: TypeAlias = int
"""A set of ways to give all subjects values."""


class JointValues:
    """All ways to give ``subjects`` values, and which of them ``facts`` about ``objects`` allow.

    Raises LookupError if there are too many, or if some subject is a number.
    """

    def __init__(
        self,
        subjects: Sequence[Subject],
        facts: Iterable[CompiledAxiom],
        objects: Mapping[str, str],
        vocabulary: Vocabulary,
    ) -> None:
        self._objects, self._vocabulary = objects, vocabulary
        self._nobody = StateView({}, objects, vocabulary)
        declared = [vocabulary.declarations[name] for name, _ in subjects]
        if any(isinstance(declaration, Quantity) for declaration in declared):
            raise LookupError
        values: list[Sequence[Value]] = [
            declaration.values if isinstance(declaration, Enumeration) else (False, True)
            for declaration in declared
        ]
        self._n_ways = prod(map(len, values))
        if self._n_ways > MOST_COMPLETIONS:
            raise LookupError
        self._all = (1 << self._n_ways) - 1
        self._ways: dict[Subject, dict[Value, _Bits]] = {}
        stride = 1
        for subject, own in zip(subjects, values, strict=True):
            period = stride * len(own)
            first = ((1 << stride) - 1) * (self._all // ((1 << period) - 1))
            self._ways[subject] = {value: first << n * stride for n, value in enumerate(own)}
            stride = period
        self._of_places: list[dict[Any, _Bits]] = []
        for subject in subjects:
            self._of_places.append({UNKNOWN: self._all})
            self._of_places[-1].update(self._ways[subject])
        self._allowed = self._all
        for fact in facts:
            self._allowed &= self._kept(fact)

    def ways(self, values: Iterable[PartialValue | None]) -> _Bits:
        """The ways that facts allow and that have these values of the subjects.

        Raises LookupError if one is missing.
        """
        found = self._allowed
        for own, value in zip(self._of_places, values, strict=True):
            known = own.get(value)
            if known is None:
                if not isinstance(value, OneOf):
                    raise LookupError
                known = own[value] = sum([own[one] for one in value.values])
            found &= known
        return found

    def digits(self, read: ReadDigits, binding: Mapping[str, str]) -> Sequence[tuple[int, _Bits]]:
        """Each digit of a read that is asked of a binding's objects, and the ways that have it.

        Raises LookupError if more than the subjects decides.
        """

        def digit(view: StateView) -> int:
            return read.in_state(binding, view)

        found: dict[int, _Bits] = {}
        for bit, ways in self._by(subjects_of_read(read.read, binding, self._nobody), digit):
            if bit & (bit - 1):
                raise LookupError
            found[bit] = found.get(bit, 0) | ways
        return [(bit.bit_length() - 1, ways) for bit, ways in found.items()]

    def _kept(self, fact: CompiledAxiom) -> _Bits:
        """The ways that keep a fact about whichever objects."""
        names = [variable.name for variable in fact.variables]
        types = [variable.type for variable in fact.variables]
        kept = self._all
        for chosen in choices(types, self._objects, self._vocabulary):
            environment = dict(zip(names, chosen, strict=True))
            about = list(subjects_in(fact.formula, environment, self._nobody))
            if self._ways.keys().isdisjoint(about):
                continue

            def truth(view: StateView, environment: Mapping[str, str] = environment) -> object:
                return holds(fact.formula, environment, view)

            for is_kept, ways in self._by(about, truth):
                if is_kept is False:
                    kept &= ~ways
                elif is_kept is not True:
                    raise LookupError
        return kept

    def _by(
        self, about: Iterable[Subject], found: Callable[[StateView], Any]
    ) -> Iterable[tuple[Any, _Bits]]:
        """What is found for each choice of values of those subjects that are asked about."""
        own = [subject for subject in dict.fromkeys(about) if subject in self._ways]
        for chosen in product(*[self._ways[subject].items() for subject in own]):
            ways = self._all
            for _, bits in chosen:
                ways &= bits
            given = with_values({}, dict(zip(own, [value for value, _ in chosen], strict=True)))
            try:
                yield found(StateView(given, self._objects, self._vocabulary)), ways
            except MissingValueError:
                raise LookupError from None


class ReadWays(NamedTuple):
    """Reads of some ``values``, each with the ways that have each of its digits."""

    values: JointValues
    digits: tuple[Sequence[tuple[int, _Bits]], ...]

    def found(self, values: Iterable[PartialValue | None]) -> frozenset[Digits]:
        """The digits that the reads may have together for these values of the subjects.

        Raises LookupError if a value is missing, or none are possible.
        """
        ways = self.values.ways(values)
        if not ways:
            raise LookupError
        found: list[tuple[Digits, _Bits]] = [((), ways)]
        for own in self.digits:
            found = [
                ((*before, digit), both)
                for before, ways in found
                for digit, bits in own
                if (both := ways & bits)
            ]
        return frozenset([digits for digits, _ in found])


def read_ways(
    reads: Iterable[ReadDigits], binding: Mapping[str, str], values: JointValues
) -> ReadWays:
    """Reads of a binding's objects made ready. Raises LookupError if more than values decides."""
    return ReadWays(values, tuple([values.digits(read, binding) for read in reads]))
