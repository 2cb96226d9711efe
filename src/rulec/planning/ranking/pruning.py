"""Numbers of paths that each rule rejects, also alone."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from operator import getitem

from rulec.planning.product.graph_product import Joint, Product, explore_with
from rulec.planning.product.node_transformers import LOST, SAFE, Effect, NodeTransformers

NOBODY = -1
"""In place of a rule: none has been violated."""

Blaming = tuple[Joint, int]
"""The machines' states, and the one rule that has been violated so far, or NOBODY."""


def violating(transformers: NodeTransformers) -> dict[str, Product[Blaming]]:
    """Product of the paths that violate it, for each rule."""
    rules = _rules(transformers)
    result = {}
    for number, rule in enumerate(dict.fromkeys(rules)):
        indices = [i for i, name in enumerate(rules) if name == rule]
        product = _blaming(transformers.of(indices), [number] * len(indices))
        result[rule] = _blamed(product, number)
    return {rule: product for rule, product in result.items() if product.ends}


def violating_alone(transformers: NodeTransformers) -> dict[str, Product[Blaming]]:
    """Product of the paths that violate it alone, for each rule."""
    rules = _rules(transformers)
    numbers = {rule: number for number, rule in enumerate(dict.fromkeys(rules))}
    product = _blaming(transformers, [numbers[rule] for rule in rules])
    result = {rule: _blamed(product, number) for rule, number in numbers.items()}
    return {rule: product for rule, product in result.items() if product.ends}


def _rules(transformers: NodeTransformers) -> list[str]:
    return [instance.rule.name for instance in transformers.instances]


def _blaming(transformers: NodeTransformers, of: Sequence[int]) -> Product[Blaming]:
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

    return explore_with(transformers, enter, (transformers.waiting, NOBODY))


def _blamed(product: Product[Blaming], rule: int) -> Product[Blaming]:
    return replace(product, ends=frozenset([end for end in product.ends if end[1][1] == rule]))
