"""Numbers of paths that each rule rejects, also alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from operator import getitem

from rulec.planning.product.graph_product import Joint, Product, explore
from rulec.planning.product.node_transformers import LOST, SAFE, Effect, NodeTransformers

NOBODY = -1
"""In place of a rule: none has been violated."""

Blaming = tuple[Joint, int]
"""The machines' states, and the one rule that has been violated so far, or NOBODY."""


def violating(effects: NodeTransformers) -> dict[str, Product]:
    """Product of the paths that violate it, for each rule."""
    rules = _rules(effects)
    result = {}
    for number, rule in enumerate(dict.fromkeys(rules)):
        indices = [i for i, name in enumerate(rules) if name == rule]
        product = _blaming(effects.of(indices), [number] * len(indices))
        result[rule] = _blamed(product, number)
    return {rule: product for rule, product in result.items() if product.ends}


def violating_alone(effects: NodeTransformers) -> dict[str, Product]:
    """Product of the paths that violate it alone, for each rule."""
    rules = _rules(effects)
    numbers = {rule: number for number, rule in enumerate(dict.fromkeys(rules))}
    product = _blaming(effects, [numbers[rule] for rule in rules])
    result = {rule: _blamed(product, number) for rule, number in numbers.items()}
    return {rule: product for rule, product in result.items() if product.ends}


def _rules(effects: NodeTransformers) -> list[str]:
    return [instance.rule.name for instance in effects.instances]


def _blaming(effects: NodeTransformers, of: Sequence[int]) -> Product:
    """Product of paths that violate at most one rule.

    ``of`` gives the rule of each instance.
    """

    def enter(row: Sequence[Effect], memory: Blaming) -> Blaming | None:
        joint, blamed = memory
        after = tuple(map(getitem, row, joint))
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


def _blamed(product: Product, rule: int) -> Product:
    return replace(product, ends=frozenset([end for end in product.ends if end[1][1] == rule]))
