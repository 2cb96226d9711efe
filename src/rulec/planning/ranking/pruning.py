"""Numbers of paths that each rule rejects, also alone."""

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
"""In place of a rule: none has been violated."""

Blaming = tuple[Joint, int]
"""The machines' states, and the one rule that has been violated so far, or NOBODY."""


@dataclass(frozen=True, slots=True)
class RulePruning:
    """Numbers of maneuvers that violate a rule, and that rule alone.

    ``alone`` violated is a rule if no other hard one is known to be; None for a soft rule, which
    rejects nothing. On ``open`` more maneuvers it is not known whether the rule is kept. The
    example is one of the cheapest that violate the rule alone, if there are any, else of those that
    violate it; None if there are none of these either. The violations are those of the rule by the
    example.
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
    """The numbers of maneuvers that keep a rule, that violate it, and of which neither is known."""

    rule: CompiledRule
    kept: int
    violated: int
    open: int

    @property
    def judged(self) -> bool:
        """Whether it is kept or violated for sure by half of the maneuvers or more."""
        return self.kept + self.violated >= self.open and self.kept + self.violated > 0


def outcomes_of(
    rule: CompiledRule, surely: NodeTransformers, perhaps: NodeTransformers, paths: int
) -> RuleOutcomes:
    """The outcomes of a rule on all paths, of which there are so many."""

    def accepted(transformers: NodeTransformers) -> int:
        names = [instance.rule.name for instance in transformers.instances]
        own = [number for number, name in enumerate(names) if name == rule.name]
        return explore(transformers.of(own)).accepted if own else paths

    kept, not_violated = accepted(surely), accepted(perhaps)
    return RuleOutcomes(rule, kept, paths - not_violated, not_violated - kept)


def violating(transformers: NodeTransformers) -> dict[str, Product[Blaming]]:
    """Product of the paths that violate it, for each rule that some path violates."""
    rules = [instance.rule.name for instance in transformers.instances]
    products = {}
    for rule in dict.fromkeys(rules):
        indices = [i for i, name in enumerate(rules) if name == rule]
        products[rule] = _blaming(transformers.of(indices), [0] * len(indices))
    blamed = {rule: _blamed(product, 0) for rule, product in products.items()}
    return {rule: product for rule, product in blamed.items() if product.ends}


def violating_alone(transformers: NodeTransformers) -> dict[str, Product[Blaming]]:
    """Product of the paths that violate it alone, for each rule that some do."""
    rules = [instance.rule.name for instance in transformers.instances]
    numbers = {rule: number for number, rule in enumerate(dict.fromkeys(rules))}
    product = _blaming(transformers, [numbers[rule] for rule in rules])
    blamed = {rule: _blamed(product, number) for rule, number in numbers.items()}
    return {rule: product for rule, product in blamed.items() if product.ends}


def _blaming(transformers: NodeTransformers, of: Sequence[int]) -> Product[Blaming]:
    """Product of paths that violate at most one rule, which ``of`` gives by instance."""

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
