"""The number of paths that each rule rejects, and that it alone rejects."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from operator import getitem

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.monitoring.verdict import Violation
from rulec.planning.product.graph_product import Joint, Product, explore, explore_with
from rulec.planning.product.node_transformers import LOST, SAFE, Effect, NodeTransformers
from rulec.planning.ranking.cheapest import Maneuver
from rulec.value_display import short_repr

NOBODY = -1
"""Instead of a rule: none has been violated."""

Blaming = tuple[Joint, int]
"""The machines' states, and the one rule that has been violated so far, or NOBODY."""


@dataclass(frozen=True, slots=True)
class RulePruning:
    """Numbers of maneuvers that violate a rule, and that violate only that rule.

    ``alone`` counts maneuvers that are not known to violate another hard rule; None for a soft
    rule, which rejects nothing. ``open`` counts further maneuvers that may violate the rule. The
    example is one of the cheapest that violate the rule alone, if there are any, else of those that
    violate it, else None. The violations are those of the rule by the example.
    """

    __repr__ = short_repr

    rule: CompiledRule
    violating: int
    alone: int | None
    example: Maneuver | None
    violations: tuple[Violation, ...]
    open: int = 0


@dataclass(frozen=True, slots=True)
class RuleOutcomes:
    """The numbers of maneuvers that surely keep a rule, surely violate it, and do neither."""

    rule: CompiledRule
    kept: int
    violated: int
    open: int

    @property
    def judged(self) -> bool:
        """Whether at least half of the maneuvers surely keep or surely violate it."""
        return self.kept + self.violated >= self.open and self.kept + self.violated > 0


def outcomes_of(
    rule: CompiledRule, surely: NodeTransformers, perhaps: NodeTransformers, paths: int
) -> RuleOutcomes:
    """The outcomes of a rule on all ``paths``, given as a number."""

    def accepted(transformers: NodeTransformers) -> int:
        names = [instance.rule.name for instance in transformers.instances]
        own = [number for number, name in enumerate(names) if name == rule.name]
        return explore(transformers.of(own)).accepted if own else paths

    kept, not_violated = accepted(surely), accepted(perhaps)
    return RuleOutcomes(rule, kept, paths - not_violated, not_violated - kept)


def violating(transformers: NodeTransformers) -> dict[str, Product[Blaming]]:
    """For each rule that some path violates, the product of the paths that violate it."""
    rules = [instance.rule.name for instance in transformers.instances]
    products = {}
    for rule in dict.fromkeys(rules):
        indices = [i for i, name in enumerate(rules) if name == rule]
        products[rule] = _blaming(transformers.of(indices), [0] * len(indices))
    blamed = {rule: _blamed(product, 0) for rule, product in products.items()}
    return {rule: product for rule, product in blamed.items() if product.ends}


def violating_alone(transformers: NodeTransformers) -> dict[str, Product[Blaming]]:
    """For each rule that some path violates alone, the product of these paths."""
    rules = [instance.rule.name for instance in transformers.instances]
    numbers = {rule: number for number, rule in enumerate(dict.fromkeys(rules))}
    product = _blaming(transformers, [numbers[rule] for rule in rules])
    blamed = {rule: _blamed(product, number) for rule, number in numbers.items()}
    return {rule: product for rule, product in blamed.items() if product.ends}


def _blaming(transformers: NodeTransformers, of: Sequence[int]) -> Product[Blaming]:
    """Product of the paths that violate at most one rule; ``of`` maps instances to rules."""

    def enter(row: Sequence[Effect], memory: Blaming) -> Blaming | None:
        joint, blamed = memory
        after = tuple(map(getitem, row, joint))
        if LOST not in after:
            return after, blamed
        lost = {rule for state, rule in zip(after, of, strict=True) if state == LOST}
        if len(lost | ({blamed} - {NOBODY})) > 1:
            return None
        (blamed,) = lost
        # This rule has been violated, whatever its other instances do.
        states = zip(after, of, strict=True)
        return tuple([SAFE if rule == blamed else state for state, rule in states]), blamed

    return explore_with(transformers, enter, (transformers.waiting, NOBODY))


def _blamed(product: Product[Blaming], rule: int) -> Product[Blaming]:
    return replace(product, ends=frozenset([end for end in product.ends if end[1][1] == rule]))
