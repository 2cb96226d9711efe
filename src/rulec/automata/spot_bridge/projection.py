"""Projection: knowledge of some propositions, whatever the others are."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import spot

import buddy  # isort: skip - only once spot has been imported

from rulec.automata.alphabet import AND, NOT, OR, joined, names_of, propositions_of
from rulec.automata.spot_bridge.spot_formulas import SpotFormulas
from rulec.logic.formula import Constant, Formula, Proposition, Unary


def projected(known: Formula, propositions: Sequence[Proposition]) -> Formula:
    """The exact projection of ``known``, without temporal operators, onto these propositions.

    It holds for their values if ``known`` does for some values of all others. False if ``known``
    cannot hold, true if it says nothing of them.
    """
    every = propositions_of(known)
    names = names_of([*propositions, *every])
    spot_formulas = SpotFormulas(names, None)
    owner = spot.make_twa_graph(spot_formulas.dictionary)
    condition = spot.formula_to_bdd(
        spot_formulas.formula_of(known), spot_formulas.dictionary, owner
    )
    others = buddy.bddtrue
    for one in set(every) - set(propositions):
        others &= buddy.bdd_ithvar(owner.register_ap(names[one]))
    result = spot.bdd_to_formula(buddy.bdd_exist(condition, others), spot_formulas.dictionary)
    return _read(result, {name: one for one, name in names.items()})


def _read(said: Any, named: dict[str, Proposition]) -> Formula:
    """A Boolean formula of Spot's as one of ours."""
    if said.is_tt() or said.is_ff():
        return Constant(bool(said.is_tt()))
    if said._is(spot.op_ap):
        return named[said.ap_name()]
    if said._is(spot.op_Not):
        return Unary(NOT, _read(said[0], named))
    parts = [_read(one, named) for one in said]
    # A disjunction of conjunctions.
    return joined(AND if said._is(spot.op_And) else OR, parts)
