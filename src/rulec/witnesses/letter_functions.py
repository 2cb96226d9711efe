"""Monitors, axioms and counts as functions from letters to classes.

Letters are numbers in mixed radix, as those of a monitor.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

from rulec.automata.alphabet import count_letters, letters_with, propositions_of, reads_of
from rulec.automata.mealy_monitor import MealyMonitor, NumberRead, Read
from rulec.logic import formula as ltl
from rulec.logic.fold import bit_sets, fold
from rulec.logic.free_names import variables_of
from rulec.logic.renaming import rename_variables
from rulec.vocabulary import Vocabulary
from rulec.witnesses.object_universe import EXTRA, ObjectUniverse, counts_in
from rulec.witnesses.undecided import UndecidedError

MOST_LETTERS = 1 << 14
"""An axiom or a count that reads more than these is left undecided."""


@dataclass(frozen=True, slots=True)
class LetterFunction:
    """Function from letters of some reads about objects to letter classes."""

    reads: tuple[Read | NumberRead, ...]
    letters: tuple[int, ...]

    def value(self, digits: Sequence[int]) -> int:
        """The class of the letter with these digits."""
        letter, stride = 0, 1
        for read, digit in zip(self.reads, digits, strict=True):
            letter += stride * digit
            stride *= read.size
        return self.letters[letter]


def monitor_function(
    machine: MealyMonitor, names: Mapping[str, str], universe: ObjectUniverse
) -> LetterFunction:
    """Letter function of a rule's monitor for a binding of its variables."""
    reads: list[Read | NumberRead] = []
    for read in machine.reads:
        if isinstance(read, Read):
            variables = tuple(names[variable] for variable in read.variables)
            reads.append(Read(read.name, variables, read.values, read.others))
        else:
            terms = tuple(
                (factor, _renamed_term(universe.canonical_term(term), names))
                for factor, term in read.terms
            )
            reads.append(NumberRead(terms, read.thresholds))
    return LetterFunction(tuple(reads), machine.letters)


def _renamed_term(term: ltl.Term, names: Mapping[str, str]) -> ltl.Term:
    if isinstance(term, ltl.QuantityTerm):
        return ltl.QuantityTerm(term.name, tuple(names[argument] for argument in term.arguments))
    return ltl.Count(term.variable, term.type, rename_variables(term.body, names))


def axiom_function(formula: ltl.Formula, vocabulary: Vocabulary) -> LetterFunction:
    """Letter function of a non-temporal formula: 1 or 0. Raises UndecidedError."""
    reads, (holds,) = truths_of([formula], vocabulary)
    return LetterFunction(
        reads, tuple(holds >> letter & 1 for letter in range(count_letters(reads)))
    )


@dataclass(frozen=True, slots=True)
class CountFunction:
    """Number of the universe's own objects that count: ``counted[class]``.

    Its class also tells apart all else that the count depends on, besides further objects.
    """

    count: ltl.Count
    function: LetterFunction
    counted: tuple[int, ...]

    def counted_in(self, digits: Sequence[int]) -> int:
        """Number of counted objects in the letter with these digits."""
        return self.counted[self.function.value(digits)]


def count_function(count: ltl.Count, universe: ObjectUniverse) -> CountFunction:
    """A count as a function of what it reads of its universe.

    Raises UndecidedError for a count in which others stand.
    """
    if any(True for _ in counts_in(count.body)):
        raise UndecidedError("a count stands inside another one")
    fitting = [
        name
        for name, kind in universe.objects.items()
        if universe.vocabulary.is_subtype(kind, count.type)
    ]
    bodies = [body_of(count, name) for name in fitting]
    extra = reads_of(body_of(count, EXTRA), universe.vocabulary)
    around = [read for read in extra if not speaks_of_extra(read)]
    own = reads_of(_all_of(bodies), universe.vocabulary)
    reads = own + tuple(read for read in around if _key(read) not in map(_key, own))
    total = count_letters(reads)
    truths = _truths(bodies, reads)
    digits = list(product(*(range(read.size) for read in reversed(reads))))
    beside = [n for n, read in enumerate(reads) if _key(read) in map(_key, around)]
    classes: dict[tuple[int, ...], int] = {}
    letters = []
    for letter in range(total):
        own_digits = digits[letter][::-1]
        number = sum(letters_of_body >> letter & 1 for letters_of_body in truths)
        key = (number, *(own_digits[n] for n in beside))
        letters.append(classes.setdefault(key, len(classes)))
    return CountFunction(
        count, LetterFunction(reads, tuple(letters)), tuple(key[0] for key in classes)
    )


def counts_read(reads: Iterable[Read | NumberRead]) -> list[ltl.Count]:
    """The counts in the sums that are read, each once."""
    sums = [read for read in reads if isinstance(read, NumberRead)]
    terms = dict.fromkeys(term for read in sums for _, term in read.terms)
    return [term for term in terms if isinstance(term, ltl.Count)]


def body_of(count: ltl.Count, name: str) -> ltl.Formula:
    """Condition that an object must satisfy to be counted."""
    return _settled(rename_variables(count.body, {count.variable: name}))


def speaks_of_extra(read: Read | NumberRead) -> bool:
    """Tell whether a read is about an additional, counted object."""
    if isinstance(read, Read):
        return EXTRA in read.variables
    return any(EXTRA in variables_of(term) for _, term in read.terms)


def _key(read: Read | NumberRead) -> object:
    return read.terms if isinstance(read, NumberRead) else (read.name, read.variables)


def _all_of(formulas: Sequence[ltl.Formula]) -> ltl.Formula:
    whole: ltl.Formula = ltl.Constant(True)
    for formula in formulas:
        whole = ltl.Binary(ltl.BinaryOperator.AND, whole, formula)
    return whole


def _settled(formula: ltl.Formula) -> ltl.Formula:
    """Replace each equality of two names by its truth value."""
    match formula:
        case ltl.Same(left, right):
            return ltl.Constant(left == right)
        case ltl.Unary(operator, operand, bound):
            return ltl.Unary(operator, _settled(operand), bound)
        case ltl.Binary(operator, left, right, bound):
            return ltl.Binary(operator, _settled(left), _settled(right), bound)
    return formula


def truths_of(
    formulas: Sequence[ltl.Formula], vocabulary: Vocabulary
) -> tuple[tuple[Read | NumberRead, ...], list[int]]:
    """Joint reads of non-temporal formulas, and the letters that satisfy each.

    A set of letters is the bits of an integer. Raises UndecidedError if there are too many.
    """
    reads = reads_of(_all_of(formulas), vocabulary)
    return reads, _truths(formulas, reads)


def _truths(formulas: Sequence[ltl.Formula], reads: tuple[Read | NumberRead, ...]) -> list[int]:
    total = count_letters(reads)
    if total > MOST_LETTERS:
        raise UndecidedError("a fact or a count reads too much at once")
    whole = _all_of(formulas)
    sets = letters_with(reads, propositions_of(whole))
    algebra = bit_sets(sets, (1 << total) - 1)
    return [fold(formula, algebra) for formula in formulas]
