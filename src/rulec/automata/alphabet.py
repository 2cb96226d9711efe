"""The letters of a rule: combinations of values of what it reads, numbered in mixed radix.

An enumeration has exactly one value; a number is on one side of each threshold.
"""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from fractions import Fraction
from itertools import combinations, count, pairwise
from math import ceil, floor, prod
from operator import itemgetter

from rulec.automata.mealy_monitor import NumberRead, Read, Threshold
from rulec.logic import formula as ltl
from rulec.vocabulary import Enumeration, Vocabulary

NOT, AND, OR = ltl.UnaryOperator.NOT, ltl.BinaryOperator.AND, ltl.BinaryOperator.OR


def propositions_of(formula: ltl.Formula) -> tuple[ltl.Proposition, ...]:
    """The distinct atoms and comparisons of a formula, in order of first mention."""
    return tuple(dict.fromkeys(ltl.atoms_of(formula)))


def reads_of(formula: ltl.Formula, vocabulary: Vocabulary) -> tuple[Read | NumberRead, ...]:
    """What a formula reads, in order of first mention: one read for each subject."""
    used: dict[object, list[ltl.Proposition]] = {}
    for proposition in propositions_of(formula):
        used.setdefault(ltl.subject_of(proposition), []).append(proposition)
    return tuple(_read(together, vocabulary) for together in used.values())


def _read(together: Sequence[ltl.Proposition], vocabulary: Vocabulary) -> Read | NumberRead:
    first = together[0]
    if isinstance(first, ltl.Comparison):
        comparisons = (each for each in together if isinstance(each, ltl.Comparison))
        passed = {side for each in comparisons for side in _sides(each) if side is not None}
        ascending = sorted(passed, key=lambda side: (side.limit, not side.inclusive))
        return NumberRead(first.terms, tuple(ascending))
    declaration = vocabulary.declarations.get(first.name)
    if not isinstance(declaration, Enumeration):
        return Read(first.name, first.arguments)
    mentioned = {atom.value for atom in together if isinstance(atom, ltl.Atom)}
    values = tuple(value for value in declaration.values if value in mentioned)
    return Read(first.name, first.arguments, values, others=len(values) < len(declaration.values))


def _sides(comparison: ltl.Comparison) -> tuple[Threshold | None, ...]:
    """The thresholds that decide a comparison: the lower one, then the upper one if there are two.

    A count is a whole number of at least 0, so its thresholds are inclusive whole numbers above 0;
    None stands for a threshold that every count passes.
    """
    limit = comparison.limit
    both: list[Threshold | None] = [Threshold(limit, inclusive) for inclusive in (True, False)]
    if len(comparison.terms) == 1 and isinstance(comparison.terms[0][1], ltl.Count):
        whole = (ceil(limit), floor(limit) + 1)
        both = [Threshold(Fraction(n), inclusive=True) if n > 0 else None for n in whole]
    match comparison.relation:
        case "<" | ">=":
            return (both[0],)
        case "<=" | ">":
            return (both[1],)
        case "=" | "!=":
            return tuple(both)


def _digits(comparison: ltl.Comparison, read: NumberRead) -> Sequence[int]:
    """The digits of the numbers for which the comparison holds."""
    # A number's digit is the number of thresholds that it passes.
    sides = _sides(comparison)
    passed = [0 if side is None else read.thresholds.index(side) + 1 for side in sides]
    match comparison.relation:
        case ">=" | ">":
            return range(passed[0], read.size)
        case "<" | "<=":
            return range(passed[0])
        case "=":
            return range(*passed)
        case "!=":
            return [*range(passed[0]), *range(passed[1], read.size)]


def count_letters(reads: Iterable[Read | NumberRead]) -> int:
    """The number of letters that these reads form."""
    return prod(read.size for read in reads)


def letters_with(
    reads: Sequence[Read | NumberRead], propositions: Iterable[ltl.Proposition]
) -> dict[ltl.Proposition, int]:
    """For each proposition, the bit set of the letters that satisfy it.

    ``reads`` are those of a formula over these propositions.
    """
    total = count_letters(reads)
    about: dict[object, tuple[Read | NumberRead, int]] = {}
    stride = 1
    for read in reads:
        key = read.terms if isinstance(read, NumberRead) else (read.name, read.variables)
        about[key] = read, stride
        stride *= read.size
    sets: dict[ltl.Proposition, int] = {}
    for proposition in propositions:
        read, stride = about[ltl.subject_of(proposition)]
        # The letters whose digit is 0 come in runs, as long as the stride.
        period = stride * read.size
        zeros = _repeated((1 << stride) - 1, period, total // period)
        sets[proposition] = sum(
            zeros << (digit * stride) for digit in _digits_with(proposition, read)
        )
    return sets


def _repeated(bits: int, period: int, times: int) -> int:
    """Copies of a bit set, one after the other, by doubling: dividing takes far longer."""
    whole = length = 0
    while times:
        if times & 1:
            whole |= bits << length
            length += period
        bits |= bits << period
        period *= 2
        times >>= 1
    return whole


def _digits_with(proposition: ltl.Proposition, read: Read | NumberRead) -> Sequence[int]:
    match proposition, read:
        case ltl.Comparison(), NumberRead():
            return _digits(proposition, read)
        case ltl.Atom(value=str(value)), Read():
            return (read.values.index(value),)
    return (1,)


def knowledge(
    reads: Iterable[Read | NumberRead], propositions: Sequence[ltl.Proposition]
) -> ltl.Formula:
    """A formula over these propositions that holds in every state of every trace.

    Exactly one value of an enumeration is true; comparisons of the same number are true according
    to the thresholds that it passes.
    """
    comparisons = [each for each in propositions if isinstance(each, ltl.Comparison)]
    axioms: list[ltl.Formula] = []
    for read in reads:
        if isinstance(read, NumberRead):
            axioms += _number_facts(
                read, [each for each in comparisons if each.terms == read.terms]
            )
            continue
        atoms = [ltl.Atom(read.name, read.variables, value) for value in read.values]
        axioms += [ltl.Unary(NOT, ltl.Binary(AND, *pair)) for pair in combinations(atoms, 2)]
        if atoms and not read.others:
            axioms.append(joined(OR, atoms))
    return joined(AND, axioms) if axioms else ltl.Constant(True)


def _number_facts(read: NumberRead, comparisons: Sequence[ltl.Comparison]) -> Iterator[ltl.Formula]:
    if any(comparison.relation in ("=", "!=") for comparison in comparisons):
        yield from _each_digit(read, comparisons)
        return
    # Comparisons with one threshold form a chain: passing a higher one implies passing the lower.
    passing: list[tuple[int, ltl.Formula]] = []
    for comparison in comparisons:
        (side,) = _sides(comparison)
        passed = comparison if comparison.relation in (">=", ">") else ltl.Unary(NOT, comparison)
        passing.append((-1 if side is None else read.thresholds.index(side), passed))
    passing.sort(key=itemgetter(0))
    yield from (passed for place, passed in passing if place < 0)
    for (place, earlier), (next_place, later) in pairwise(passing):
        if place >= 0:
            same = ltl.BinaryOperator.IFF if place == next_place else ltl.BinaryOperator.IMPLIES
            yield ltl.Binary(same, later, earlier)


def _each_digit(read: NumberRead, comparisons: Sequence[ltl.Comparison]) -> Iterator[ltl.Formula]:
    true_at = [_digits(comparison, read) for comparison in comparisons]
    cases = dict.fromkeys(
        tuple(digit in digits for digits in true_at) for digit in range(read.size)
    )
    if len(cases) < 1 << len(comparisons):
        signed = [(ltl.Unary(NOT, comparison), comparison) for comparison in comparisons]
        yield joined(
            OR,
            [
                joined(AND, [pair[holds] for pair, holds in zip(signed, case, strict=True)])
                for case in cases
            ],
        )


def joined(operator: ltl.BinaryOperator, formulas: Sequence[ltl.Formula]) -> ltl.Formula:
    """Join one or more formulas by one operator in a balanced tree."""
    if len(formulas) == 1:
        return formulas[0]
    half = len(formulas) // 2
    left, right = joined(operator, formulas[:half]), joined(operator, formulas[half:])
    return ltl.Binary(operator, left, right)


def names_of(propositions: Iterable[ltl.Proposition]) -> dict[ltl.Proposition, str]:
    """A unique name for each proposition: its text, with a number added if that is taken."""
    names: dict[ltl.Proposition, str] = {}
    taken: set[str] = set()
    for proposition in dict.fromkeys(propositions):
        names[proposition] = fresh_name(str(proposition) or "comparison", taken)
        taken.add(names[proposition])
    return names


def fresh_name(text: str, taken: Container[str]) -> str:
    """Make a name unique by adding a number if needed."""
    name = text
    numbers = count(2)
    while name in taken:
        name = f"{text} ({next(numbers)})"
    return name
