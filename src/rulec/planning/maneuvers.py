"""Maneuvers of a graph under a rulebook: counts, ranks, classes."""

from __future__ import annotations

import sys
from collections.abc import Collection, Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, islice
from typing import TYPE_CHECKING, Any, TypeVar

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.mealy_monitor import stutter_invariant
from rulec.diagnostics.argument_kinds import checked_kinds
from rulec.logic.free_names import names_in
from rulec.monitoring.state_validation import partial_names
from rulec.monitoring.told_names import untold_names
from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun
from rulec.monitoring.verdict import CarriedState, RuleNotJudged, Verdict, Violation
from rulec.partition import NavigationGraph, dead_ends, emergencies
from rulec.planning.product.graph_product import (
    Joint,
    Memory,
    Product,
    explore,
)
from rulec.planning.product.node_transformers import NodeTransformers, node_transformers
from rulec.planning.product.possible_instances import HARD, SOFT, violations
from rulec.planning.ranking.cell_tracks import CellTracks, cell_tracks
from rulec.planning.ranking.cheapest import Maneuver, cheapest
from rulec.planning.ranking.homotopy import HomotopyClasses, Variant, count_classes, variants
from rulec.planning.ranking.least_violating import RankedManeuver, Ranking
from rulec.planning.ranking.penalties import Penalty, PenaltyOrder, ranks_of, with_doubt
from rulec.planning.ranking.proven import MOST_TRIED, least_promised, proven, with_trajectory
from rulec.planning.ranking.pruning import (
    Blaming,
    RuleOutcomes,
    RulePruning,
    outcomes_of,
    violating,
    violating_alone,
)
from rulec.planning.rule_instances import SceneReading, bind_rules, past_for
from rulec.trace import TraceGraph
from rulec.trace.trace_model import trace_of
from rulec.value_display import Rows, short_count

if TYPE_CHECKING:
    from rulec.cell_words import CellWords
    from rulec.partition.motion.witness_trajectory import WitnessSearch
    from rulec.planning.trace_history import Before

Item = TypeVar("Item")

AS_WRITTEN = SceneReading()

MOST_BEST = 100
"""A limit, since levels that are not comparable can leave any number of equally good maneuvers."""


@dataclass(frozen=True)
class Maneuvers(Rows):
    """Maneuvers of a scenario, evaluated by a rulebook.

    ``rules`` are the rules that judged them, compiled for the graph's step. ``paths`` is the graph
    in terms of their vocabulary. ``hard`` and ``product`` are about paths that surely keep the
    rules, ``perhaps`` and ``possible`` about paths that do not surely violate them; if everything
    is known they are the same. ``after`` is the trace or monitor before, if any, and ``past`` the
    state in which it left the hard rules. ``violated_before`` are the hard rules that it violated
    for good; these violations do not count against a maneuver. ``not_judged`` are rules that no
    maneuver can be known to violate. ``reading`` gives values that the scenario does not provide,
    ``words`` the values in the cells of a recorded scene.
    """

    graph: NavigationGraph
    rules: CompiledRulebook
    paths: TraceGraph
    traces: int
    hard: NodeTransformers
    product: Product[Joint]
    perhaps: NodeTransformers
    possible: Product[Joint]
    past: CarriedState
    after: Before | None = None
    violated_before: tuple[Violation, ...] | None = None
    not_judged: tuple[RuleNotJudged, ...] = ()
    reading: SceneReading = AS_WRITTEN
    words: CellWords | None = None

    def __repr__(self) -> str:
        if not self.judges:
            return f"Maneuvers({self.rules.name}: no hard rule can be judged)"
        counts = f"{short_count(self.satisfying)} of {short_count(self.traces)}"
        return f"Maneuvers({self.rules.name}: {counts} keep every hard rule)"

    @property
    def satisfying(self) -> int:
        """Number of maneuvers that keep every hard rule, whatever the unknown values are."""
        return self.product.accepted

    @property
    def open(self) -> int:
        """Number of further maneuvers that are not known to violate a hard rule."""
        return self.possible.accepted - self.product.accepted

    @property
    def violating(self) -> int:
        """Number of maneuvers that violate some hard rule, whatever the unknown values are."""
        return self.traces - self.possible.accepted

    def rule_outcomes(self) -> list[RuleOutcomes]:
        """For each rule that can be judged, how many maneuvers keep it and how many violate it.

        Raises RulecError as ``best`` does.
        """
        dark = {rule.rule for rule in self.not_judged}
        return [
            outcomes_of(rule, self._every, self._every_perhaps, self.traces)
            for rule in self.rules.rules
            if rule.name not in dark
        ]

    @property
    def judges(self) -> bool:
        """Whether some hard rule can be judged, or there are no hard rules."""
        hard = {rule.name for rule in self.rules.rules if rule.strength == "hard"}
        return not hard or not hard <= {rule.rule for rule in self.not_judged}

    @property
    def exact(self) -> bool:
        """Whether ``open`` is exact, not too high because more was assumed possible than is."""
        readings = [instance.readings for instance in self.hard.instances]
        return all(reading is None or reading.exact for reading in readings)

    @cached_property
    def unknown(self) -> tuple[str, ...]:
        """Names that rules read and whose values are not all known."""
        partial = partial_names(state for layer in self.paths.states for state in layer)
        partial |= untold_names(self.rules.vocabulary, self.paths.told)
        return self._read(partial)

    @property
    def in_doubt(self) -> bool:
        """Whether a value that rules read, or a hard rule's state after the past, is unknown."""
        return bool(self.unknown or self.doubtful_past)

    @property
    def doubtful_past(self) -> tuple[str, ...]:
        """The hard rules whose state after the past is not known."""
        doubtful = self.past.doubtful_rules
        return tuple(rule.name for rule in self.rules.rules if rule.name in doubtful)

    @property
    def by_default(self) -> tuple[str, ...]:
        """Names that rules read and that the scenario leaves at their defaults."""
        supplied = {name for layer in self.paths.states for state in layer for name in state}
        return self._read(self.rules.vocabulary.declarations.keys() - supplied - {*self.unknown})

    def _read(self, names: Collection[str]) -> tuple[str, ...]:
        """Those of these names that rules read, in the vocabulary's order."""
        read = {name for rule in self.rules.rules for name in names_in(rule.formula)}
        read.intersection_update(names)
        return tuple(name for name in self.rules.vocabulary.declarations if name in read)

    @checked_kinds
    def cheapest(self, n: int, *, perhaps: bool = False) -> list[Maneuver]:
        """The ``n`` cheapest satisfying maneuvers, or all if there are fewer.

        With ``perhaps`` open maneuvers are included. If ego's motion has bounds, only maneuvers
        with a trajectory that proves that ego can drive them are returned.
        """
        return self._drivable(self.possible if perhaps else self.product, n)

    def _drivable(self, product: Product[Memory], n: int) -> list[Maneuver]:
        """The ``n`` cheapest of a product; with bounds of ego's motion, those proved drivable."""
        if self.witness_search is None:
            return _first(n, cheapest(product))
        return proven(product, n, self.graph, self.witness_search)

    @cached_property
    def in_way(self) -> tuple[str, ...]:
        """The obstacles that make the maneuver of least cost by its cells undrivable.

        Empty if it is drivable, or if ego's bounds alone prevent it.
        """
        first = next(cheapest(self.possible), None)
        return (
            ()
            if first is None or self.witness_search is None
            else self.witness_search.in_way(first.nodes)
        )

    @cached_property
    def witness_search(self) -> WitnessSearch | None:
        """The search for trajectories; None if ego's motion has no bounds."""
        if self.graph.bounds is None:
            return None
        # Imported late: NumPy and the solver take 50 ms, and are not always needed.
        from rulec.partition.motion.witness_trajectory import WitnessSearch

        return WitnessSearch(self.graph, self.graph.bounds)

    @checked_kinds
    def verdict(self, maneuver: Maneuver) -> Verdict:
        """The violations and open rules of a maneuver. Raises RulecError as ``best`` does."""
        every = self._every.instances
        name = self.graph.scenario.name
        if not any(instance.readings for instance in every):
            return Verdict(name, violations(every, maneuver.nodes), not_judged=self.not_judged)
        trace = trace_of(self.paths, maneuver.nodes, name)
        past = past_for(self.graph, self.paths, self.rules, (*HARD, *SOFT), self.after)
        return UncertainRun(trace, self.rules, past).verdict()

    @checked_kinds
    def best(self, n: int = MOST_BEST) -> list[RankedManeuver]:
        """The least violating maneuvers: for each minimal penalty one of the cheapest.

        There are several if levels are not comparable, but at most ``n``. If there are satisfying
        maneuvers, the result are satisfying ones that violate soft rules least. If not everything
        is known, what is surely violated counts. Raises RulecError as ``evaluate`` does, for soft
        rules too.
        """
        best = _first(n, self._ranking.front())
        return [maneuver for penalty in best for maneuver in self._of_penalty(1, penalty, 1)]

    @checked_kinds
    def ranked(self, n: int) -> list[RankedManeuver]:
        """The ``n`` best maneuvers, least violating first, or all if there are fewer.

        Each comes after all that violate less; those with equal penalties are ordered by cost. If
        not everything is known, what is surely violated counts, and of hard rules whether all are
        sure to be kept. Raises RulecError as ``best`` does.
        """
        penalties = self._ranking.ranked()
        return _first(
            n, chain.from_iterable(self._of_penalty(*penalty, n) for penalty in penalties)
        )

    @cached_property
    def dead_end(self) -> dead_ends.DeadEnd | None:
        """Where the paths end; None if there is a maneuver."""
        if self.traces:
            return None
        return dead_ends.dead_end(self.graph)

    @cached_property
    def least_braking(self) -> float | None:
        """The least braking (m/s²) that every maneuver needs, if that is more than 4; else None."""
        least = emergencies.least_braking(self.graph)
        if least is None or self.witness_search is None:
            return least
        every = explore(node_transformers(self.paths, []))
        return least_promised(every, self.graph, self.witness_search.braking_bounds) or least

    @cached_property
    def least_braking_later(self) -> float | None:
        """The least braking (m/s²) that every maneuver needs, or leaves to be done after its end.

        None if that is at most 4. After its end ego becomes as slow as what is ahead of it then.
        """
        search = self.witness_search
        return (
            None if search is None else emergencies.least_braking_later(self.graph, search.others)
        )

    def without_each_rule(self) -> dict[str, int]:
        """For each hard rule, most first, how many maneuvers violate it and no other hard rule."""
        alone = violating_alone(self.perhaps)
        counts = {name: product.accepted for name, product in alone.items() if product.accepted}
        return dict(sorted(counts.items(), key=lambda item: -item[1]))

    def prunings(self) -> list[RulePruning]:
        """Every rule's effect on the number of maneuvers. Raises RulecError as ``best`` does."""
        every, alone = violating(self._every_perhaps), violating_alone(self.perhaps)
        result = [
            self._pruning(rule, every.get(rule.name), alone.get(rule.name))
            for rule in self.rules.rules
        ]
        if self._every is self._every_perhaps:
            return result
        doubtful = violating(self._every)
        return [
            replace(pruning, open=doubtful[pruning.rule.name].accepted - pruning.violating)
            if pruning.rule.name in doubtful
            else pruning
            for pruning in result
        ]

    def classes(self) -> HomotopyClasses:
        """The exact number of homotopy classes, by their members' verdicts."""
        surely = count_classes(self.hard, self._places)
        if self.perhaps is self.hard:
            return surely
        perhaps = count_classes(self.perhaps, self._places)
        return replace(surely, open=perhaps.satisfying - surely.satisfying)

    @checked_kinds
    def variants(self, n: int) -> list[Variant]:
        """The cheapest satisfying maneuver of each of the ``n`` cheapest classes.

        If ego's motion has bounds, only maneuvers proved drivable are considered.
        """
        every = variants(self.product, self._places)
        search = self.witness_search
        if search is None:
            return _first(n, every)
        driven = (
            replace(variant, cheapest=maneuver)
            for variant in islice(every, MOST_TRIED * n)
            if (maneuver := with_trajectory(variant.cheapest, self.graph, search)) is not None
        )
        return _first(n, driven)

    def counting_steps(self) -> list[CompiledRule]:
        """Hard rules that are not stutter-invariant, which may divide a class."""
        hard = [rule for rule in self.rules.rules if rule.strength == "hard"]
        return [rule for rule in hard if not stutter_invariant(rule.machine)]

    @cached_property
    def _places(self) -> CellTracks:
        return cell_tracks(self.graph.trace_graph())

    @cached_property
    def _ranks(self) -> PenaltyOrder:
        return ranks_of(self.rules)

    @cached_property
    def _every(self) -> NodeTransformers:
        past = past_for(self.graph, self.paths, self.rules, SOFT, self.after)
        soft = bind_rules(self.graph, self.paths, self.rules, SOFT, past)
        return node_transformers(self.paths, [*self.hard.instances, *soft])

    @cached_property
    def _every_perhaps(self) -> NodeTransformers:
        every = self._every.instances
        if not any(instance.readings for instance in every):
            return self._every
        return node_transformers(self.paths, every, perhaps=True)

    @cached_property
    def _ranking(self) -> Ranking:
        """What decides ranks; instances of hard rules are there twice if some are in doubt."""
        sure = self._every_perhaps
        if sure is self._every or not self.satisfying:
            return Ranking(sure, self._ranks)
        doubts = len(self.hard.instances)
        return Ranking(sure.beside(self.hard), with_doubt(self._ranks), doubts)

    def _of_penalty(self, place: int, penalty: Penalty, n: int) -> Iterator[RankedManeuver]:
        """The ``n`` cheapest maneuvers with a penalty."""
        product, ranks = self._ranking.with_penalty(penalty), self._ranks
        for maneuver in self._drivable(product, n):
            verdict = self.verdict(maneuver)
            least = ranks.of_violations(verdict.violations, self.rules)
            most = ranks.of_violations((*verdict.violations, *verdict.open), self.rules)
            yield RankedManeuver(
                place,
                ranks.by_rank(most),
                product.accepted,
                maneuver,
                verdict.violations,
                open=verdict.open,
                at_least=ranks.by_rank(least),
            )

    def _pruning(
        self, rule: CompiledRule, every: Product[Blaming] | None, alone: Product[Blaming] | None
    ) -> RulePruning:
        rejected = alone or every
        example = next(cheapest(rejected)) if rejected else None
        lost = self.verdict(example).violations if example else ()
        return RulePruning(
            rule,
            every.accepted if every else 0,
            None if rule.strength == "soft" else alone.accepted if alone else 0,
            example,
            tuple([violation for violation in lost if violation.rule == rule.name]),
        )

    def rows(self, n: int = 20) -> list[dict[str, Any]]:
        """One row for each of the ``n`` cheapest satisfying maneuvers."""
        return [
            {
                "number": number,
                "cost": maneuver.cost,
                "margin_s": maneuver.margin_s,
                "nodes": list(maneuver.nodes),
            }
            for number, maneuver in enumerate(self.cheapest(n), 1)
        ]


def _first(n: int, items: Iterator[Item]) -> list[Item]:
    if n < 0:
        raise ValueError(f"`n` is how many are wanted, not {n}")
    return list(islice(items, min(n, sys.maxsize)))
