"""Additional objects in a state that satisfy the counts of rules.

The search is breadth first over the number of objects that each count has reached.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import lru_cache, reduce
from itertools import accumulate, compress, product
from math import ceil
from operator import add, and_, mul

from rulec.automata.alphabet import reads_of
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic.formula import Count, Formula, Term
from rulec.logic.free_names import variables_of
from rulec.trace.remembered import Remembered
from rulec.vocabulary import Vocabulary
from rulec.witnesses import letter_functions
from rulec.witnesses.counted_types import bodies_for, can_add, types_counted
from rulec.witnesses.object_universe import EXTRA, Itself, ObjectUniverse
from rulec.witnesses.relevant_axioms import (
    GroundAxiom,
    axioms_about,
    relevant_axioms,
    subjects_read,
)
from rulec.witnesses.state_synthesis import (
    JointState,
    Subject,
    Value,
    float_values,
    solve_numbers,
    values_of,
)
from rulec.witnesses.undecided import UndecidedError

MOST_COUNTED_OBJECTS = 40
"""The most objects that are added to those in the rules' variables."""

MOST_TRIED = 20_000


@dataclass(frozen=True, slots=True)
class CountedObject:
    """An additional object: its type, the counts it adds to (1 or 0 each), and its values."""

    type: str
    adds: tuple[int, ...]
    values: Mapping[Subject, Value]


CountedObjects = tuple[CountedObject, ...]


def fewest_counted_objects(
    state: JointState, object_kinds: CountedObjectKinds
) -> CountedObjects | None:
    """The fewest additional objects that satisfy the counts, or None."""
    universe = object_kinds.universe
    counts = _counts_of(state)
    if not counts:
        return ()
    sums = tuple(dict(state.counted)[count] for count in counts)
    if _comes_out(state, universe, dict(zip(counts, sums, strict=True))):
        return ()  # the usual case; finding kinds of objects takes long
    # Of kinds that add to the same counts the first is enough; most types have the same.
    kinds: dict[tuple[int, ...], CountedObject] = {}
    for kind in object_kinds.of(state):
        kinds.setdefault(kind.adds, kind)
    enough = [_enough(count, state) for count in counts]
    waiting: list[tuple[tuple[int, ...], CountedObjects]] = [(sums, ())]
    seen = {sums}
    for sums, further in waiting:
        if _comes_out(state, universe, dict(zip(counts, sums, strict=True))):
            return further
        if len(further) == MOST_COUNTED_OBJECTS:
            raise UndecidedError(f"it takes more than {MOST_COUNTED_OBJECTS} objects to be counted")
        for kind in kinds.values():
            after = tuple(
                min(a + b, most) for a, b, most in zip(sums, kind.adds, enough, strict=True)
            )
            if after not in seen:
                seen.add(after)
                waiting.append((after, (*further, kind)))
        if len(seen) > MOST_TRIED:
            raise UndecidedError("too many ways to count objects have to be distinguished")
    return None


def counted_objects_of_types(
    state: JointState, object_kinds: CountedObjectKinds, types: Sequence[str]
) -> CountedObjects | None:
    """An additional object of each of the ``types`` so that the counts are satisfied, or None."""
    universe = object_kinds.universe
    counts = _counts_of(state)
    kinds = object_kinds.of(state, types) if types else []
    start = tuple(dict(state.counted)[count] for count in counts)
    reached: dict[tuple[int, ...], CountedObjects] = {start: ()}
    for type_name in types:
        following: dict[tuple[int, ...], CountedObjects] = {}
        for (sums, further), kind in product(reached.items(), kinds):
            if kind.type == type_name:
                following.setdefault(tuple(map(add, sums, kind.adds)), (*further, kind))
        reached = following
    every = ((dict(zip(counts, sums, strict=True)), further) for sums, further in reached.items())
    return next((objects for sums, objects in every if _comes_out(state, universe, sums)), None)


def _enough(count: Count, state: JointState) -> int:
    """The number of counted objects above which further ones make no difference."""
    most = 0
    for read, _ in state.number_digits:
        if any(term == count for _, term in read.terms):
            if len(read.terms) > 1:
                return MOST_COUNTED_OBJECTS + 1
            # A comparison that is always true has no thresholds.
            most = max([most, *(ceil(threshold.limit) + 1 for threshold in read.thresholds)])
    return most


def _counts_of(state: JointState) -> list[Count]:
    return letter_functions.counts_read(read for read, _ in state.number_digits)


def _comes_out(state: JointState, universe: ObjectUniverse, counted: Mapping[Count, int]) -> bool:
    return all(
        read.digit(state.total(read.terms, universe.vocabulary, counted)) == digit
        for read, digit in state.number_digits
    )


class CountedObjectKinds:
    """The kinds of additional objects of a universe that counts distinguish.

    There are many states, so what does not depend on the state is computed once. ``known`` are the
    subjects that the states tell; if it is given, UndecidedError is raised where anything else
    decides which objects there can be.
    """

    def __init__(self, universe: ObjectUniverse, known: Set[Subject] | None = None) -> None:
        self.universe = universe
        self._known = known
        self._types = Remembered(self._distinct_types, None)

    def of(self, state: JointState, types: Sequence[str] = ()) -> list[CountedObject]:
        """The kinds for a state, most general types first.

        Their types are those that are counted, and ``types``, which another state may need.
        """
        return [
            candidate
            for counted in self._types[tuple(_counts_of(state)), tuple(types)]
            for candidate in self._of_type(counted, state)
        ]

    def may_miss_some(self, state: JointState) -> bool:
        """Whether objects may count in states that differ from this one only in some number.

        That is so if their numbers are compared with the state's, of which it has but one choice.
        """
        types = self._types[tuple(_counts_of(state)), ()]
        return any(rest for counted in types for _, rest in counted.inputs)

    def _distinct_types(
        self, key: tuple[tuple[Count, ...], tuple[str, ...]]
    ) -> Sequence[_CountedType]:
        vocabulary, (counts, types), found = self.universe.vocabulary, key, []
        for kind in types_counted(counts, types, vocabulary):
            bodies = bodies_for(kind, counts, vocabulary)
            about = axioms_about(kind, self.universe)
            places, own = (len(counts), *bodies), tuple(bodies.values())
            counted = _fitting_type(kind, places, own, about, Itself(vocabulary))
            if can_add(own):
                self._require_known(counted)
            found.append(counted)
        return found

    def _require_known(self, counted: _CountedType) -> None:
        """Raise UndecidedError if a state would be asked for a value that it does not tell."""
        read = tuple([counted.reads[place] for place, rest in counted.inputs if rest is None])
        if self._known is not None and not subjects_read(read) <= self._known:
            raise UndecidedError("which objects count depends on facts about too much else")

    def _of_type(self, counted: _CountedType, state: JointState) -> tuple[CountedObject, ...]:
        vocabulary = self.universe.vocabulary
        # The state's digits of reads that are not about the object, and its part of mixed sums.
        given = tuple(
            [
                _digit(counted.reads[place], state, vocabulary)
                if rest is None
                else state.total(rest, vocabulary, {})
                for place, rest in counted.inputs
            ]
        )
        if given not in counted.by_given:
            known: list[int | Fraction] = [0] * len(counted.reads)
            for (place, _), value in zip(counted.inputs, given, strict=True):
                known[place] = value
            counted.by_given[given] = tuple(_first_of_each(counted, known, vocabulary))
        return counted.by_given[given]


@dataclass(frozen=True, slots=True)
class _CountedType:
    """A type of additional objects, and what decides which counts such an object adds to.

    Letters are those of ``reads``; sets of letters are bit sets. ``counted`` has for each count the
    letters with which the object counts, ``allowed`` for each axiom those with which it holds.
    ``inputs`` are values taken from a state: the digits of reads that are not about the object, and
    for sums about the object the total of the other terms. ``by_given`` is a cache by these.
    """

    type: str
    reads: Sequence[Read | NumberRead]
    are_about_it: Sequence[bool]
    counted: Sequence[int]
    allowed: Sequence[int]
    inputs: Sequence[tuple[int, Sequence[tuple[Fraction, Term]] | None]]
    by_given: dict[object, tuple[CountedObject, ...]] = field(default_factory=dict)


# Cached: most rules of two rulebooks are compared with the same objects and axioms.
@lru_cache(maxsize=1024)
def _fitting_type(
    kind: str,
    places: tuple[int, ...],
    bodies: tuple[Formula, ...],
    axioms: tuple[GroundAxiom, ...],
    vocabulary: Itself[Vocabulary],
) -> _CountedType:
    # Irrelevant axioms would only multiply the states: what they read can have its defaults.
    relevant = relevant_axioms(axioms, [reads_of(body, vocabulary.item) for body in bodies])
    about = (*bodies, *(axiom.formula for axiom in relevant))
    return _counted_type(kind, places, about, vocabulary)


# Cached: small universes of one vocabulary have the same additional objects.
@lru_cache(maxsize=1024)
def _counted_type(
    kind: str,
    places: tuple[int, ...],
    about: tuple[Formula, ...],
    vocabulary: Itself[Vocabulary],
) -> _CountedType:
    """The data of a type, from the bodies of the counts at some places, and axioms.

    The first of the ``places`` is the number of all counts.
    """
    reads, truths = letter_functions.truths_of(about, vocabulary.item)
    n_counts, *counting = places
    letters = dict(zip(counting, truths, strict=False))
    counted = tuple(letters.get(place, 0) for place in range(n_counts))
    are_about_it = [letter_functions.speaks_of_extra(read) for read in reads]
    inputs = [
        (place, rest)
        for place, (read, about_it) in enumerate(zip(reads, are_about_it, strict=True))
        for rest in (_rest_of(read) if about_it else None,)
        if rest is None or rest
    ]
    allowed = tuple(truths[len(counting) :])
    return _CountedType(kind, reads, are_about_it, counted, allowed=allowed, inputs=inputs)


def _first_of_each(
    counted: _CountedType, known: Sequence[int | Fraction], vocabulary: Vocabulary
) -> Iterator[CountedObject]:
    """For each possible set of counts that an object adds to, the first such object.

    ``known`` has for each read the digit that the state gives it, or, for reads about the object,
    the state's part of the sum.
    """
    reads = [
        _unknown(read, given) if is_about_it and isinstance(read, NumberRead) else read
        for read, given, is_about_it in zip(counted.reads, known, counted.are_about_it, strict=True)
    ]
    choices = [
        range(read.size) if is_about_it else (int(digit),)
        for read, digit, is_about_it in zip(reads, known, counted.are_about_it, strict=True)
    ]
    seen = set()
    own = [*compress(reads, counted.are_about_it)]
    allowed = reduce(and_, counted.allowed, -1)
    weights = [*accumulate((read.size for read in counted.reads), mul, initial=1)][:-1]
    for digits in product(*choices):
        letter = sum(map(mul, digits, weights))
        if not allowed >> letter & 1:
            continue
        adds = tuple([letters >> letter & 1 for letters in counted.counted])
        if adds in seen:
            continue
        own_digits = [*zip(own, compress(digits, counted.are_about_it), strict=True)]
        sums = [(read, digit) for read, digit in own_digits if isinstance(read, NumberRead)]
        numbers = solve_numbers(sums, vocabulary, {})
        if numbers is not None:
            seen.add(adds)
            values = values_of(own_digits, vocabulary) | float_values(numbers)
            yield CountedObject(counted.type, adds, values)


def _digit(read: Read | NumberRead, state: JointState, vocabulary: Vocabulary) -> int:
    if isinstance(read, Read):
        return read.digit(state.value((read.name, read.variables), vocabulary))
    return read.digit(state.total(read.terms, vocabulary, {}))


def _rest_of(read: Read | NumberRead) -> list[tuple[Fraction, Term]]:
    """The terms of a sum that are not about the object, if others are."""
    terms = () if isinstance(read, Read) else read.terms
    return [pair for pair in terms if EXTRA not in variables_of(pair[1])]


def _unknown(read: NumberRead, known: int | Fraction) -> NumberRead:
    """The sum of the unknown terms, with the known ones moved into the thresholds."""
    unknown = tuple(pair for pair in read.terms if EXTRA in variables_of(pair[1]))
    if not known and len(unknown) == len(read.terms):
        return read
    thresholds = tuple(
        replace(threshold, limit=threshold.limit - known) for threshold in read.thresholds
    )
    return NumberRead(unknown, thresholds)
