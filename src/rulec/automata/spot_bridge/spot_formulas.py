"""LTL formulas as formulas of Spot (Duret-Lutz and others, Spot 2.x)."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import spot

import buddy  # isort: skip - only once spot has been imported

from rulec.automata.alphabet import AND, NOT, OR, joined, names_of, propositions_of
from rulec.automata.tables import MOST_EDGES, MOST_STATES, SizeError
from rulec.logic.bounds import Range
from rulec.logic.fold import Algebra, fold, temporal_operation
from rulec.logic.formula import Constant, Formula, Proposition, Unary

F = spot.formula
_SIZES = f"det-max-states={MOST_STATES},det-max-edges={MOST_EDGES}"
_STRONG_NEXT = F("X[!]p").kind()
"""Spot's `X` is weak where a word may end, and the strong one has no constructor."""


class SpotFormulas:
    """Translator of past-free formulas to Spot's formulas; each subformula is translated once.

    All automata made of them share one dictionary of propositions.

    ``names`` maps propositions to names; ``alive`` is the name of the proposition that is true
    while a finite word lasts, None if words are infinite.
    """

    def __init__(self, names: Mapping[Proposition, str], alive: str | None) -> None:
        self.names = names
        self.alive = alive
        self.dictionary = spot.make_bdd_dict()
        # Propositions become the first variables, so letters are tested before obligations.
        self._keeper = spot.make_twa_graph(self.dictionary)
        for name in sorted({*names.values(), *([] if alive is None else [alive])}):
            self._keeper.register_ap(name)
        self._known: dict[Formula, Any] = {}

    def translate(self, language: Any, *shape: str) -> Any:
        """Translate Spot's LTL formula to an automaton over the shared dictionary.

        Raises SizeError if a deterministic one is wanted, and it gets too large.
        """
        found = spot.translate(language, *shape, dict=self.dictionary, xargs=_SIZES)
        if "det" in shape and not spot.is_deterministic(found):
            raise SizeError
        return found

    def formula_of(self, formula: Formula) -> Any:
        """Spot's formula; in LTLf if words are finite."""
        return fold(formula, self._algebra(), self._known)

    def language(self, formulas: Iterable[Any]) -> Any:
        """The conjunction of Spot's formulas, as one LTL formula."""
        together = F.And(list(formulas))
        return together if self.alive is None else spot.from_ltlf(together, self.alive)

    def _algebra(self) -> Algebra[Any]:
        # Not cached: a reference cycle would keep Spot's objects alive, and the numbers that Spot
        # gives to formulas determine the order of edges.
        return Algebra(
            proposition=lambda proposition: F.ap(self.names[proposition]),
            constant=lambda value: F.tt() if value else F.ff(),
            negation=F.Not,
            conjunction=lambda left, right: F.And([left, right]),
            disjunction=lambda left, right: F.Or([left, right]),
            implication=F.Implies,
            equivalence=F.Equiv,
            difference=F.Xor,
            operation=temporal_operation(
                F.Not,
                until=self._until,
                release=self._release,
                weak_until=self._weak_until,
                strong_release=self._strong_release,
            ),
        )

    def _until(self, left: Any | None, right: Any, span: Range) -> Any:
        left, (low, high) = F.tt() if left is None else left, span
        if high is not None and high < low:
            return F.ff()
        now = F.U(left, right) if high is None else right
        for _ in range(0 if high is None else high - low):
            now = F.Or([right, F.And([left, self._next(now)])])
        for _ in range(low):
            now = F.And([left, self._next(now)])
        return now

    def _release(self, left: Any | None, right: Any, span: Range) -> Any:
        left, (low, high) = F.ff() if left is None else left, span
        if high is not None and high < low:
            return F.tt()
        now = F.R(left, right) if high is None else right
        for _ in range(0 if high is None else high - low):
            now = F.And([right, F.Or([left, F.X(now)])])
        for _ in range(low):
            now = F.Or([left, F.X(now)])
        return now

    def _weak_until(self, left: Any, right: Any, span: Range) -> Any:
        if span == (0, None):
            return F.W(left, right)
        lasting = self._release(None, left, Range(0, span.high))
        return F.Or([self._until(left, right, span), lasting])

    def _strong_release(self, left: Any, right: Any, span: Range) -> Any:
        if span == (0, None):
            return F.M(left, right)
        reached = self._until(None, left, Range(0, span.high))
        return F.And([self._release(left, right, span), reached])

    def _next(self, inner: Any) -> Any:
        return F.X(inner) if self.alive is None else F.unop(_STRONG_NEXT, inner)


def projected(known: Formula, propositions: Sequence[Proposition]) -> Formula:
    """The exact projection of ``known``, without temporal operators, onto these propositions.

    It holds for values of these if ``known`` does for some values of all others. False if ``known``
    cannot hold, true if it implies nothing about them.
    """
    every = propositions_of(known)
    names = names_of([*propositions, *every])
    spot_formulas = SpotFormulas(names, None)
    owner = spot.make_twa_graph(spot_formulas.dictionary)
    condition = spot.formula_to_bdd(
        spot_formulas.formula_of(known), spot_formulas.dictionary, owner
    )
    others = buddy.bddtrue
    for atom in set(every) - set(propositions):
        others &= buddy.bdd_ithvar(owner.register_ap(names[atom]))
    result = spot.bdd_to_formula(buddy.bdd_exist(condition, others), spot_formulas.dictionary)
    return _read_back(result, {name: proposition for proposition, name in names.items()})


def _read_back(formula: Any, named: dict[str, Proposition]) -> Formula:
    if formula.is_tt() or formula.is_ff():
        return Constant(bool(formula.is_tt()))
    if formula._is(spot.op_ap):
        return named[formula.ap_name()]
    parts = [_read_back(part, named) for part in formula]
    if formula._is(spot.op_Not):
        return Unary(NOT, parts[0])
    return joined(AND if formula._is(spot.op_And) else OR, parts)
