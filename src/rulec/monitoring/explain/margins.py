"""Margins: the two sides of a comparison in one state, in one unit."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

from rulec.logic import formula as ltl
from rulec.logic.kleene import Unknown, weighted_sum
from rulec.logic.linear_comparison import stands
from rulec.logic.printing import term_text
from rulec.monitoring.state_view import StateView
from rulec.vocabulary import Quantity

_Quantity = ltl.QuantityTerm
_OTHERWISE: Mapping[ltl.Relation, ltl.Relation] = {
    "<": ">=",
    "<=": ">",
    "=": "!=",
    "!=": "=",
    ">=": "<",
    ">": "<=",
}


@dataclass(frozen=True, slots=True)
class Margin:
    """What stands on the left, its value, the relation that holds, and the other value.

    ``against`` is what stands on the right, if that is a quantity and nothing else.
    """

    text: str
    value: float
    relation: ltl.Relation
    limit: float
    unit: str
    against: str = ""

    @property
    def sides(self) -> str:
        """Both values and the relation between them, such as ``12.3 < 15.5``."""
        value, limit = _apart(self.value, self.limit)
        return f"{value} {self.relation} {limit}"

    def __str__(self) -> str:
        value, limit = _apart(self.value, self.limit)
        unit = f" {self.unit}" if self.unit else ""
        right = f"{self.against} {limit}".lstrip()
        return f"{self.text} {value}{unit} {self.relation} {right}{unit}"


def margin_in(
    comparison: ltl.Comparison, bound: Mapping[str, str], view: StateView
) -> Margin | Unknown:
    """The margin of a comparison: what has a positive coefficient stands on the left."""
    left = tuple(term for term in comparison.terms if term[0] > 0)
    right = tuple((-coefficient, term) for coefficient, term in comparison.terms if coefficient < 0)
    value, rest = weighted_sum(left, bound, view), weighted_sum(right, bound, view)
    if isinstance(value, Unknown):
        return value
    if isinstance(rest, Unknown):
        return rest
    limit = comparison.limit + rest
    holds = stands(value, comparison.relation, limit)
    relation = comparison.relation if holds else _OTHERWISE[comparison.relation]
    (_, lead), *more = left
    declaration = view.vocabulary.declarations[lead.name] if isinstance(lead, _Quantity) else None
    unit = declaration.unit if isinstance(declaration, Quantity) else ""
    against = ""
    if len(right) == 1 and right[0][0] == 1 and not comparison.limit:
        against = _named(right[0][1], bound)
    text = _named(lead, bound) + (" + …" if more else "")
    return Margin(
        text, value=float(value), relation=relation, limit=float(limit), unit=unit, against=against
    )


def _named(term: ltl.Term, bound: Mapping[str, str]) -> str:
    """A term with the objects of its variables."""
    if isinstance(term, _Quantity):
        term = _Quantity(term.name, tuple([bound[name] for name in term.arguments]))
    return term_text(term)


def _apart(value: float, limit: float) -> tuple[str, str]:
    """Two numbers with as few decimals as tell them apart."""
    if value == int(value) and limit == int(limit):
        return f"{value:.0f}", f"{limit:.0f}"
    pairs = [(f"{value:.{places}f}", f"{limit:.{places}f}") for places in range(1, 7)]
    return next((pair for pair in pairs if pair[0] != pair[1]), pairs[0])
