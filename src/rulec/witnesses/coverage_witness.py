"""What a state has to be like for a machine to read a certain letter in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil, floor, inf

from rulec.automata.mealy_monitor import IMPOSSIBLE, MealyMonitor, NumberRead, Read, Threshold
from rulec.automata.thresholds import exact, scale
from rulec.logic.formula import Comparison, Formula, Proposition, Quantity, atoms_of
from rulec.logic.free_names import variables_of
from rulec.logic.kleene import holds
from rulec.logic.linear_comparison import stands
from rulec.logic.printing import in_words
from rulec.rulebook.examples.axiom_checks import Told
from rulec.rulebook.model import ExampleState
from rulec.vocabulary import Enumeration, Vocabulary

_MOST_PLACES = 17
"""No float has more decimal places that it can be told apart by, unless it is tiny."""


@dataclass(frozen=True, slots=True)
class CoverageWitness:
    """A state: what it says, and in ``besides`` the comparisons that have to hold in it, in words.

    Those are of counts, or of sums of numbers that cannot be chosen one by one.
    """

    says: ExampleState
    besides: tuple[str, ...] = ()


def is_possible(read: Read | NumberRead, digit: int) -> bool:
    """Can a state make a read come out so? False only if it is certain that none can."""
    if isinstance(read, Read) or scale(read).quantity is None:
        return True
    bounds = (-inf, *scale(read).floors, inf)
    return bounds[digit] < bounds[digit + 1]


def possible_letters(machine: MealyMonitor) -> Mapping[int, int]:
    """For every class of letters that some state of the world is in, the first of its letters."""
    first: dict[int, int] = {}
    for letter, symbol in enumerate(machine.letters):
        if symbol == IMPOSSIBLE or symbol in first:
            continue
        if all(map(is_possible, machine.reads, digits_of(letter, machine))):
            first[symbol] = letter
    return first


def truths(comparison: Comparison, machine: MealyMonitor) -> set[bool]:
    """The truth values that a comparison of the machine's rule can have."""
    return {
        stands(_sample(read, digit), comparison.relation, comparison.limit)
        for read in machine.reads
        if isinstance(read, NumberRead) and read.terms == comparison.terms
        for digit in range(read.size)
        if is_possible(read, digit)
    }


def coverage_witness(
    letter: int,
    machine: MealyMonitor,
    formula: Formula,
    vocabulary: Vocabulary,
    axioms: Sequence[Formula] = (),
) -> CoverageWitness:
    """A state in which the machine of a rule with this formula reads the letter.

    ``facts`` hold in every state. Where numbers that are chosen by themselves would contradict one,
    they are left to the reader.
    """
    digits = dict(zip(machine.reads, digits_of(letter, machine), strict=True))
    says: dict[tuple[str, tuple[str, ...]], bool | str | float] = {
        (read.name, read.variables): _value(read, digit, vocabulary)
        for read, digit in digits.items()
        if isinstance(read, Read)
    }
    besides: list[str] = []
    numbers = [read for read in digits if isinstance(read, NumberRead)]
    # What is compared by itself has less of a choice than what is also part of a sum.
    for read in sorted(numbers, key=lambda one: len(one.terms)):
        if not _choose(read, digits[read], says, vocabulary):
            besides += _in_words(read, digits[read], formula)
    for fact in axioms:
        if holds(fact, _itself(fact), Told(says, frozenset(), {}, vocabulary)) is False:
            about = {term for one in atoms_of(fact) for term in _quantities(one)}
            for read in numbers:
                terms = {term for _, term in read.terms}
                if any((one.name, one.arguments) in says for one in about if one in terms):
                    besides += _in_words(read, digits[read], formula)
            for one in about:
                says.pop((one.name, one.arguments), None)
            besides.append(in_words(fact))
    return CoverageWitness(says, tuple(dict.fromkeys(besides)))


def _itself(formula: Formula) -> dict[str, str]:
    """Every variable stands for the object of its own name."""
    return {name: name for name in variables_of(formula)}


def _quantities(one: Proposition) -> Iterator[Quantity]:
    for _, term in one.terms if isinstance(one, Comparison) else ():
        if isinstance(term, Quantity):
            yield term


def digits_of(letter: int, machine: MealyMonitor) -> Iterator[int]:
    """The digit of each of the machine's reads."""
    for read in machine.reads:
        letter, digit = divmod(letter, read.size)
        yield digit


def _value(read: Read, digit: int, vocabulary: Vocabulary) -> bool | str:
    declaration = vocabulary.declarations[read.name]
    if not isinstance(declaration, Enumeration):
        return bool(digit)
    if digit < len(read.values):
        return read.values[digit]
    return next(value for value in declaration.values if value not in read.values)


def _choose(
    read: NumberRead,
    digit: int,
    says: dict[tuple[str, tuple[str, ...]], bool | str | float],
    vocabulary: Vocabulary,
) -> bool:
    """Say numbers that make a sum come out as wanted; False, and say none, if that fails."""
    terms = [(factor, term) for factor, term in read.terms if isinstance(term, Quantity)]
    if len(terms) < len(read.terms):
        return False
    chosen: dict[tuple[str, tuple[str, ...]], float] = {}
    free: tuple[Fraction, tuple[str, tuple[str, ...]]] | None = None
    rest = Fraction(0)
    for factor, term in terms:
        key = (term.name, term.arguments)
        said = says.get(key)
        if said is None and free is None:
            free = factor, key
            continue
        if said is None:
            default = vocabulary.declarations[term.name].default
            said = chosen[key] = default if isinstance(default, int | float) else 0.0
        assert not isinstance(said, str), "a quantity is a number"
        rest += factor * exact(said)
    if free is None:
        return read.digit(rest) == digit
    factor, key = free
    number = _short_decimal(*_of_one(read.thresholds, digit, factor, rest))
    if number is None:
        return False
    says.update({key: float(number), **chosen})
    return True


def _of_one(
    thresholds: Sequence[Threshold], digit: int, factor: Fraction, rest: Fraction
) -> tuple[Sequence[Threshold], int]:
    """The thresholds and the digit of x, where those of ``factor * x + rest`` are given."""
    if factor > 0:
        return [Threshold((t.limit - rest) / factor, t.inclusive) for t in thresholds], digit
    # The larger x, the smaller the sum: what it passes, x stays below.
    turned = [Threshold((t.limit - rest) / factor, not t.inclusive) for t in thresholds[::-1]]
    return turned, len(thresholds) - digit


def _short_decimal(thresholds: Sequence[Threshold], digit: int) -> Fraction | None:
    """A number with few decimal places that passes exactly ``digit`` of the thresholds."""
    for places in range(_MOST_PLACES + 1):
        unit = Fraction(1, 10**places)
        if digit:
            number = _first_multiple(thresholds[digit - 1], unit)
        elif thresholds:
            number = _first_multiple(thresholds[0], unit) - unit
        else:
            return Fraction(0)
        if NumberRead((), tuple(thresholds)).digit(number) == digit:
            return number if _is_float(number) else None
    return None


def _first_multiple(threshold: Threshold, unit: Fraction) -> Fraction:
    """The smallest multiple of a unit that passes."""
    in_units = threshold.limit / unit
    return unit * (ceil(in_units) if threshold.inclusive else floor(in_units) + 1)


def _is_float(number: Fraction) -> bool:
    try:
        return exact(float(number)) == number
    except OverflowError:
        return False


def _sample(read: NumberRead, digit: int) -> Fraction:
    """Some number with this digit; for a count, a whole one.

    The thresholds of a count are whole numbers above 0 that are passed by themselves.
    """
    if not read.thresholds:
        return Fraction(0)
    if digit == 0:
        return read.thresholds[0].limit - 1
    below = read.thresholds[digit - 1]
    if below.inclusive:
        return below.limit
    if digit == len(read.thresholds):
        return below.limit + 1
    return (below.limit + read.thresholds[digit].limit) / 2


def _in_words(read: NumberRead, digit: int, formula: Formula) -> Iterator[str]:
    """The formula's comparisons of these numbers, each denied if it has to be false."""
    number = _sample(read, digit)
    for one in dict.fromkeys(atoms_of(formula)):
        if isinstance(one, Comparison) and one.terms == read.terms:
            yield one.text if stands(number, one.relation, one.limit) else f"not {one.text}"
