"""Numbers in formulas: sums of quantities, of counts, of products; exact, with a dimension.

A number may depend on conditions: ``1.5 m if built_up else 2 m`` is one number in two cases, of
which exactly one holds at any time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import islice, product

from rulec.logic import formula as ltl
from rulec.logic.formula import all_of, any_of, negated
from rulec.logic.free_names import number_sum, renamed_number, terms_of, variables_of
from rulec.logic.linear_comparison import comparison
from rulec.logic.printing import sum_text
from rulec.vocabulary.dimensions import NUMBER, Dimension, Unit


def multiplication(left: ltl.NumberSum, right: ltl.NumberSum) -> ltl.Operation:
    """The product of two numbers, the same in either order."""
    first, second = sorted((left, right), key=sum_text)
    return ltl.Operation("*", first, second)


def calculated(number: ltl.NumberSum, relation: ltl.Relation, text: str) -> ltl.Calculated:
    """The comparison of a number with 0, which a rulebook spells like this."""
    variables = tuple(dict.fromkeys(_variables(number)))
    places = {name: f"x{place}" for place, name in enumerate(variables, 1)}
    name = ltl.with_arguments(text, places)
    return ltl.Calculated(name, variables, number=renamed_number(number, places), relation=relation)


def _variables(number: ltl.NumberSum) -> Iterator[str]:
    for term in terms_of(number):
        yield from variables_of(term)


MOST_CASES = 64
"""The most cases in one comparison; more could not be checked by reading."""

_LONGEST_TEXT = 50_000
_MOST_BITS = 20_000
"""A limit of a value's text and digits, which double if parameters use each other twice."""

SUM, PRODUCT, SIGN, PRIMARY = range(4)
"""The precedence of the outermost operator of a number's text."""


@dataclass(frozen=True, slots=True)
class Linear:
    """A sum of coefficients times terms or operations, and a constant, in base units.

    ``dimension`` is None for a bare 0, which fits any dimension. ``text`` is how a rulebook would
    write it, ``binding`` the precedence of its outermost operator. ``share`` is the unit of a
    number without dimension, such as `%`; empty if written without a unit, None if neither is so.
    """

    coefficients: Mapping[ltl.Term | ltl.Operation, Fraction]
    constant: Fraction
    dimension: Dimension | None
    text: str
    binding: int = PRIMARY
    share: str | None = None

    def __post_init__(self) -> None:
        """Raises TooManyCasesError."""
        bits = max(self.constant.numerator.bit_length(), self.constant.denominator.bit_length())
        if len(self.text) > _LONGEST_TEXT or bits > _MOST_BITS:
            raise TooManyCasesError

    def within(self, binding: int) -> str:
        """The text, in parentheses if it binds less tightly."""
        return self.text if self.binding >= binding else f"({self.text})"


Conditions = tuple[ltl.Formula, ...]

Case = tuple[Conditions, Linear]
"""A number, and the conditions under which it applies; none for a number without cases."""


@dataclass(frozen=True, slots=True)
class NumberByCases:
    """A number by cases, exactly one of which holds."""

    cases: tuple[Case, ...]

    @property
    def dimension(self) -> Dimension | None:
        """The dimension of all cases; None if all are a bare 0."""
        return next((linear.dimension for _, linear in self.cases if linear.dimension), None)

    @property
    def is_constant(self) -> bool:
        """Whether the number is the same in all states."""
        return len(self.cases) == 1 and not self.cases[0][1].coefficients

    @property
    def is_bare(self) -> bool:
        """Whether it is the same in all states and written without a unit, and not 0."""
        return any(linear.share == "" and not linear.coefficients for _, linear in self.cases)

    @property
    def share(self) -> str:
        """The unit, such as `%`, of quantities without dimension; empty if it has none."""
        shares = (linear.share for _, linear in self.cases if linear.coefficients)
        return next(filter(None, shares), "")

    @property
    def text(self) -> str:
        """The number as a rulebook would write it."""
        if len(self.cases) == 1:
            return self.cases[0][1].text
        return " or ".join(linear.text for _, linear in self.cases)


class TooManyCasesError(Exception):
    """An expression has too many cases or is too large."""


def share_of(unit: Unit) -> str | None:
    """What ``Linear`` has as the share of a number in a unit: `8 %` is not what `8` is."""
    return unit.text if unit.dimension == NUMBER and unit.factor != 1 else None


def constant(
    value: Fraction, dimension: Dimension | None, text: str, share: str | None = None
) -> NumberByCases:
    """A number that is the same in all states."""
    return NumberByCases((((), Linear({}, value, dimension, text, share=share)),))


def measured(term: ltl.Term, unit: Unit, text: str) -> NumberByCases:
    """A number that a state gives in a unit."""
    linear = Linear({term: unit.factor}, Fraction(0), unit.dimension, text, share=share_of(unit))
    return NumberByCases((((), linear),))


def counted(term: ltl.Term, text: str) -> NumberByCases:
    """A number of objects."""
    return NumberByCases((((), Linear({term: Fraction(1)}, Fraction(0), NUMBER, text)),))


def combined(
    left: NumberByCases, right: NumberByCases, combine: Callable[[Linear, Linear], Linear]
) -> NumberByCases:
    """An operation case by case. Raises TooManyCasesError."""
    return _in_cases((both, combine(*pair)) for both, *pair in _pairs(left, right))


def _pairs(
    left: NumberByCases, right: NumberByCases
) -> Iterator[tuple[Conditions, Linear, Linear]]:
    """The pairs of two numbers' cases, without those that exclude each other."""
    for (first, linear), (second, other) in product(left.cases, right.cases):
        both = (*first, *(condition for condition in second if condition not in first))
        if not any(negated(condition) in first for condition in second):
            yield both, linear, other


def _in_cases(cases: Iterable[Case]) -> NumberByCases:
    number = NumberByCases(tuple(islice(cases, MOST_CASES + 1)))
    if len(number.cases) > MOST_CASES:
        raise TooManyCasesError
    return number


def either(condition: ltl.Formula, value: NumberByCases, otherwise: NumberByCases) -> NumberByCases:
    """``value if condition else otherwise``. Raises TooManyCasesError."""
    if isinstance(condition, ltl.Constant):
        return value if condition.value else otherwise
    sides = ((condition, value), (negated(condition), otherwise))
    return _in_cases(
        ((test, *(condition for condition in when if condition != test)), linear)
        for test, number in sides
        for when, linear in number.cases
        if negated(test) not in when
    )


def added(left: Linear, right: Linear, sign: int = 1) -> Linear:
    """The sum or, with ``sign`` -1, the difference."""
    terms = dict(left.coefficients)
    for term, coefficient in right.coefficients.items():
        terms[term] = terms.get(term, Fraction(0)) + sign * coefficient
    return Linear(
        {term: coefficient for term, coefficient in terms.items() if coefficient},
        left.constant + sign * right.constant,
        right.dimension if left.dimension is None else left.dimension,
        f"{left.within(SUM)} {'+' if sign > 0 else '-'} {right.within(PRODUCT)}",
        SUM,
        share=_share_of_sum(left, right),
    )


def _share_of_sum(left: Linear, right: Linear) -> str | None:
    if left.dimension is None or right.dimension is None:
        return left.share if right.dimension is None else right.share
    return left.share if left.share == right.share or (left.share and right.share) else None


def multiplied(left: Linear, right: Linear) -> Linear:
    """The product of two numbers."""
    text = f"{left.within(PRODUCT)} * {right.within(SIGN)}"
    if left.coefficients and right.coefficients:
        return _operation(multiplication(_sum_of(left), _sum_of(right)), left, right, text)
    return _times(right, left, text) if right.coefficients else _times(left, right, text)


def divided(linear: Linear, divisor: Linear) -> Linear:
    """The quotient by a number that is no constant 0."""
    text = f"{linear.within(PRODUCT)} / {divisor.within(SIGN)}"
    dimension = None if divisor.dimension is None else divisor.dimension**-1
    if divisor.coefficients:
        quotient = ltl.Operation("/", _sum_of(linear), _sum_of(divisor))
        return _operation(quotient, linear, replace(divisor, dimension=dimension), text)
    # A number of percents is none of them: `slope / 1 %`.
    share = "" if divisor.share == "" else None
    return _times(linear, Linear({}, 1 / divisor.constant, dimension, "", share=share), text)


def _sum_of(linear: Linear) -> ltl.NumberSum:
    return number_sum(linear.coefficients, linear.constant)


def _operation(operation: ltl.Operation, left: Linear, right: Linear, text: str) -> Linear:
    dimension = None
    if left.dimension is not None and right.dimension is not None:
        dimension = left.dimension * right.dimension
    return Linear({operation: Fraction(1)}, Fraction(0), dimension, text, PRODUCT)


def _times(linear: Linear, factor: Linear, text: str) -> Linear:
    bare = linear.dimension is None or factor.dimension is None
    dimension = None
    if linear.dimension is not None and factor.dimension is not None:
        dimension = linear.dimension * factor.dimension
    by = factor.constant
    terms = {} if bare else {term: value * by for term, value in linear.coefficients.items() if by}
    # Twice a share is one, a share of a share is not.
    share = factor.share if linear.share == "" else linear.share if factor.share == "" else None
    return Linear(terms, linear.constant * by, dimension, text, PRODUCT, share=share)


def opposite(number: NumberByCases) -> NumberByCases:
    """The number with the other sign."""
    return NumberByCases(tuple((when, _opposite(linear)) for when, linear in number.cases))


def _opposite(linear: Linear) -> Linear:
    terms = {term: -coefficient for term, coefficient in linear.coefficients.items()}
    text = f"-{linear.within(SIGN)}"
    return Linear(terms, -linear.constant, linear.dimension, text, SIGN, share=linear.share)


def compared(left: NumberByCases, relation: ltl.Relation, right: NumberByCases) -> ltl.Formula:
    """``left relation right`` as a formula. Raises TooManyCasesError."""
    cases = [
        (both, added(first, second, -1), f"{first.text} {relation} {second.text}")
        for both, first, second in _pairs(left, right)
    ]
    if len(cases) > MOST_CASES:
        raise TooManyCasesError
    return any_of(
        all_of([*conditions, _comparison(linear, relation, text)])
        for conditions, linear, text in cases
    )


def _comparison(linear: Linear, relation: ltl.Relation, text: str) -> ltl.Formula:
    """``linear relation 0``."""
    terms: dict[ltl.Term, Fraction] = {}
    for part, factor in linear.coefficients.items():
        if isinstance(part, ltl.Operation):
            return calculated(_sum_of(linear), relation, text)
        terms[part] = factor
    return comparison(terms, relation, -linear.constant, text)
