"""What rules compare quantities with: on the same side of all of it numbers are alike."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import TypeAlias

from rulec.automata.axiom_instances import counts
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.automata.mealy_monitor import NumberRead
from rulec.automata.thresholds import EXACT_IN_FLOATS, scale
from rulec.logic.free_names import names_in
from rulec.vocabulary import Quantity

Floors: TypeAlias = Mapping[str, tuple[float, ...] | None]
"""By quantity ``floor_of`` each threshold of any rule, in order; None if every value matters.

The first is the least number that may be told apart by them, the last the first one beyond.
"""


def breakpoints_of(rulebook: CompiledRulebook) -> Floors:
    """What all rules together compare the quantities of their vocabulary with."""
    floors: dict[str, set[float]] = {
        name: set()
        for name, one in rulebook.vocabulary.declarations.items()
        if isinstance(one, Quantity)
    }
    all_matter = set[str]()
    for rule in rulebook.rules:
        for read in rule.machine.reads:
            if isinstance(read, NumberRead):
                about = scale(read)
                if about.quantity is None:
                    all_matter.update(about.names)
                else:
                    floors[about.quantity.name].update(about.floors)
    if any(counts(fact.formula) for fact in rulebook.axioms):
        all_matter.update(name for fact in rulebook.axioms for name in names_in(fact.formula))
    return {
        name: None if name in all_matter else _within_reach(those) for name, those in floors.items()
    }


def _within_reach(floors: Iterable[float]) -> tuple[float, ...]:
    # Beyond, whole numbers and floats are no longer told apart by the same floors.
    most = float(EXACT_IN_FLOATS)
    return (-most, *sorted([one for one in floors if -most < one < most]), most)
