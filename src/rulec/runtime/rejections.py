"""Which rule rejects what: how many paths, how many that all other rules would let pass."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

from rulec.runtime.effects import LOST, SAFE, Effect, Effects
from rulec.runtime.product import Joint, Product, explore

NOBODY = -1
"""In place of a rule: none has been violated."""

Blaming = tuple[Joint, int]
"""The machines' states, and the one rule that has been violated so far, or NOBODY."""


@dataclass(frozen=True, slots=True)
class Rejections:
    """The paths that a rule rejects, and those that it alone rejects, in products accepting them.

    Where it rejects nothing, or nothing alone, there is none.
    """

    rule: str
    every: Product | None
    alone: Product | None


def rejections(effects: Effects) -> list[Rejections]:
    """For every rule that rejects anything what it rejects, in the order of ``instances``."""
    rules = list(dict.fromkeys(one.rule.name for one in effects.instances))
    of = [rules.index(one.rule.name) for one in effects.instances]
    alone = _blaming(effects, of)
    return [
        Rejections(
            rule,
            _violating(_blaming(effects.of(indices), [number] * len(indices)), number),
            _violating(alone, number),
        )
        for number, rule in enumerate(rules)
        for indices in [[i for i, one in enumerate(of) if one == number]]
    ]


def _blaming(effects: Effects, of: Sequence[int]) -> Product:
    """The paths that violate at most one rule; ``of`` says whose the instances are."""

    def enter(row: Sequence[Effect], memory: Blaming) -> Blaming | None:
        joint, blamed = memory
        after = tuple([effect[state] for effect, state in zip(row, joint, strict=True)])
        if LOST not in after:
            return after, blamed
        lost = {rule for state, rule in zip(after, of, strict=True) if state == LOST}
        if len(lost | ({blamed} - {NOBODY})) > 1:
            return None
        (blamed,) = lost
        # Whatever else becomes of this rule, it has been violated.
        states = zip(after, of, strict=True)
        return tuple([SAFE if rule == blamed else state for state, rule in states]), blamed

    return explore(effects, enter, (effects.waiting, NOBODY))


def _violating(product: Product, rule: int) -> Product | None:
    ends = frozenset([end for end in product.ends if end[1][1] == rule])
    return replace(product, ends=ends) if ends else None
