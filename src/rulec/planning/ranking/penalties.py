"""Penalties of violated rules, by levels of priority.

The order of A. Censi et al., "Liability, Ethics, and Culture-Aware Behavior Specification using
Rulebooks" (ICRA 2019), over the levels of a rulebook, with every hard rule above every soft one.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from operator import add

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.monitoring.verdict import OpenVerdict, Violation
from rulec.rulebook.rulebook_model import Strength

Penalty = tuple[int, ...]
"""For each rank the sum of the weights of what is violated, in units of ``PenaltyOrder``."""


@dataclass(frozen=True, slots=True)
class PenaltyRank:
    """Levels of equal priority for rules of one strength; "" for rules without one.

    No levels: the rank of doubt about hard rules, see ``with_doubt``.
    """

    strength: Strength
    levels: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class PenaltyOrder:
    """Ranks of a rulebook's rules, each after all above it.

    ``above[i]`` are the indices of the ranks above ``ranks[i]``. Weights are counted in ``unit``,
    of which each is a whole multiple.
    """

    ranks: tuple[PenaltyRank, ...]
    above: tuple[frozenset[int], ...]
    unit: Fraction

    @property
    def doubt(self) -> int | None:
        """The index of the rank of doubt, which has a penalty of at most 1; None without one."""
        return next((index for index, rank in enumerate(self.ranks) if not rank.levels), None)

    def total(self, paid: Penalty, due: Penalty) -> Penalty:
        """The sum of two penalties; nothing is due if there is an empty one."""
        if not due:
            return paid
        total, doubt = tuple(map(add, paid, due)), self.doubt
        if doubt is None or total[doubt] <= 1:
            return total
        return (*total[:doubt], 1, *total[doubt + 1 :])

    def of(self, rule: CompiledRule) -> int:
        """The index of a rule's rank."""
        return next(
            index
            for index, rank in enumerate(self.ranks)
            if rank.strength == rule.strength and rule.level in rank.levels
        )

    def weight(self, rule: CompiledRule) -> int:
        """The penalty that each violated binding of the rule adds."""
        return int(rule.weight / self.unit)

    def at_most(self, left: Penalty, right: Penalty) -> bool:
        """Whether the left penalty is at most the right one.

        It is if for every rank in which it is higher there is a rank above in which it is lower.
        Adding the same to both changes nothing, adding to the left makes it no lower.
        """
        return all(
            any(left[higher] < right[higher] for higher in self.above[index])
            for index in range(len(left))
            if left[index] > right[index]
        )

    def by_rank(self, penalty: Penalty) -> dict[PenaltyRank, Fraction]:
        """The penalty as sums of weights; ranks with sum 0 are left out, and that of doubt."""
        parts = zip(self.ranks, penalty, strict=True)
        return {rank: part * self.unit for rank, part in parts if part and rank.levels}

    def of_violations(
        self, violations: Iterable[Violation | OpenVerdict], rules: CompiledRulebook
    ) -> Penalty:
        """The penalty of the violations of one maneuver; open rules count as violated."""
        by_name = {rule.name: rule for rule in rules.rules}
        due = [0] * len(self.ranks)
        for rule in (by_name[violation.rule] for violation in violations):
            due[self.of(rule)] += self.weight(rule)
        return tuple(due)


def ranks_of(rulebook: CompiledRulebook) -> PenaltyOrder:
    """The ranks of a rulebook's rules.

    If penalties are compared as tuples, from left to right, lower ones by priority come first: a
    rank stands after all above it, and otherwise in the rulebook's order of levels.
    """
    order = rulebook.priorities

    def is_above(higher: str, lower: str) -> bool:
        return (higher, lower) in order and (lower, higher) not in order

    ranks: list[PenaltyRank] = []
    for strength in ("hard", "soft"):
        used = {rule.level for rule in rulebook.rules if rule.strength == strength}
        waiting = [level for level in (*rulebook.levels, "") if level in used]
        while waiting:
            top = next(
                level for level in waiting if not any(is_above(other, level) for other in waiting)
            )
            equal = [
                level for level in waiting if level == top or {(level, top), (top, level)} <= order
            ]
            ranks.append(PenaltyRank(strength, tuple(equal)))
            waiting = [level for level in waiting if level not in equal]
    above = tuple(
        frozenset(
            index
            for index, upper in enumerate(ranks)
            if (
                is_above(upper.levels[0], rank.levels[0])
                if upper.strength == rank.strength
                else upper.strength == "hard"
            )
        )
        for rank in ranks
    )
    weights = [rule.weight.denominator for rule in rulebook.rules]
    return PenaltyOrder(tuple(ranks), above, Fraction(1, lcm(*weights)))


def with_doubt(order: PenaltyOrder) -> PenaltyOrder:
    """The order with one more rank, below all of hard rules and above all of soft ones.

    Its penalty is 1 if some hard rule is not sure to be kept. So what satisfies them all comes
    before what may violate one, and how many are in doubt does not count.
    """
    place = sum(rank.strength == "hard" for rank in order.ranks)
    hard = frozenset(range(place))
    above = tuple(
        frozenset([index + (index >= place) for index in own]) | ({place} if n >= place else set())
        for n, own in enumerate(order.above)
    )
    return PenaltyOrder(
        (*order.ranks[:place], PenaltyRank("hard", ()), *order.ranks[place:]),
        (*above[:place], hard, *above[place:]),
        order.unit,
    )
