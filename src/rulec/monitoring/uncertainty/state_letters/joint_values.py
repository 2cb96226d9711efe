"""What words and truths may be together, as bits of all the ways in which they can be.

Each way to give the subjects values has a bit, as in a truth table: what is said of a subject, what
a fact allows and where a read has a digit are sets of bits. So what a partly known state allows is
found by a few conjunctions, even where it has not been seen before.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from itertools import product
from math import prod
from operator import itemgetter
from typing import Any, NamedTuple, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.logic.kleene import holds
from rulec.monitoring.state_view import StateView, with_values
from rulec.monitoring.uncertainty.state_letters.completions import MOST_COMPLETIONS, Digits
from rulec.monitoring.uncertainty.state_letters.counted_crowd import count_in, counts
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters, ReadDigits, read_digits
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    MissingValueError,
    PartialView,
    Subject,
    candidates,
    subjects_in,
    subjects_of_read,
)
from rulec.trace import Value
from rulec.vocabulary import Declaration, Enumeration, Quantity, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, OneOf, PartialValue
from rulec.vocabulary.vocabulary_model import choices

MOST_SUPPOSED = 1 << 8
"""Ways of the world that are supposed one after the other."""

MOST_KNOWN = 1 << 14
"""Values of which it is kept what they come to before all are forgotten."""

_Bits: TypeAlias = int
"""A set of ways to give all subjects values."""


class FactInstance(NamedTuple):
    """A fact of the objects of an ``environment``, and what it is ``about``."""

    formula: ltl.Formula
    environment: Mapping[str, str]
    about: frozenset[Subject]


class JointValues:
    """All ways to give ``subjects`` values, and which of them ``facts`` about them allow.

    Raises LookupError if there are too many, if some subject is a number, or if a fact is about
    more than these.
    """

    def __init__(
        self,
        subjects: Sequence[Subject],
        facts: Iterable[FactInstance],
        objects: Mapping[str, str],
        vocabulary: Vocabulary,
    ) -> None:
        self._objects, self._vocabulary = objects, vocabulary
        self._nobody = StateView({}, objects, vocabulary)
        declared = [vocabulary.declarations[name] for name, _ in subjects]
        if any(isinstance(declaration, Quantity) for declaration in declared):
            raise LookupError
        values = [_values_of(declaration) for declaration in declared]
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
        places = {subject: place for place, subject in enumerate(subjects)}
        self._facts: list[tuple[Sequence[int], _Bits]] = []
        for fact in facts:
            about = [places[subject] for subject in fact.about]
            kept = dict(self.truths(fact.formula, fact.environment)).get(1, 0)
            self._facts.append((about, kept))
            self._allowed &= kept

    def ways(self, values: Sequence[PartialValue | None], *, strict: bool = False) -> _Bits:
        """The ways that facts allow and that have these values of the subjects.

        Facts about what is known are taken to be kept, unless it is ``strict``. Raises LookupError
        if a value is missing.
        """
        found = self._all
        for own, value in zip(self._of_places, values, strict=True):
            known = own.get(value)
            if known is None:
                if not isinstance(value, OneOf):
                    raise LookupError
                known = own[value] = sum([own[one] for one in value.values])
            found &= known
        allowed = found & self._allowed
        if allowed or strict:
            return allowed
        for places, kept in self._facts:
            if any(type(values[place]) in UNKNOWN_TYPES for place in places):
                found &= kept
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

    def truths(
        self, formula: ltl.Formula, environment: Mapping[str, str]
    ) -> Sequence[tuple[int, _Bits]]:
        """The ways in which a formula does not hold, and in which it does, as for ``digits``."""
        found = {False: 0, True: 0}
        about = subjects_in(formula, environment, self._nobody)
        for truth, ways in self._by(about, lambda view: holds(formula, environment, view)):
            if truth is not False and truth is not True:
                raise LookupError
            found[truth] |= ways
        return [(int(truth), ways) for truth, ways in found.items() if ways]

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

    def found(
        self, values: Sequence[PartialValue | None], *, strict: bool = False
    ) -> frozenset[Digits]:
        """The digits that the reads may have together for these values of the subjects.

        Raises LookupError if a value is missing, or none are possible; ``strict`` as above.
        """
        ways = self.values.ways(values, strict=strict)
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


class CountsApart:
    """Reads about everybody, of whom each who may count is looked at with what concerns only him.

    They depend on these ``subjects`` and are asked of the objects of a ``binding``, where
    ``everybody`` is there. What is said of the world as well as of him is supposed, one way after
    the other. What is ``known`` is kept for all who are alike. Raises LookupError if more is read
    than words, and how many of these objects something is true of.
    """

    def __init__(
        self,
        reads: Sequence[Read | NumberRead],
        subjects: Sequence[Subject],
        binding: Mapping[str, str],
        axioms: Sequence[CompiledAxiom],
        everybody: PartialView,
        *,
        known: dict[object, Any],
    ) -> None:
        self._reads, self._binding = reads, binding
        self._everybody, self._known = everybody, known
        pieces = list(self._pieces())
        facts = [own for axiom in axioms for own in instances_of(axiom, everybody)]
        places = {subject: place for place, subject in enumerate(subjects)}
        facts = [fact for fact in facts if not fact.about.isdisjoint(places)]
        world = {one for own in pieces if own.item for one in own.about if not one[1]}
        self._world = sorted([places[one] for one in world])
        declared = [everybody.vocabulary.declarations[subjects[n][0]] for n in self._world]
        self._values = [_values_of(declaration) for declaration in declared]
        apart = joined_sets(
            [*[own.about - world for own in pieces], *[own.about - world for own in facts]]
        )
        self._parts: list[_CountedPart] = []
        for own in [*apart, frozenset[Subject]()]:
            members = [x for x in pieces if x.about & own or (x.about <= world and not own)]
            bearing = [x for x in facts if x.about & own or (x.about <= world and not own)]
            there = own.union(*[x.about for x in members], *[x.about for x in bearing])
            if members or bearing:
                places_ = sorted([places[subject] for subject in there])
                named = [subjects[place] for place in places_]
                self._parts.append(self._part(members, named, bearing, places_))
        self._letters: dict[tuple[frozenset[Digits], ...], frozenset[Digits]] = {}

    def letters(self, values: Sequence[PartialValue | None]) -> Letters:
        """What the reads may be together. Raises LookupError as ``ReadWays.found``."""
        found: set[Digits] = set()
        supposed = list(values)
        possible = [
            _may_be(values[place], own)
            for place, own in zip(self._world, self._values, strict=True)
        ]
        if prod(map(len, possible)) > MOST_SUPPOSED:
            raise LookupError
        ways = list(product(*possible))
        for chosen in ways:
            for place, value in zip(self._world, chosen, strict=True):
                supposed[place] = value
            with suppress(LookupError):
                # What is supposed has to keep the facts.
                strict = len(ways) > 1
                found |= self._found(tuple([part.found(supposed, strict) for part in self._parts]))
        if not found:
            raise LookupError
        return tuple([tuple([1 << digit for digit in one]) for one in sorted(found)])

    def _found(self, key: tuple[frozenset[Digits], ...]) -> frozenset[Digits]:
        """The digits of all reads, by what the parts may come to."""
        known = self._letters.get(key)
        if known is None:
            found = {(0,) * len(self._reads)}
            for part, own in zip(self._parts, key, strict=True):
                found = {_added(before, part.reads, one) for before in found for one in own}
            if len(self._letters) >= MOST_KNOWN:
                self._letters.clear()
            digits = [tuple(map(_digit, self._reads, numbers)) for numbers in found]
            known = self._letters[key] = frozenset(digits)
        return known

    def _pieces(self) -> Iterator[_Piece]:
        for n, read in enumerate(self._reads):
            if isinstance(read, Read):
                about = subjects_of_read(read, self._binding, self._everybody)
                yield _Piece(n, None, frozenset(about))
                continue
            count = count_in(read)
            if count is None or len(read.terms) > 1 or any(map(counts, ltl.atoms_of(count.body))):
                raise LookupError
            for item in candidates(count, self._everybody):
                inner = {**self._binding, count.variable: item}
                yield _Piece(n, item, frozenset(subjects_in(count.body, inner, self._everybody)))

    def _part(
        self,
        pieces: Sequence[_Piece],
        subjects: Sequence[Subject],
        facts: Sequence[FactInstance],
        places: Sequence[int],
    ) -> _CountedPart:
        """A part, whose objects are numbered so that who is alike is looked at once."""
        items = [item for _, items in subjects for item in items]
        items += [*self._binding.values(), *[piece.item for piece in pieces if piece.item]]
        names = {item: str(n) for n, item in enumerate(dict.fromkeys(items))}
        objects = {name: self._everybody.objects[item] for item, name in names.items()}

        def renamed(own: Iterable[Subject]) -> Iterator[Subject]:
            return ((name, tuple([names[item] for item in items])) for name, items in own)

        def bound(binding: Mapping[str, str]) -> dict[str, str]:
            return {variable: names[item] for variable, item in binding.items()}

        about = tuple(renamed(subjects))
        binding = bound(self._binding)
        asked = tuple([(self._reads[piece.read], names.get(piece.item or "")) for piece in pieces])
        kept = [(fact.formula, bound(fact.environment)) for fact in facts]
        said = tuple([(formula, *own.items()) for formula, own in kept])
        key = about, said, (*objects.items(),), (*binding.items(),), asked
        if key not in self._known:
            instances = [
                FactInstance(*own, frozenset(renamed(fact.about)))
                for own, fact in zip(kept, facts, strict=True)
            ]
            values = JointValues(about, instances, objects, self._everybody.vocabulary)
            ways = tuple([_ways_of(read, item, binding, values) for read, item in asked])
            self._known[key] = ReadWays(values, ways), {}
        reads = tuple([piece.read for piece in pieces])
        is_of_world = not set(self._world).isdisjoint(places)
        ways_of_all, found = self._known[key]
        return _CountedPart(reads, values_at(places), ways_of_all, found, is_of_world)


class _Piece(NamedTuple):
    """What a read is ``about``, or, if it counts, what decides whether an ``item`` counts."""

    read: int
    item: str | None
    about: frozenset[Subject]


class _CountedPart(NamedTuple):
    """Pieces of ``reads`` that have to do with each other, by the values of their subjects."""

    reads: tuple[int, ...]
    values: Callable[[Any], tuple[Any, ...]]
    ways: ReadWays
    known: dict[tuple[Any, ...], frozenset[Digits]]
    is_of_world: bool

    def found(self, values: Sequence[PartialValue | None], strict: bool) -> frozenset[Digits]:
        """What the pieces may be together. Raises LookupError as ``ReadWays.found``."""
        strict = strict and self.is_of_world
        own = (*self.values(values), strict)
        known = self.known.get(own)
        if known is None:
            if len(self.known) >= MOST_KNOWN:
                self.known.clear()
            known = self.known[own] = self.ways.found(own[:-1], strict=strict)
        return known


def _ways_of(
    read: Read | NumberRead, item: str | None, binding: Mapping[str, str], values: JointValues
) -> Sequence[tuple[int, _Bits]]:
    count = count_in(read)
    if count is None or item is None:
        return values.digits(read_digits(read), binding)
    return values.truths(count.body, {**binding, count.variable: item})


def _digit(read: Read | NumberRead, number: int) -> int:
    """The digit of a read that is a word, or of a number of objects."""
    return number if isinstance(read, Read) else read.digit(read.terms[0][0] * number)


def _added(before: Digits, reads: Sequence[int], digits: Digits) -> Digits:
    after = list(before)
    for read, digit in zip(reads, digits, strict=True):
        after[read] += digit
    return tuple(after)


def instances_of(axiom: CompiledAxiom, everybody: PartialView) -> Iterator[FactInstance]:
    """A fact about each choice of its objects."""
    names = [variable.name for variable in axiom.variables]
    types = [variable.type for variable in axiom.variables]
    for chosen in choices(types, everybody.objects, everybody.vocabulary):
        environment = dict(zip(names, chosen, strict=True))
        about = frozenset(subjects_in(axiom.formula, environment, everybody))
        yield FactInstance(axiom.formula, environment, about)


def _may_be(value: PartialValue | None, values: Sequence[Value]) -> Sequence[PartialValue | None]:
    """What a word or a truth may be of which this is said."""
    if value is UNKNOWN:
        return values
    return tuple(value.values) if isinstance(value, OneOf) else (value,)


def _values_of(declaration: Declaration) -> Sequence[Value]:
    return declaration.values if isinstance(declaration, Enumeration) else (False, True)


def joined_sets(sets: Sequence[frozenset[Subject]]) -> list[frozenset[Subject]]:
    """The unions of those that have members in common."""
    found: list[frozenset[Subject]] = []
    for own in sets:
        if own:
            touched = [other for other in found if other & own]
            found = [other for other in found if not other & own]
            found.append(own.union(*touched))
    return found


def values_at(places: Sequence[int]) -> Callable[[Any], tuple[Any, ...]]:
    """Getter of what is at these places, always as a tuple."""
    if len(places) > 1:
        return itemgetter(*places)
    return lambda values: tuple([values[place] for place in places])
