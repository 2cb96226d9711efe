"""Margins: the two sides of a comparison in one state, in one unit."""

from __future__ import annotations

from collections.abc import Mapping, Set
from dataclasses import dataclass, replace
from fractions import Fraction
from math import ceil, floor, log10

from rulec.logic import formula as ltl
from rulec.logic.kleene import Between, Unknown, weighted_sum
from rulec.logic.linear_comparison import DENIED, MIRRORED, stands
from rulec.logic.printing import term_text
from rulec.monitoring.state_view import StateView
from rulec.vocabulary import Quantity

_Quantity = ltl.QuantityTerm
_MOST_PLACES, _ROUNDED_UP, _HAIR = 7, 1.5, 1e-6
_BASE = frozenset(("<", "<=", "="))


@dataclass(frozen=True, slots=True)
class Margin:
    """The left side of a comparison, its value, the relation that holds, and the other value.

    ``against`` is the right side, if it is a single quantity. Each value may be wrong by its error,
    their difference by ``error``.
    """

    text: str
    value: float
    relation: ltl.Relation
    limit: float
    unit: str
    against: str = ""
    value_error: float = 0.0
    limit_error: float = 0.0
    error: float = 0.0

    @property
    def by(self) -> float:
        """The measured difference; the certain one if a number is known only by bounds."""
        if self.value_bounds or self.limit_bounds:
            return self.at_least
        return _without_noise(abs(self.value - self.limit))

    @property
    def share(self) -> float:
        """``by`` as a share of the larger of the two sides (0 to 2), independent of the unit."""
        return self.by / (max(abs(self.value), abs(self.limit)) or 1.0)

    @property
    def at_least(self) -> float:
        """The certain part of the difference."""
        return _without_noise(max(abs(self.value - self.limit) - self.error, 0.0))

    @property
    def is_sure(self) -> bool:
        """Whether the relation holds wherever both values are within their errors."""
        return _without_noise(self.error - abs(self.value - self.limit)) <= 0.0

    @property
    def value_bounds(self) -> tuple[float, float] | None:
        """The bounds of the value if nothing more is known, such as 3.9 to 1000; else None."""
        return _bounds(self.value, self.value_error)

    @property
    def limit_bounds(self) -> tuple[float, float] | None:
        """The same for the limit."""
        return _bounds(self.limit, self.limit_error)

    def rounded(self) -> Margin:
        """The margin rounded to the digits that its errors justify: two of each error, rounded up.

        Bounds, which are rounded to a hundredth already, are kept.
        """
        if self.value_bounds or self.limit_bounds:
            return self
        known = [error for error in (self.value_error, self.limit_error) if error > 0]
        if not known:
            return replace(self, value=_in_nine(self.value), limit=_in_nine(self.limit))
        places = max(1 - floor(log10(min(known))), 0)
        while places < _MOST_PLACES and round(self.value, places) == round(self.limit, places):
            places += 1

        scale = 10.0**places

        def up(error: float) -> float:
            return ceil(error * scale - _HAIR) / scale

        return replace(
            self,
            value=round(self.value, places),
            limit=round(self.limit, places),
            value_error=up(self.value_error),
            limit_error=up(self.limit_error),
            error=up(self.error),
        )

    @property
    def sides(self) -> str:
        """Both values and the relation between them, such as ``12.3 < 15.5`` or ``12.3±0.4``."""
        value, limit = self._texts()
        return f"{value} {self.relation} {limit}"

    def __str__(self) -> str:
        value, limit = self._texts()
        unit = f" {self.unit}" if self.unit else ""
        right = f"{self.against} {limit}".lstrip()
        text = f"{self.text} {value}{unit} {self.relation} {right}{unit}"
        least = _rounded_down(self.at_least) if self.error else ""
        return f"{text}, by at least {least}{unit}" if least else text

    def _texts(self) -> tuple[str, str]:
        value, limit = _apart(self.value, self.limit)
        places = len(value.partition(".")[2])
        if self.value_error:
            value = number_with_error(self.value, self.value_error, places)
        if self.limit_error:
            limit = number_with_error(self.limit, self.limit_error, places)
        return value, limit


def _bounds(number: float, error: float) -> tuple[float, float] | None:
    """The bounds of a number whose error exceeds half of it; else None."""
    if error <= abs(number) / 2:
        return None
    return _without_noise(number - error), _without_noise(number + error)


def _without_noise(number: float) -> float:
    """A difference without floating-point noise."""
    return round(number, 9)


def _in_nine(number: float) -> float:
    return float(f"{number:.9g}")


def margin_in(
    comparison: ltl.Comparison, bound: Mapping[str, str], view: StateView
) -> Margin | Unknown:
    """The margin of a comparison, with the terms with positive coefficients on the left.

    If two quantities are compared, the left one is the one written there, as in ``speed <= limit``.
    """
    left = tuple(term for term in comparison.terms if term[0] > 0)
    right = tuple((-coefficient, term) for coefficient, term in comparison.terms if coefficient < 0)
    value, rest = weighted_sum(left, bound, view), weighted_sum(right, bound, view)
    if isinstance(value, Unknown) and not isinstance(value, Between):
        return value
    if isinstance(rest, Unknown) and not isinstance(rest, Between):
        return rest
    (value, value_error), (rest, limit_error) = _middle(value), _middle(rest)
    limit = comparison.limit + rest
    holds = stands(value, comparison.relation, limit)
    relation = comparison.relation if holds else DENIED[comparison.relation]
    (_, lead), *more = left
    declaration = view.vocabulary.declarations[lead.name] if isinstance(lead, _Quantity) else None
    unit = declaration.unit if isinstance(declaration, Quantity) else ""
    against = ""
    if len(right) == 1 and right[0][0] == 1 and not comparison.limit:
        against = _named(right[0][1], bound)
    text = _named(lead, bound) + (" + …" if more else "")
    margin = Margin(
        text,
        value=float(value),
        relation=relation,
        limit=float(limit),
        unit=unit,
        against=against,
        value_error=float(value_error),
        limit_error=float(limit_error),
        error=float(value_error + limit_error),
    )
    two = len(left) == 1 and left[0][0] == 1 and against
    return (
        _turned(margin)
        if two and comparison.text.startswith(f"{term_text(right[0][1])} ")
        else margin
    )


def choosing_comparisons(formula: ltl.Formula) -> Set[ltl.Formula]:
    """The comparisons that occur in a formula both plain and negated, as in `a if c else b`.

    ``x >= 3`` counts as ``x < 3`` negated.
    """
    about: dict[ltl.Formula, object] = {}
    signs: dict[object, set[bool]] = {}

    def look(part: ltl.Formula, *, plain: bool) -> None:
        match part:
            case ltl.Comparison(terms, relation, limit):
                is_base = relation in _BASE
                about[part] = terms, limit, relation if is_base else DENIED[relation]
                signs.setdefault(about[part], set()).add(plain is is_base)
            case ltl.Unary(ltl.UnaryOperator.NOT, ltl.Comparison() as inner):
                look(inner, plain=not plain)
            case ltl.Unary(_, inner):
                look(inner, plain=plain)
            case ltl.Binary(_, left, right):
                look(left, plain=plain)
                look(right, plain=plain)

    look(formula, plain=True)
    return {part for part, own in about.items() if len(signs[own]) > 1}


def _turned(margin: Margin) -> Margin:
    """A margin between two quantities, with the other one on the left."""
    return replace(
        margin,
        text=margin.against,
        value=margin.limit,
        relation=MIRRORED[margin.relation],
        limit=margin.value,
        against=margin.text,
        value_error=margin.limit_error,
        limit_error=margin.value_error,
    )


def _middle(number: Fraction | Between) -> tuple[Fraction, Fraction]:
    """A number, and how far it may be wrong."""
    if isinstance(number, Between):
        return (number.low + number.high) / 2, (number.high - number.low) / 2
    return number, Fraction(0)


def _rounded_down(number: float) -> str:
    """A positive number with two significant digits; empty for none."""
    for places in range(1, _MOST_PLACES):
        rounded = floor(number * 10**places + _HAIR)
        if rounded >= 10:
            return f"{rounded / 10**places:.{places}f}"
    return ""


def number_with_error(value: float, error: float, places: int = 0) -> str:
    """A number with its error, which is rounded up by at most a half: ``12.3±0.4``.

    If the error exceeds half of the number, both bounds are given instead: ``3.9 to 1000``.
    """
    if error > abs(value) / 2:
        low, high = floor((value - error) * 100 + _HAIR), ceil((value + error) * 100 - _HAIR)
        return f"{low / 100:.6g} to {high / 100:.6g}"
    for more in range(places, places + _MOST_PLACES):
        rounded = ceil(error * 10**more - _HAIR) / 10**more
        if rounded <= _ROUNDED_UP * error:
            return f"{value:.{more}f}±{rounded:.{more}f}"
    return f"{value:g}±{error:g}"


def _named(term: ltl.Term, bound: Mapping[str, str]) -> str:
    """A term with the objects of its variables."""
    if isinstance(term, _Quantity):
        term = _Quantity(term.name, tuple([bound[name] for name in term.arguments]))
    return term_text(term)


def _apart(value: float, limit: float) -> tuple[str, str]:
    """Two numbers with as few decimals as distinguish them."""
    if value == int(value) and limit == int(limit):
        return f"{value:.0f}", f"{limit:.0f}"
    pairs = [(f"{value:.{places}f}", f"{limit:.{places}f}") for places in range(1, 7)]
    return next((pair for pair in pairs if pair[0] != pair[1]), pairs[0])
