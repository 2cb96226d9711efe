"""Breakpoints of quantities: thresholds between values alike for every rule."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TypeAlias

from rulec.automata.axiom_instances import counts
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead
from rulec.automata.thresholds import EXACT_IN_FLOATS, scale
from rulec.logic.free_names import names_in
from rulec.vocabulary import Quantity

Breakpoints: TypeAlias = Mapping[str, tuple[float, ...] | None]
"""By quantity the ``floor_of`` each threshold of any rule, ascending; None if all values matter.

The first is the least number that may be told apart by them, the last the first one beyond.
"""


def breakpoints_of(rulebook: CompiledRulebook) -> Breakpoints:
    """The breakpoints of a vocabulary's quantities under all rules together."""
    floors: dict[str, set[float]] = {
        name: set()
        for name, declaration in rulebook.vocabulary.declarations.items()
        if isinstance(declaration, Quantity)
    }
    all_matter = set[str]()
    for rule in rulebook.rules:
        for read in rule.machine.reads:
            if isinstance(read, NumberRead):
                threshold_scale = scale(read)
                if threshold_scale.quantity is None:
                    all_matter.update(threshold_scale.names)
                else:
                    floors[threshold_scale.quantity.name].update(threshold_scale.floors)
    if any(counts(axiom.formula) for axiom in rulebook.axioms):
        all_matter.update(name for axiom in rulebook.axioms for name in names_in(axiom.formula))
    return {
        name: None if name in all_matter else _within_reach(own) for name, own in floors.items()
    }


def _within_reach(floors: Iterable[float]) -> tuple[float, ...]:
    # Beyond, whole numbers and floats are no longer told apart by the same floors.
    most = float(EXACT_IN_FLOATS)
    return (-most, *sorted([floor for floor in floors if -most < floor < most]), most)
