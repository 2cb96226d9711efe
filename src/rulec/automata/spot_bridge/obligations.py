"""The obligations of a formula on a word, and their progression by letters.

A formula is a Boolean function of the current letter's propositions and of obligations for the rest
of the word: each is an until or a release with what remains of its range.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from fractions import Fraction
from functools import partial
from itertools import pairwise
from typing import Any, NamedTuple, TypeAlias

import spot

from rulec.logic import formula as ltl

import buddy  # isort: skip - only once spot has been imported

from rulec.automata.alphabet import fresh_name
from rulec.automata.spot_bridge.spot_formulas import SpotFormulas
from rulec.logic.bounds import Range, range_of
from rulec.logic.fold import Algebra, fold

_NOT, _OR, _AND = ltl.UnaryOperator.NOT, ltl.BinaryOperator.OR, ltl.BinaryOperator.AND
_FALSE, _TRUE = ltl.Constant(False), ltl.Constant(True)


class _Obligation(NamedTuple):
    """A pending until (``strong``) or release, with the rest of its range."""

    strong: bool
    left: ltl.Formula
    right: ltl.Formula
    span: Range


_Signed: TypeAlias = Callable[[bool], Any]
"""Maps True to a formula's BDD and False to its negation's; negation is pushed down to obligations,
so that no BDD contains a negated obligation.
"""


def _joined(both: bool, left: _Signed, right: _Signed) -> _Signed:
    """A conjunction (``both``) or disjunction, negated by De Morgan's laws."""

    def signed(polarity: bool) -> Any:
        first, second = left(polarity), right(polarity)
        return first & second if both is polarity else first | second

    return signed


def _equivalence(left: _Signed, right: _Signed) -> _Signed:
    return lambda polarity: (left(True) & right(polarity)) | (left(False) & right(not polarity))


class Obligations:
    """The obligations of a formula without past operators, as variables of BDDs.

    ``propositions`` is a graph without states that has a variable for each: those of letters, by
    their ``names``, come before those of obligations. ``first`` is what the formula demands of a
    letter and of the rest of the word, ``unfolded`` what each obligation demands, by its variable,
    and ``known`` the implications between obligations. ``is_safety``: every rejected word has a
    prefix that decides this; ``is_cosafety``: every accepted word has one. Both are judged by the
    formula's operators, so each may be false although the property holds.
    """

    def __init__(self, formula: ltl.Formula, spot_formulas: SpotFormulas) -> None:
        self.propositions = spot.make_twa_graph(spot_formulas.dictionary)
        self.names = {atom: spot_formulas.names[atom] for atom in ltl.atoms_of(formula)}
        self._letters = {
            atom: buddy.bdd_ithvar(self.propositions.register_ap(name))
            for atom, name in self.names.items()
        }
        self._variables: dict[_Obligation, Any] = {}
        self._taken = {*spot_formulas.names.values(), spot_formulas.alive or ""}
        self.first = self._now(formula, True)
        self.unfolded = {
            buddy.bdd_var(self._variables[obligation]): self._unfolded(obligation)
            for obligation in self._all()
        }
        self.is_safety = not any(o.strong and o.span.high is None for o in self._variables)
        self.is_cosafety = all(o.strong or o.span.high is not None for o in self._variables)
        self.known = self._implications()
        self._at_end = buddy.bddtrue
        for obligation, variable in reversed(self._variables.items()):
            self._at_end &= -variable if obligation.strong else variable

    def _all(self) -> Iterator[_Obligation]:
        """All obligations; unfolding one of them may add more."""
        done = 0
        while done < len(self._variables):
            pending = list(self._variables)[done:]
            done += len(pending)
            yield from pending

    def _variable(self, _obligation: _Obligation) -> Any:
        if _obligation not in self._variables:
            name = fresh_name(f"obligation {len(self._variables)}", self._taken)
            self._variables[_obligation] = buddy.bdd_ithvar(self.propositions.register_ap(name))
        return self._variables[_obligation]

    def _now(self, formula: ltl.Formula, polarity: bool) -> Any:
        # Not cached: that would be a reference cycle, and BDDs would outlive their use.
        algebra: Algebra[_Signed] = Algebra(
            proposition=self._proposition,
            constant=lambda value: (
                lambda polarity: buddy.bddtrue if value is polarity else buddy.bddfalse
            ),
            negation=lambda operand: lambda polarity: operand(not polarity),
            conjunction=partial(_joined, True),
            disjunction=partial(_joined, False),
            equivalence=_equivalence,
            operation=self._operation,
        )
        return fold(formula, algebra)(polarity)

    def _proposition(self, proposition: ltl.Proposition) -> _Signed:
        letters = self._letters[proposition]
        return lambda polarity: letters if polarity else -letters

    def _operation(
        self, formula: ltl.Unary | ltl.Binary, _: Callable[[ltl.Formula], _Signed]
    ) -> _Signed:
        span = range_of(formula)
        return lambda polarity: self._temporal(formula, span, polarity)

    def _temporal(self, formula: ltl.Unary | ltl.Binary, span: Range, polarity: bool) -> Any:
        match formula:
            case ltl.Unary(ltl.UnaryOperator.NEXT | ltl.UnaryOperator.EVENTUALLY, operand):
                obligation = _Obligation(True, _TRUE, operand, span)
            case ltl.Unary(ltl.UnaryOperator.WEAK_NEXT | ltl.UnaryOperator.ALWAYS, operand):
                obligation = _Obligation(False, _FALSE, operand, span)
            case ltl.Unary(ltl.UnaryOperator.NEVER, operand):
                obligation = _Obligation(False, _FALSE, ltl.Unary(_NOT, operand), span)
            case ltl.Binary(ltl.BinaryOperator.UNTIL | ltl.BinaryOperator.THEN, left, right):
                obligation = _Obligation(True, left, right, span)
            case ltl.Binary(ltl.BinaryOperator.RELEASE, left, right):
                obligation = _Obligation(False, left, right, span)
            case ltl.Binary(ltl.BinaryOperator.STRONG_RELEASE, left, right, bound):
                turned = ltl.Unary(_NOT, left), ltl.Unary(_NOT, right)
                return self._now(
                    ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, *turned, bound), not polarity
                )
            case ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, left, right) if span == Range(0, None):
                obligation = _Obligation(False, right, ltl.Binary(_OR, left, right), Range(0, None))
            case ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, left, right):
                return self._now(_weak_until(left, right, span), polarity)
            case _:
                raise ValueError("operators of the past have no future")
        if not polarity:
            turned = ltl.Unary(_NOT, obligation.left), ltl.Unary(_NOT, obligation.right)
            obligation = _Obligation(not obligation.strong, *turned, span)
        return self._unfolded(obligation)

    def _unfolded(self, _obligation: _Obligation) -> Any:
        strong, left, right, (low, high) = _obligation
        if high is not None and high < low:
            return buddy.bddfalse if strong else buddy.bddtrue
        if high is not None and 0 < low < high and left == (_TRUE if strong else _FALSE):
            # Split into single instants, so that overlapping ranges share their obligations.
            demand = buddy.bddfalse if strong else buddy.bddtrue
            for distance in range(low, high + 1):
                there = self._unfolded(_obligation._replace(span=Range(distance, distance)))
                demand = demand | there if strong else demand & there
            return demand
        now = self._now(right, True) if low == 0 else buddy.bddfalse if strong else buddy.bddtrue
        if low == 0 and high == 0:
            return now
        rest = Range(max(low - 1, 0), None if high is None else high - 1)
        later = self._variable(_obligation._replace(span=rest))
        if strong:
            return now | (self._now(left, True) & later)
        return now & (self._now(left, True) | later)

    def _implications(self) -> Any:
        """The implications between obligations: a shorter until implies a longer one."""
        families: dict[tuple[bool, ltl.Formula, ltl.Formula], list[tuple[float, Any]]] = {}
        for obligation, variable in self._variables.items():
            if obligation.span.low == 0:
                reach = float("inf") if obligation.span.high is None else obligation.span.high
                families.setdefault(obligation[:3], []).append((reach, variable))
        known = buddy.bddtrue
        for (strong, _, _), family in families.items():
            family.sort(key=lambda each: each[0], reverse=not strong)
            for (_, shorter), (_, longer) in pairwise(family):
                known &= -shorter | longer
        return known

    def ends_well(self, state: Any) -> bool:
        """Whether a word may end in a state, with its pending untils unfulfilled."""
        return bool(buddy.bdd_restrict(state, self._at_end) == buddy.bddtrue)


def _weak_until(left: ltl.Formula, right: ltl.Formula, span: Range) -> ltl.Formula:
    """A bounded ``weak until``, expressed by other operators and the unbounded one."""

    def steps(first: int, last: int) -> ltl.Bound:
        return ltl.Bound(Fraction(first), Fraction(last), "steps")

    low, high = span
    if high is not None:
        lasting = ltl.Unary(ltl.UnaryOperator.ALWAYS, left, steps(0, high))
        until = ltl.Binary(ltl.BinaryOperator.UNTIL, left, right, steps(low, high))
        return ltl.Binary(_OR, until, lasting)
    first = ltl.Unary(ltl.UnaryOperator.ALWAYS, left, steps(0, low - 1))
    weak = ltl.Binary(ltl.BinaryOperator.WEAK_UNTIL, left, right)
    return ltl.Binary(_AND, first, ltl.Unary(ltl.UnaryOperator.WEAK_NEXT, weak, steps(low, low)))
