"""Objects in counts: of many equal objects in a state, a few suffice.

Reads do not depend on names, and beyond its highest threshold a count's digit no longer changes. So
states of dense traffic that differ only in which object is where are evaluated once. If values of
an object alone decide whether it counts, each object is evaluated separately.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass
from itertools import product
from math import ceil, prod
from typing import Any, NamedTuple, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledAxiom
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.monitoring.uncertainty.state_letters.completions.completions import Digits
from rulec.monitoring.uncertainty.state_letters.joint_values import (
    MOST_KNOWN,
    Bits,
    FactInstance,
    JointValues,
    ReadWays,
    instances_of,
    joined_sets,
    values_at,
)
from rulec.monitoring.uncertainty.state_letters.read_digits import Letters, read_digits
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import (
    PartialView,
    Subject,
    candidates,
    subjects_in,
    subjects_of_read,
)
from rulec.rulebook.rules.axiom_instances import counts
from rulec.trace import Value
from rulec.vocabulary.partial_values import UNKNOWN, OneOf, PartialValue
from rulec.vocabulary.vocabulary_model import values_of

MOST_SUPPOSED = 1 << 8
"""How many joint values of the world are supposed one after the other."""


_Getter: TypeAlias = Callable[[Any], tuple[Any, ...]]
"""A getter of some values from those of all subjects."""


@dataclass(frozen=True, slots=True)
class Crowd:
    """All objects except those for which reads are evaluated.

    ``own`` gets the values of each of them from those of all subjects, ``others`` the values about
    none of them. Of objects of one type with the same values, ``enough`` count like any larger
    number.
    """

    enough: int
    own: Mapping[str, _Getter]
    others: _Getter

    def few(
        self, values: Sequence[PartialValue | None], there: Mapping[str, str]
    ) -> tuple[tuple[object, ...], dict[str, str]]:
        """The values of a state without names, and enough of its objects, with their types."""
        kept: dict[str, str] = {}
        alike: dict[tuple[object, ...], int] = {}
        named = []
        own, enough = self.own, self.enough
        for item, kind in there.items():
            if item in own:
                traits = kind, own[item](values)
                number = alike.get(traits, 0)
                if number == enough:
                    continue
                alike[traits] = number + 1
            else:
                named.append(item)
            kept[item] = kind
        return (self.others(values), tuple(named), frozenset(alike.items())), kept


def crowd_of(
    reads: Sequence[Read | NumberRead],
    subjects: Sequence[Subject],
    bound: frozenset[str],
    everybody: Mapping[str, str],
) -> Crowd | None:
    """The crowd of reads about ``bound`` objects and others; None if identities matter.

    ``subjects`` are what the reads depend on.
    """
    enough = enough_alike(reads)
    if enough is None:
        return None
    own: dict[str, list[tuple[str, tuple[str, ...], int]]] = {
        item: [] for item in everybody if item not in bound
    }
    others = []
    for place, (name, items) in enumerate(subjects):
        strangers = {item for item in items if item not in bound}
        if len(strangers) > 1:
            return None
        for item in strangers:
            # In one order for all objects, independent of their names.
            own[item].append((name, tuple("" if x == item else x for x in items), place))
        if not strangers:
            others.append(place)
    getters = {
        item: values_at([place for *_, place in sorted(ranked)]) for item, ranked in own.items()
    }
    return Crowd(enough, getters, values_at(others))


def enough_alike(reads: Sequence[Read | NumberRead]) -> int | None:
    """How many equal objects count for these reads like any larger number.

    None if that is unknown: if something is added to a count, or counts are counted.
    """
    enough = 1
    for read in reads:
        count = count_in(read)
        if count is None:
            continue
        assert isinstance(read, NumberRead), "it counts"
        if len(read.terms) > 1 or counts(count.body):
            return None
        factor = abs(read.terms[0][0])
        limits = [abs(threshold.limit) / factor for threshold in read.thresholds]
        enough = max([enough, *[ceil(limit) + 1 for limit in limits]])
    return enough


def count_in(read: Read | NumberRead) -> ltl.Count | None:
    """The count that a read depends on, unless it is about single values."""
    terms = read.terms if isinstance(read, NumberRead) else ()
    return next((term for _, term in terms if isinstance(term, ltl.Count)), None)


class CountsApart:
    """Counts in which each object's values and the world's alone decide whether it counts.

    They depend on these ``subjects`` and are evaluated for the objects of a ``binding``, with
    ``everybody`` present. Values of the world are supposed, one choice after the other; ``known``
    caches the results for equal objects. Raises LookupError if more is read than truth values and
    words, and how many of these objects satisfy a condition.
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
        world = {about for own in pieces if own.item for about in own.about if not about[1]}
        self._world = sorted([places[about] for about in world])
        declared = [everybody.vocabulary.declarations[subjects[n][0]] for n in self._world]
        self._values = [values_of(declaration) for declaration in declared]
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
        """The possible joint digits of the reads. Raises LookupError as ``ReadWays.digits_of``."""
        joint: set[Digits] = set()
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
                # Supposed values have to satisfy the axioms.
                strict = len(ways) > 1
                parts = [part.digits_of(supposed, strict) for part in self._parts]
                joint |= self._joint(tuple(parts))
        if not joint:
            raise LookupError
        return tuple([tuple([1 << digit for digit in digits]) for digits in sorted(joint)])

    def _joint(self, key: tuple[frozenset[Digits], ...]) -> frozenset[Digits]:
        """The joint digits of all reads, from the possible results of the parts."""
        known = self._letters.get(key)
        if known is None:
            sums = {(0,) * len(self._reads)}
            for part, own in zip(self._parts, key, strict=True):
                sums = {_added(before, part.reads, more) for before in sums for more in own}
            if len(self._letters) >= MOST_KNOWN:
                self._letters.clear()
            digits = [tuple(map(_digit, self._reads, numbers)) for numbers in sums]
            known = self._letters[key] = frozenset(digits)
        return known

    def _pieces(self) -> Iterator[_Piece]:
        for n, read in enumerate(self._reads):
            if isinstance(read, Read):
                about = subjects_of_read(read, self._binding, self._everybody)
                yield _Piece(n, None, frozenset(about))
                continue
            count = count_in(read)
            if count is None or len(read.terms) > 1 or counts(count.body):
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
        """A part, with its objects numbered so that equal objects are evaluated once."""
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
        asks = tuple([(self._reads[piece.read], names.get(piece.item or "")) for piece in pieces])
        kept = [(fact.formula, bound(fact.environment)) for fact in facts]
        formulas = tuple([(formula, *own.items()) for formula, own in kept])
        key = about, formulas, (*objects.items(),), (*binding.items(),), asks
        if key not in self._known:
            instances = [
                FactInstance(*own, frozenset(renamed(fact.about)))
                for own, fact in zip(kept, facts, strict=True)
            ]
            values = JointValues(about, instances, objects, self._everybody.vocabulary)
            ways = tuple([_ways_of(read, item, binding, values) for read, item in asks])
            self._known[key] = ReadWays(values, ways), {}
        reads = tuple([piece.read for piece in pieces])
        is_of_world = not set(self._world).isdisjoint(places)
        ways_of_all, joint = self._known[key]
        return _CountedPart(reads, values_at(places), ways_of_all, joint, is_of_world)


class _Piece(NamedTuple):
    """What a read is ``about`` or, for a count, what decides whether an ``item`` counts."""

    read: int
    item: str | None
    about: frozenset[Subject]


class _CountedPart(NamedTuple):
    """Pieces of ``reads`` that depend on each other, by the values of their subjects."""

    reads: tuple[int, ...]
    values: _Getter
    ways: ReadWays
    known: dict[tuple[Any, ...], frozenset[Digits]]
    is_of_world: bool

    def digits_of(self, values: Sequence[PartialValue | None], strict: bool) -> frozenset[Digits]:
        """The possible joint digits of the pieces. Raises LookupError as ``ReadWays.digits_of``."""
        strict = strict and self.is_of_world
        own = (*self.values(values), strict)
        known = self.known.get(own)
        if known is None:
            if len(self.known) >= MOST_KNOWN:
                self.known.clear()
            known = self.known[own] = self.ways.digits_of(own[:-1], strict=strict)
        return known


def _ways_of(
    read: Read | NumberRead, item: str | None, binding: Mapping[str, str], values: JointValues
) -> Sequence[tuple[int, Bits]]:
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


def _may_be(value: PartialValue | None, values: Sequence[Value]) -> Sequence[PartialValue | None]:
    """The values that a word or truth value may have, given what is known of ``value``."""
    if value is UNKNOWN:
        return values
    return tuple(value.values) if isinstance(value, OneOf) else (value,)
