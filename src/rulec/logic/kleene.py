"""Formulas of one partly known state, in Kleene's strong three-valued logic.

A value that does not depend on the unknown parts is determined (`x = v or gap(x, v) < 5 m` holds
for v itself, whatever its gap to itself is); every other value is unknown (Kleene, "Introduction to
metamathematics", 1952).
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import lru_cache, partial
from typing import Protocol, TypeAlias

from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold
from rulec.logic.free_names import number_of as number_compared
from rulec.logic.linear_comparison import stands, surely_stands
from rulec.vocabulary import Vocabulary

_MOST = 1 << 12
"""The number of formulas whose evaluators are cached."""

ObjectBinding: TypeAlias = Mapping[str, str]
"""Maps a variable to the object that it stands for."""


@dataclass(frozen=True, slots=True)
class Unknown:
    """An unknown value on which the result depends: its declaration's name and its objects."""

    name: str
    objects: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Between(Unknown):
    """An unknown number with known bounds, which are included."""

    low: Fraction
    high: Fraction


Interval: TypeAlias = tuple[Fraction, Fraction]
"""The least and the greatest value that a number may have."""


class PartialState(Protocol):
    """A state in which some values may be unknown."""

    @property
    def objects(self) -> Mapping[str, str]:
        """The present objects, with their types."""

    @property
    def vocabulary(self) -> Vocabulary:
        """The declarations that values can be asked for."""

    def value(self, name: str, items: tuple[str, ...]) -> bool | float | str | Unknown:
        """The value of a signal or an enumeration."""

    def number(self, name: str, items: tuple[str, ...]) -> Fraction | Unknown:
        """The value of a quantity."""


Evaluator: TypeAlias = Callable[[ObjectBinding, PartialState], bool | Unknown]


def weighted_sum(
    terms: Sequence[tuple[Fraction, ltl.Term]], binding: ObjectBinding, state: PartialState
) -> Fraction | Unknown:
    """The sum of coefficient times term: exact, bounded if all unknown terms are, or unknown."""
    return _summed((factor, number_of(term, binding, state)) for factor, term in terms)


def _summed(numbers: Iterable[tuple[Fraction, Fraction | Unknown]]) -> Fraction | Unknown:
    """The sum of coefficient times number, as ``weighted_sum``."""
    total = width = Fraction(0)
    unknown: Unknown | None = None
    for coefficient, number in numbers:
        if isinstance(number, Unknown):
            if not isinstance(number, Between):
                return number
            unknown = unknown or number
            width += abs(coefficient) * (number.high - number.low)
            number = number.low if coefficient > 0 else number.high
        total += number if coefficient == 1 else coefficient * number
    return (
        total if unknown is None else Between(unknown.name, unknown.objects, total, total + width)
    )


def number_of(term: ltl.Term, binding: ObjectBinding, state: PartialState) -> Fraction | Unknown:
    """The value of a quantity, or the number of counted objects."""
    match term:
        case ltl.QuantityTerm(name, arguments):
            return state.number(name, tuple([binding[variable] for variable in arguments]))
        case ltl.Count():
            return _reader_of(term)(binding, state)


def objects_counted(
    count: ltl.Count, binding: ObjectBinding, state: PartialState
) -> tuple[str, ...] | Unknown:
    """The objects that satisfy the body of a count."""
    alias, evaluate = alias_of(count.variable, count.body), evaluator_of(count.body)
    result = []
    for name, value in _counted(count, alias, evaluate, binding, state):
        if isinstance(value, Unknown):
            return value
        if value:
            result.append(name)
    return tuple(result)


def _counted(
    count: ltl.Count,
    alias: str | None,
    evaluate: Evaluator,
    binding: ObjectBinding,
    state: PartialState,
) -> Iterator[tuple[str, bool | Unknown]]:
    """The present objects of the counted type, and whether each satisfies the body."""
    fitting: dict[str, bool] = {}
    inner = dict(binding)
    present = state.objects
    candidates = present if alias is None else [binding[alias]] if binding[alias] in present else []
    for name in candidates:
        type_name = present[name]
        if type_name not in fitting:
            fitting[type_name] = state.vocabulary.is_subtype(type_name, count.type)
        if fitting[type_name]:
            inner[count.variable] = name
            yield name, evaluate(inner, state)


def alias_of(variable: str, formula: ltl.Formula) -> str | None:
    """Another variable that stands for the same object wherever the formula holds, or None."""
    match formula:
        case ltl.Same(left, right) if variable in (left, right) and left != right:
            return right if left == variable else left
        case ltl.Binary(ltl.BinaryOperator.AND, left, right):
            return alias_of(variable, left) or alias_of(variable, right)
    return None


def holds(formula: ltl.Formula, binding: ObjectBinding, state: PartialState) -> bool | Unknown:
    """The value of a formula in a state, perhaps unknown. TypeError for a temporal operator."""
    return evaluator_of(formula)(binding, state)


def propositions_that_count(
    formula: ltl.Formula, binding: ObjectBinding, state: PartialState
) -> Iterator[ltl.Proposition]:
    """The propositions of a state on which a formula may depend, whatever other states are like.

    Without those that another operand makes of no account: with ``p`` false, those of ``q`` in
    ``p and q``. They are in the formula's order, perhaps repeated.
    """
    match formula:
        case ltl.Unary(_, operand):
            yield from propositions_that_count(operand, binding, state)
        case ltl.Binary(operator, left, right):
            settles = _SETTLED_BY.get(operator, (None, None))
            for own, other, settling in zip((left, right), (right, left), settles, strict=True):
                if settling is None or _here(other, binding, state) is not settling:
                    yield from propositions_that_count(own, binding, state)
        case ltl.Atom() | ltl.Comparison():
            yield formula


_SETTLED_BY: Mapping[ltl.BinaryOperator, tuple[bool, bool]] = {
    ltl.BinaryOperator.AND: (False, False),
    ltl.BinaryOperator.OR: (True, True),
    ltl.BinaryOperator.IMPLIES: (True, False),
}
"""By which value of the right operand the left one is of no account, and the other way round."""


def _here(formula: ltl.Formula, binding: ObjectBinding, state: PartialState) -> bool | None:
    """A formula's value in a state; None if it is unknown, or also of other states."""
    try:
        value = holds(formula, binding, state)
    except TypeError:
        return None
    return None if isinstance(value, Unknown) else value


@lru_cache(maxsize=_MOST)
def evaluator_of(formula: ltl.Formula) -> Evaluator:
    """The formula as a function of binding and state, cached for all objects and states."""
    return fold(formula, _KLEENE)


def _proposition(proposition: ltl.Proposition) -> Evaluator:
    if isinstance(proposition, ltl.Comparison):
        return _comparison(proposition)
    if isinstance(proposition, ltl.Calculated):
        return partial(_calculated, proposition)
    return _atom(proposition.name, proposition.arguments, proposition.value or True)


def _calculated(
    proposition: ltl.Calculated, binding: ObjectBinding, state: PartialState
) -> bool | Unknown:
    """Calculated from the quantities, unless the state tells the comparison itself."""
    items = tuple([binding[variable] for variable in proposition.arguments])
    if proposition.name in state.vocabulary.declarations:
        told = state.value(proposition.name, items)
        if isinstance(told, bool):
            return told
    unknown: list[Unknown] = []

    def value_of(term: ltl.Term) -> Interval | None:
        number = number_of(term, binding, state)
        if not isinstance(number, Unknown):
            return number, number
        unknown.append(number)
        return (number.low, number.high) if isinstance(number, Between) else None

    surely = surely_compares(proposition, value_of)
    if surely is not None:
        return surely
    return (
        Unknown(unknown[0].name, unknown[0].objects)
        if unknown
        else Unknown(proposition.name, items)
    )


def surely_compares(
    proposition: ltl.Calculated, value_of: Callable[[ltl.Term], Interval | None]
) -> bool | None:
    """Whether the comparison holds for all values that its terms may have, or for none.

    None if that depends on them, or if something is divided by what may be 0. Values are taken as
    independent of each other, even those of one quantity that occurs twice.
    """
    ends = _between(number_compared(proposition), value_of)
    return None if ends is None else surely_stands(*ends, proposition.relation, Fraction(0))


def _between(
    number: ltl.NumberSum, value_of: Callable[[ltl.Term], Interval | None]
) -> Interval | None:
    low = high = number.constant
    for factor, part in number.parts:
        own = _of_part(part, value_of)
        if own is None:
            return None
        first, last = (factor * end for end in own)
        low, high = low + min(first, last), high + max(first, last)
    return low, high


def _of_part(
    part: ltl.Term | ltl.Operation, value_of: Callable[[ltl.Term], Interval | None]
) -> Interval | None:
    if not isinstance(part, ltl.Operation):
        return value_of(part)
    left, right = _between(part.left, value_of), _between(part.right, value_of)
    if left is None or right is None:
        return None
    if part.operator == "/":
        if right[0] <= 0 <= right[1]:
            return None
        right = 1 / right[1], 1 / right[0]
    if part.operator == "*" and part.left == part.right:
        squares = [end * end for end in left]
        return (Fraction(0) if left[0] < 0 < left[1] else min(squares)), max(squares)
    ends = [own * other for own in left for other in right]
    return min(ends), max(ends)


def _atom(name: str, arguments: tuple[str, ...], expected: bool | str) -> Evaluator:
    if len(arguments) == 1:
        return _atom_of_one(name, arguments[0], expected)

    def evaluate(binding: ObjectBinding, state: PartialState) -> bool | Unknown:
        value = state.value(name, tuple([binding[variable] for variable in arguments]))
        return value if isinstance(value, Unknown) else value == expected

    return evaluate


def _atom_of_one(name: str, argument: str, expected: bool | str) -> Evaluator:
    def evaluate(binding: ObjectBinding, state: PartialState) -> bool | Unknown:
        value = state.value(name, (binding[argument],))
        return value if isinstance(value, Unknown) else value == expected

    return evaluate


def _comparison(comparison: ltl.Comparison) -> Evaluator:
    relation, limit = comparison.relation, comparison.limit
    readers = [(factor, _reader_of(term)) for factor, term in comparison.terms]
    ((factor, read), *others) = readers
    is_sum = bool(others) or factor != 1

    def evaluate(binding: ObjectBinding, state: PartialState) -> bool | Unknown:
        if is_sum:
            number = _summed((factor, read(binding, state)) for factor, read in readers)
        else:
            number = read(binding, state)
        if not isinstance(number, Unknown):
            return stands(number, relation, limit)
        if not isinstance(number, Between):
            return number
        surely = surely_stands(number.low, number.high, relation, limit)
        return Unknown(number.name, number.objects) if surely is None else surely

    return evaluate


def _reader_of(term: ltl.Term) -> Callable[[ObjectBinding, PartialState], Fraction | Unknown]:
    """``number_of`` for one term, with everything prepared that does not depend on the state."""
    if isinstance(term, ltl.QuantityTerm):
        return partial(number_of, term)
    alias, evaluate = alias_of(term.variable, term.body), evaluator_of(term.body)

    def number(binding: ObjectBinding, state: PartialState) -> Fraction | Unknown:
        sure, unknown = 0, list[Unknown]()
        for _, value in _counted(term, alias, evaluate, binding, state):
            if isinstance(value, Unknown):
                unknown.append(value)
            else:
                sure += value
        if not unknown:
            return Fraction(sure)
        least, most = Fraction(sure), Fraction(sure + len(unknown))
        return Between(unknown[0].name, unknown[0].objects, least, most)

    return number


def _settled(left: Evaluator, right: Evaluator, *, by: bool) -> Evaluator:
    """A conjunction, which a false operand settles, or a disjunction, which a true one settles."""

    def evaluate(binding: ObjectBinding, state: PartialState) -> bool | Unknown:
        first = left(binding, state)
        if first is by:
            return by
        second = right(binding, state)
        return second if second is by or first is not_by else first

    not_by = not by
    return evaluate


def _constant(value: bool) -> Evaluator:
    return lambda _, __: value


def _identity(same: ltl.Same) -> Evaluator:
    left, right = same.left, same.right
    return lambda binding, _: binding[left] == binding[right]


def _negation(operand: Evaluator) -> Evaluator:
    def evaluate(binding: ObjectBinding, state: PartialState) -> bool | Unknown:
        value = operand(binding, state)
        return value if isinstance(value, Unknown) else not value

    return evaluate


def _equivalence(left: Evaluator, right: Evaluator) -> Evaluator:
    def evaluate(binding: ObjectBinding, state: PartialState) -> bool | Unknown:
        first, second = left(binding, state), right(binding, state)
        if isinstance(first, Unknown):
            return first
        return second if isinstance(second, Unknown) else first is second

    return evaluate


_KLEENE: Algebra[Evaluator] = Algebra(
    proposition=_proposition,
    constant=_constant,
    identity=_identity,
    negation=_negation,
    conjunction=partial(_settled, by=False),
    disjunction=partial(_settled, by=True),
    equivalence=_equivalence,
)
