"""Monitors, axioms and counts as functions from letters to classes.

Letters are numbers in mixed radix, as for monitors.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache
from itertools import product, repeat
from typing import TypeAlias

from rulec.automata.alphabet import count_letters, joined, letters_with, propositions_of, reads_of
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read
from rulec.automata.thresholds import scale
from rulec.logic import formula as ltl
from rulec.logic.fold import bit_sets, fold, fold_constants
from rulec.logic.free_names import names_of, rename_variables, variables_of
from rulec.logic.linear_comparison import stands
from rulec.vocabulary import Vocabulary
from rulec.witnesses.object_universe import (
    EXTRA,
    Itself,
    ObjectUniverse,
    canonical_term,
    counts_in,
)
from rulec.witnesses.undecided import UndecidedError

MOST_LETTERS = 1 << 15
"""An axiom, or a count of further objects, that reads more letters than this is left undecided."""

MOST_COUNTED_LETTERS = 1 << 22
"""So is a count of a universe's own objects; there are few of these."""

Reads = tuple[Read | NumberRead, ...]
Digits: TypeAlias = tuple[int, ...]


def all_digits(reads: Sequence[Read | NumberRead]) -> Iterator[Digits]:
    """The digits of each letter, in the order of letters."""
    for digits in product(*(range(read.size) for read in reversed(reads))):
        yield digits[::-1]


def digits_of(letter: int, reads: Sequence[Read | NumberRead]) -> Digits:
    """The digits of a letter."""
    digits = []
    for read in reads:
        letter, digit = divmod(letter, read.size)
        digits.append(digit)
    return tuple(digits)


def is_natural(read: Read | NumberRead, digit: int) -> bool:
    """Whether a quantity with this digit need not be negative."""
    if isinstance(read, Read) or scale(read).quantity is None:
        return True
    return digit == len(scale(read).floors) or scale(read).floors[digit] > 0


def letter_of(digits: Sequence[int], reads: Sequence[Read | NumberRead]) -> int:
    """The letter with these digits."""
    letter = 0
    for read, digit in zip(reversed(reads), reversed(digits), strict=True):
        letter = letter * read.size + digit
    return letter


def constant_reads(reads: Sequence[Read | NumberRead], vocabulary: Vocabulary) -> tuple[bool, ...]:
    """For each read whether its digit is the same in all states of a trace, being a constant."""
    constants = frozenset(vocabulary.constants)
    return tuple(
        read.name in constants
        if isinstance(read, Read)
        else all(
            isinstance(term, ltl.QuantityTerm) and term.name in constants for _, term in read.terms
        )
        for read in reads
    )


@dataclass(frozen=True, slots=True)
class LetterFunction:
    """A function from letters of some reads about objects to letter classes."""

    reads: Reads
    letters: bytes | tuple[int, ...]

    def value(self, digits: Sequence[int]) -> int:
        """The class of the letter with these digits."""
        return self.letters[letter_of(digits, self.reads)]


def monitor_function(machine: MealyMonitor, names: Mapping[str, str]) -> LetterFunction:
    """The letter function of a rule's monitor for a binding of its variables."""

    def renamed(term: ltl.Term) -> ltl.Term:
        match canonical_term(term):
            case ltl.QuantityTerm(name, arguments):
                return ltl.QuantityTerm(name, tuple(names[argument] for argument in arguments))
            case ltl.Count(variable, kind, body):
                return ltl.Count(variable, kind, rename_variables(body, names))

    reads = [
        replace(read, variables=tuple(names[variable] for variable in read.variables))
        if isinstance(read, Read)
        else replace(read, terms=tuple((factor, renamed(term)) for factor, term in read.terms))
        for read in machine.reads
    ]
    return LetterFunction(tuple(reads), machine.letters)


def axiom_function(formula: ltl.Formula, vocabulary: Vocabulary) -> LetterFunction:
    """The letter function of a non-temporal formula: 1 or 0. Raises UndecidedError."""
    reads, (holds,) = truths_of([formula], vocabulary)
    return LetterFunction(reads, bytes(_bits(holds, reads)))


def _bits(letters: int, reads: Reads) -> list[int]:
    """A set of letters as 0 or 1 for each letter. A shift for each would take quadratic time."""
    return [*map(int, f"{letters:0{count_letters(reads)}b}"[::-1])]


@dataclass(frozen=True, slots=True)
class CountFunction:
    """The number of the universe's own objects that count: ``counted[class]``.

    Its class also distinguishes everything else that the count depends on, except further objects.
    """

    count: ltl.Count
    function: LetterFunction
    counted: tuple[int, ...]


def count_function(count: ltl.Count, universe: ObjectUniverse) -> CountFunction:
    """A count as a function of its universe.

    Raises UndecidedError if it contains other counts than of the counted object itself, by type.
    """
    vocabulary = universe.vocabulary
    known = Itself(vocabulary)
    bodies = [
        plain_body_of(count, (name, kind), known)
        for name, kind in universe.objects.items()
        if vocabulary.is_subtype(kind, count.type)
    ]
    fitting = [kind for kind in vocabulary.types if vocabulary.is_subtype(kind, count.type)]
    every = dict.fromkeys(plain_body_of(count, (EXTRA, kind), known) for kind in fitting)
    further = [*filter(can_be_true, every)]
    if any(True for body in (*bodies, *further) for _ in counts_in(body)):
        raise UndecidedError("a count contains another one")
    own = {_key(read): read for read in reads_of(_all_of(bodies), vocabulary)}
    around = {
        _key(read): read
        for read in reads_of(_all_of(further), vocabulary)
        if not speaks_of_extra(read)
    }
    # In the order of first mention; for a number in both, the thresholds of `own` are used.
    reads = tuple((own | around | own).values())
    beside = [place for place, key in enumerate(own | around) if key in around]
    letters, numbers = _tabulated(tuple(bodies), reads, tuple(beside))
    return CountFunction(count, LetterFunction(reads, letters), numbers)


# Cached: a rule is compared with many others.
@lru_cache(maxsize=16)
def _tabulated(
    bodies: tuple[ltl.Formula, ...], reads: Reads, beside: tuple[int, ...]
) -> tuple[bytes | tuple[int, ...], tuple[int, ...]]:
    """The class of each letter, by how many bodies are true and by the reads ``beside`` these.

    And how many are true in each class.
    """
    columns: list[Iterable[int]] = [
        _bits(truth, reads) for truth in _truths(bodies, reads, MOST_COUNTED_LETTERS)
    ]
    every = (tuple([digits[place] for place in beside]) for digits in all_digits(reads))
    others = every if beside else repeat((), count_letters(reads))
    classes: dict[tuple[int, ...], int] = {}
    numbers = map(sum, zip(*columns or [repeat(0)], strict=False))
    letters = [
        classes.setdefault((number, *digits), len(classes))
        for number, digits in zip(numbers, others, strict=False)
    ]
    # Bytes take an eighth of the memory.
    table = bytes(letters) if len(classes) < 256 else tuple(letters)
    return table, tuple([number for number, *_ in classes])


def counts_read(reads: Iterable[Read | NumberRead]) -> list[ltl.Count]:
    """The distinct counts in the sums that are read."""
    sums = [read for read in reads if isinstance(read, NumberRead)]
    terms = dict.fromkeys(term for read in sums for _, term in read.terms)
    return [term for term in terms if isinstance(term, ltl.Count)]


@lru_cache(maxsize=1024)
def body_of(
    count: ltl.Count, named: tuple[str, str], vocabulary: Itself[Vocabulary]
) -> ltl.Formula:
    """The condition that an object, ``named`` by its name and type, must satisfy to be counted."""
    about = rename_variables(count.body, {count.variable: named[0]})
    return _settled(about, named, vocabulary.item)


def plain_body_of(
    count: ltl.Count, named: tuple[str, str], vocabulary: Itself[Vocabulary]
) -> ltl.Formula:
    """The same without parts that decide nothing, such as ``other = v and ...`` for another object.

    What has no default is still read, as a state has to give its value anyway.
    """
    name, kind = named
    tests_types = any(True for _ in counts_in(count.body))
    return _plain_body_of(count, (name, kind if tests_types else count.type), vocabulary)


@lru_cache(maxsize=1 << 13)
def _plain_body_of(
    count: ltl.Count, named: tuple[str, str], vocabulary: Itself[Vocabulary]
) -> ltl.Formula:
    whole = body_of(count, named, vocabulary)
    plain = fold_constants(whole)
    declared, kept = vocabulary.item.declarations, {*propositions_of(plain)}
    untold = [
        part
        for part in propositions_of(whole)
        if part not in kept and any(declared[name].default is None for name in names_of(part))
    ]
    if not untold:
        return plain
    any_value = joined(ltl.BinaryOperator.OR, (ltl.Constant(True), *untold))
    return ltl.Binary(ltl.BinaryOperator.AND, plain, any_value)


@lru_cache(maxsize=1 << 13)
def can_be_true(body: ltl.Formula) -> bool:
    """Whether an object may be counted, as far as a plain body says by itself."""
    return fold_constants(body) != ltl.Constant(False)


def _settled(formula: ltl.Formula, named: tuple[str, str], vocabulary: Vocabulary) -> ltl.Formula:
    """Replace each equality of two names, and each test of the object's type, by its truth."""
    match formula:
        case ltl.Unary() | ltl.Binary():
            return ltl.with_operands(formula, lambda part: _settled(part, named, vocabulary))
        case ltl.Same(left, right):
            return ltl.Constant(left == right)
        case ltl.Comparison(((factor, ltl.Count(own, of_type, ltl.Same(left, right))),)) if {
            left,
            right,
        } == {own, named[0]}:
            number = factor * vocabulary.is_subtype(named[1], of_type)
            return ltl.Constant(stands(number, formula.relation, formula.limit))
    return formula


def speaks_of_extra(read: Read | NumberRead) -> bool:
    """Whether a read is about an additional, counted object."""
    if isinstance(read, Read):
        return EXTRA in read.variables
    return any(EXTRA in variables_of(term) for _, term in read.terms)


def _key(read: Read | NumberRead) -> object:
    return read.terms if isinstance(read, NumberRead) else (read.name, read.variables)


def _all_of(formulas: Sequence[ltl.Formula]) -> ltl.Formula:
    return joined(ltl.BinaryOperator.AND, (ltl.Constant(True), *formulas))


def truths_of(formulas: Sequence[ltl.Formula], vocabulary: Vocabulary) -> tuple[Reads, list[int]]:
    """Joint reads of non-temporal formulas, and the letters that satisfy each.

    A set of letters is a bit set. Raises UndecidedError if there are too many.
    """
    reads = reads_of(_all_of(formulas), vocabulary)
    return reads, _truths(formulas, reads)


def _truths(formulas: Sequence[ltl.Formula], reads: Reads, most: int = MOST_LETTERS) -> list[int]:
    total = count_letters(reads)
    if total > most:
        raise UndecidedError("a fact or a count reads too much at once")
    sets = letters_with(reads, propositions_of(_all_of(formulas)))
    algebra = bit_sets(sets, (1 << total) - 1)
    return [fold(formula, algebra) for formula in formulas]
