"""The least violating paths, found without enumerating all paths.

A path is lost to an instance at most once: then its penalty is added and its machine drops out. So
partial paths carry their penalty with the machines' states. They are extended lowest penalty first,
so that those that violate much are not examined while there are better ones.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from heapq import heappop, heappush
from itertools import count
from operator import getitem, gt

from rulec.monitoring.verdict import OpenVerdict, Violation
from rulec.planning.product import graph_product
from rulec.planning.product.node_transformers import LOST, SAFE, Effect, NodeTransformers
from rulec.planning.ranking.cheapest import Maneuver
from rulec.planning.ranking.penalties import Penalty, PenaltyOrder, PenaltyRank
from rulec.trace.interned import Interned
from rulec.value_display import short_repr

Paying = tuple[graph_product.Joint, Penalty]
"""The machines' states, and the penalty so far."""

Place = tuple[int, int, graph_product.Joint]
"""A layer, a node in it, and the machines' states after it."""


@dataclass(frozen=True, slots=True)
class RankedManeuver:
    """A maneuver ranked by what it violates: see ``docs/ranking.md``.

    ``place`` is 1 if no maneuver violates less, else 1 more than the last place of those that do.
    ``penalty`` is the sum of the weights of what it violates, by rank, without ranks of sum 0.
    ``members`` is the number of maneuvers of this rank; this is one of the cheapest. If not
    everything is known, ``penalty`` includes ``open`` rules; ``at_least``, without them, decides.
    """

    __repr__ = short_repr

    place: int
    penalty: Mapping[PenaltyRank, Fraction]
    members: int
    maneuver: Maneuver
    violations: tuple[Violation, ...]
    open: tuple[OpenVerdict, ...] = ()
    at_least: Mapping[PenaltyRank, Fraction] = field(default_factory=dict)


@dataclass(frozen=True, slots=True)
class Ranking:
    """What decides the ranks of paths: instances of rules, and the order of penalties.

    The last ``doubts`` instances are those of hard rules which, lost, are in doubt.
    """

    transformers: NodeTransformers
    order: PenaltyOrder
    doubts: int = 0

    def front(self) -> Iterator[Penalty]:
        """The Pareto front of the paths' penalties, in order, lazily."""
        penalties: list[Penalty] = []
        passed: dict[Place, list[Penalty]] = {}

        def worth(place: Place, penalty: Penalty) -> bool:
            """Whether no other path here has a lower penalty."""
            others = passed.setdefault(place, [])
            if any(self.order.at_most(numbers, penalty) for numbers in (*penalties, *others)):
                return False
            others.append(penalty)
            return True

        for penalty in self._ascending(worth):
            penalties.append(penalty)
            yield penalty

    def ranked(self) -> Iterator[tuple[int, Penalty]]:
        """Every penalty of some path, each after all that are lower.

        With each comes its place: 1 in the front, else 1 more than the last place of lower
        penalties.
        """
        passed: set[tuple[Place, Penalty]] = set()

        def worth(place: Place, penalty: Penalty) -> bool:
            new = (place, penalty) not in passed
            passed.add((place, penalty))
            return new

        places: dict[Penalty, int] = {}
        for penalty in self._ascending(worth):
            if penalty not in places:
                at_most = self.order.at_most
                lower = [place for other, place in places.items() if at_most(other, penalty)]
                places[penalty] = 1 + max(lower, default=0)
                yield places[penalty], penalty

    def with_penalty(self, penalty: Penalty) -> graph_product.Product[Paying]:
        """The product in which only the paths with one penalty are accepted."""
        fee, order = self._fees(), self.order

        def enter(row: Sequence[Effect], memory: Paying) -> Paying | None:
            joint, paid = memory
            after, due = fee(row, joint)
            total = order.total(paid, due)
            return None if any(map(gt, total, penalty)) else (after, total)

        product = graph_product.explore_with(
            self.transformers, enter, (self.transformers.waiting, (0,) * len(order.ranks))
        )
        ends = frozenset([end for end in product.ends if end[1][1] == penalty])
        return replace(product, ends=ends)

    def _ascending(self, worth: Callable[[Place, Penalty], bool]) -> Iterator[Penalty]:
        """Penalties of paths in order; only those that are ``worth`` it are extended.

        Among partial paths with one penalty the longer ones come first, so goals are found soon.
        Raises R0616 if too many are worth it.
        """
        transformers, order = self.transformers, self.order
        remaining = graph_product.largest_product(transformers.graph)
        fee = self._fees()
        of_layer: dict[object, dict[tuple[int, graph_product.Joint], Paying]] = {}
        fees = [of_layer.setdefault(Interned(rows), {}) for rows in transformers.nodes]
        queue: list[tuple[Penalty, int, int, int, graph_product.Joint]] = []
        numbers = count()

        def reach(layer: int, node: int, joint: graph_product.Joint, paid: Penalty) -> None:
            if (node, joint) not in fees[layer]:
                fees[layer][node, joint] = fee(transformers.nodes[layer][node], joint)
            after, due = fees[layer][node, joint]
            total = order.total(paid, due)
            heappush(queue, (total, -layer, next(numbers), node, after))

        if transformers.starts:
            reach(0, transformers.graph.start, transformers.waiting, (0,) * len(order.ranks))
        while queue:
            penalty, earlier, _, node, joint = heappop(queue)
            if not worth((-earlier, node, joint), penalty):
                continue
            remaining -= 1
            if remaining < 0:
                raise graph_product.too_large(transformers.graph)
            if -earlier == len(transformers.steps):
                yield penalty
                continue
            for target, _ in transformers.steps[-earlier][node]:
                reach(1 - earlier, target, joint, penalty)

    def _fees(self) -> Callable[[Sequence[Effect], graph_product.Joint], Paying]:
        """Gives the next states of the monitors at a node, and the penalty added."""
        order, doubts, instances = self.order, self.doubts, self.transformers.instances
        surely = len(instances) - doubts
        prices = [
            (order.of(instance.rule), order.weight(instance.rule) * len(instance.bindings))
            for instance in instances[:surely]
        ]
        in_doubt = order.doubt

        def fee(row: Sequence[Effect], joint: graph_product.Joint) -> Paying:
            after = tuple(map(getitem, row, joint))
            if LOST not in after:
                return after, ()
            due = [0] * len(order.ranks)
            for state, (rank, price) in zip(after[:surely], prices, strict=True):
                if state == LOST:
                    due[rank] += price
            if in_doubt is not None and LOST in after[surely:]:
                due[in_doubt] = 1
                # Nothing more comes of what else is in doubt
                after = (*after[:surely], *(SAFE,) * doubts)
            return tuple([SAFE if state == LOST else state for state in after]), tuple(due)

        return fee
