"""Synthesise a state in which each read has a given digit.

Signals and enumerations are independent of each other; numbers are related by sums, which
Fourier-Motzkin elimination solves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache
from itertools import product

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.thresholds import exact
from rulec.logic.formula import Atom, Count, QuantityTerm, Term
from rulec.logic.printing import number_in_words
from rulec.valuations.connections import connected
from rulec.valuations.fourier_motzkin import LinearBound, solve
from rulec.vocabulary import Declaration, Enumeration, Quantity, Vocabulary
from rulec.vocabulary.vocabulary_model import default_value

Subject = tuple[str, tuple[str, ...]]
"""A declaration and the objects that it is applied to."""

Value = bool | str | float

Digits = Sequence[tuple[Read | NumberRead, int]]
"""Reads, each with the digit of its value."""

NumberDigits = Sequence[tuple[NumberRead, int]]
"""Sums, each with the number of its thresholds that it passes."""


@dataclass(frozen=True, slots=True)
class JointState:
    """A state: the values that matter; all others are arbitrary.

    ``number_digits`` are the sums that matter, ``counted`` is how many own objects each count
    counts.
    """

    values: Mapping[Subject, Value]
    number_digits: NumberDigits = ()
    counted: tuple[tuple[Count, int], ...] = ()

    def value(self, subject: Subject, vocabulary: Vocabulary) -> Value:
        """The subject's value in the state, or the default."""
        value = self.values.get(subject)
        return default_value(vocabulary.declarations[subject[0]]) if value is None else value

    def total(
        self,
        terms: Iterable[tuple[Fraction, Term]],
        vocabulary: Vocabulary,
        counted: Mapping[Count, int],
    ) -> Fraction:
        """The value of a sum, with the given numbers for its counts."""
        total = Fraction(0)
        for factor, term in terms:
            value: Value = (
                counted[term]
                if isinstance(term, Count)
                else self.value((term.name, term.arguments), vocabulary)
            )
            assert not isinstance(value, str), "a quantity is a number"
            total += factor * exact(value)
        return total


def float_values(numbers: Mapping[Term, Fraction]) -> dict[Subject, Value]:
    """The numbers of quantities as values."""
    return {
        (term.name, term.arguments): float(number)
        for term, number in numbers.items()
        if isinstance(term, QuantityTerm)
    }


def values_of(digits: Digits, vocabulary: Vocabulary) -> dict[Subject, Value]:
    """The values of reads that are not numbers."""
    return {
        (read.name, read.variables): value_of(read, digit, vocabulary)
        for read, digit in digits
        if isinstance(read, Read)
    }


def solve_numbers(
    number_digits: NumberDigits, vocabulary: Vocabulary, least: Mapping[Count, int]
) -> dict[Term, Fraction] | None:
    """Numbers with these digits, preferably defaults, and counts at least ``least``."""
    reads = [read for read, _ in number_digits]
    terms = _terms_of(reads)
    given = {
        term: least.get(term, 0) if isinstance(term, Count) else _default(term, vocabulary)
        for term in terms
    }
    for is_natural in (True, False):
        numbers: dict[Term, Fraction] = {}
        for places in apart(reads):
            own = _terms_of([reads[place] for place in places])
            solution = _part_solved(
                tuple([number_digits[place] for place in places]),
                tuple([(term, given[term]) for term in own]),
                is_natural=is_natural,
            )
            if solution is None:
                break
            numbers |= solution
        else:
            return {term: numbers[term] for term in reversed(terms)}
    return None


def _terms_of(reads: Sequence[NumberRead]) -> list[Term]:
    """The terms of the sums, quantities first."""
    terms = dict.fromkeys(term for read in reads for _, term in read.terms)
    return sorted(terms, key=lambda term: isinstance(term, Count))


def apart(reads: Sequence[NumberRead]) -> list[list[int]]:
    """The indices of sums in groups that share no term."""
    return [places for _, places in connected([{x for _, x in read.terms} for read in reads])]


@lru_cache(maxsize=1 << 12)
def _part_solved(
    number_digits: tuple[tuple[NumberRead, int], ...],
    given: tuple[tuple[Term, float | None], ...],
    *,
    is_natural: bool,
) -> Mapping[Term, Fraction] | None:
    """Numbers with these digits, not negative if ``is_natural``.

    ``given`` has each term's default (None if it has none), or the least number of counted objects.
    """
    least = {term: int(number or 0) for term, number in given if isinstance(term, Count)}
    system, quantities, counts = _linear_system(number_digits, least)
    if is_natural:
        system += _natural(quantities)
    preferred: dict[Term, Fraction] = {
        term: exact(number)
        for term, number in given
        if number is not None and isinstance(term, QuantityTerm)
    }
    return solve(system, [*quantities, *counts], preferred, frozenset(counts))


def numbers_near_thresholds(
    number_digits: NumberDigits,
    vocabulary: Vocabulary,
    usual: Mapping[QuantityTerm, Fraction] | None = None,
) -> dict[QuantityTerm, float] | None:
    """Numbers of quantities with these digits, close to the thresholds, for tests.

    In a sum of several quantities one is close, the others have their defaults or are zero, unless
    they are compared by themselves; those with a ``usual`` number have this one where possible.
    None if there are none, or none that floats can represent.
    """
    system, quantities, _ = _linear_system(number_digits, {})
    preferred: dict[Term, Fraction] = {}
    listed: list[QuantityTerm] = []
    order: list[Term] = []
    # Quantities compared by themselves have less choice than those in sums only.
    for read, _ in sorted(number_digits, key=lambda pair: len(pair[0].terms)):
        addends = [term for _, term in read.terms]
        new = [term for term in quantities if term not in listed and term in addends]
        for term in new[1:]:
            preferred[term] = _default_number(term, vocabulary) or Fraction(0)
        listed += new
        order += [*new[1:], *new[:1]]
    near = frozenset(quantities) - preferred.keys()
    preferred |= {term: number for term, number in (usual or {}).items() if term in quantities}
    solution = solve(system, order[::-1], preferred, near_bounds=near)
    if solution and min(solution.values()) < 0:
        natural = solve([*system, *_natural(quantities)], order[::-1], preferred, near_bounds=near)
        solution = natural or solution
    if solution is None or not all(map(_is_float, solution.values())):
        return None
    return {term: float(solution[term]) for term in listed}


def numbers_beside(
    number_digits: NumberDigits,
    bounds: Sequence[LinearBound],
    wanted: Mapping[QuantityTerm, Fraction],
) -> dict[QuantityTerm, float] | None:
    """Numbers of quantities with these digits that also keep to the ``bounds``.

    As many as possible are the ``wanted`` ones, and they are not negative if possible. None if
    there are none, or none that floats can represent.
    """
    system, quantities, _ = _linear_system(number_digits, {})
    order = list(dict.fromkeys([*wanted, *quantities]))
    near = frozenset(quantities)
    liked: dict[Term, Fraction] = dict(wanted.items())
    for more in (_natural(quantities), []):
        solutions = [
            solution
            for unknowns in (order[::-1], order)
            if (solution := solve([*system, *bounds, *more], unknowns, liked, near_bounds=near))
            and all(map(_is_float, solution.values()))
        ]
        if solutions:
            fewest = min(
                solutions,
                key=lambda solution: sum(solution[term] != wanted[term] for term in wanted),
            )
            return {term: float(fewest[term]) for term in quantities}
    return None


def _natural(quantities: Iterable[QuantityTerm]) -> list[LinearBound]:
    """Lower bounds at zero: most quantities are never negative, though no declaration says so."""
    return [LinearBound({term: Fraction(-1)}, Fraction(0)) for term in quantities]


def _default_number(term: QuantityTerm, vocabulary: Vocabulary) -> Fraction | None:
    default = _default(term, vocabulary)
    return None if default is None else exact(default)


def _default(term: QuantityTerm, vocabulary: Vocabulary) -> float | None:
    default = vocabulary.declarations[term.name].default
    return default if isinstance(default, int | float) else None


def _is_float(number: Fraction) -> bool:
    try:
        return exact(float(number)) == number
    except OverflowError:
        return False


def are_consistent(number_digits: NumberDigits) -> bool:
    """Whether numbers with these digits exist; counts are natural numbers."""
    system, quantities, counts = _linear_system(number_digits, {})
    return solve(system, [*quantities, *counts], {}, frozenset(counts)) is not None


def _linear_system(
    number_digits: NumberDigits, least: Mapping[Count, int]
) -> tuple[list[LinearBound], list[QuantityTerm], list[Count]]:
    """Inequalities for these digits and least counts, and their unknowns."""
    terms = _terms_of([read for read, _ in number_digits])
    counts = [term for term in terms if isinstance(term, Count)]
    system = [bound for read, digit in number_digits for bound in _bounds_of(read, digit)]
    system += [
        LinearBound({count: Fraction(-1)}, Fraction(-least.get(count, 0))) for count in counts
    ]
    return system, [term for term in terms if isinstance(term, QuantityTerm)], counts


def _bounds_of(read: NumberRead, digit: int) -> Iterator[LinearBound]:
    """Inequalities for a sum's digit: above one threshold, below the next."""
    terms: dict[Term, Fraction] = {term: coefficient for coefficient, term in read.terms}
    if digit > 0:
        passed = read.thresholds[digit - 1]
        below = {term: -coefficient for term, coefficient in terms.items()}
        yield LinearBound(below, -passed.limit, strict=not passed.inclusive)
    if digit < len(read.thresholds):
        ahead = read.thresholds[digit]
        yield LinearBound(terms, ahead.limit, strict=ahead.inclusive)


def value_of(read: Read, digit: int, vocabulary: Vocabulary) -> bool | str:
    """A value of a signal or an enumeration with this digit."""
    declaration = vocabulary.declarations[read.name]
    if not isinstance(declaration, Enumeration):
        return bool(digit)
    if digit < len(read.values):
        return read.values[digit]
    if declaration.default is not None and declaration.default not in read.values:
        return declaration.default
    return next(value for value in declaration.values if value not in read.values)


def default_digit(read: Read | NumberRead, vocabulary: Vocabulary) -> int | None:
    """The digit of a read if everything has its default; None if a default is missing."""
    if isinstance(read, Read):
        default = vocabulary.declarations[read.name].default
        return None if default is None else read.digit(default)
    total = Fraction(0)
    for coefficient, term in read.terms:
        if isinstance(term, QuantityTerm):
            number = _default_number(term, vocabulary)
            if number is None:
                return None
            total += coefficient * number
    return read.digit(total)


def subjects_of(
    vocabulary: Vocabulary, objects: Mapping[str, str], names: Set[str] | None = None
) -> Iterator[tuple[Subject, Declaration]]:
    """The subjects that states can have values for, all or of some names, with declarations."""
    for name, declaration in vocabulary.declarations.items():
        if names is not None and name not in names:
            continue
        candidates = [
            [item for item, kind in objects.items() if vocabulary.is_subtype(kind, parameter)]
            for parameter in declaration.parameters
        ]
        for items in product(*candidates):
            yield (name, items), declaration


def value_literal(subject: Subject, value: object, declaration: Declaration) -> str:
    """A value as a fact of an example, such as ``gap(v) = 5 m`` and ``not fog``."""
    name, items = subject
    if isinstance(declaration, Enumeration):
        return str(Atom(name, items, str(value)))
    if isinstance(declaration, Quantity):
        number = number_in_words(Fraction(str(value)))
        return f"{Atom(name, items)} = {number} {declaration.unit}"
    return f"{'' if value else 'not '}{Atom(name, items)}"
