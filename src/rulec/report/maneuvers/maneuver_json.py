"""Maneuvers, their violations and probabilities as JSON."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from fractions import Fraction
from functools import partial
from math import floor
from typing import Any, TypeVar

from msgspec import UNSET, UnsetType

from rulec.monitoring.verdict import Verdict, Violation
from rulec.partition import NavigationGraph, envelope
from rulec.planning import Maneuvers, RankedManeuver, RulePruning
from rulec.planning.probability.rule_probability import AlternativeCounts
from rulec.planning.ranking.cheapest import Maneuver
from rulec.planning.ranking.homotopy import HomotopyClasses, Variant
from rulec.planning.ranking.penalties import PenaltyRank
from rulec.report.json_document import JsonPart, as_line, filled
from rulec.report.maneuvers import maneuver_report
from rulec.report.maneuvers.maneuver_document import (
    BindingProbability,
    CellData,
    ChancesData,
    ClassesData,
    DeadEndData,
    DerivedSignal,
    EnvelopeData,
    LevelPenalty,
    ManeuverData,
    ManeuversDocument,
    ManeuverViolation,
    PastViolation,
    PruningData,
    RuleProbabilityData,
    SceneData,
    TrajectoryData,
    TrajectoryVerdictData,
    WorldData,
)
from rulec.report.maneuvers.maneuver_report import ManeuverAnswers
from rulec.report.verdicts.verdict_json import (
    OpenData,
    not_judged_data,
    open_data,
)
from rulec.scenario import Account
from rulec.scoring.maneuver_trajectories import TrajectoryScores

Item = TypeVar("Item")
Data = TypeVar("Data", bound=JsonPart)


def as_json(maneuvers: Maneuvers, answers: ManeuverAnswers, seconds: float) -> str:
    """Write the counts and the further answers."""
    graph, scenario = maneuvers.graph, maneuvers.graph.scenario
    several = any(obstacle.alternatives for obstacle in scenario.obstacles)
    several = several or answers.worlds is not None
    hard = maneuver_report.hard_braking(maneuvers, answers)
    # Rounded up, it would be more than what is proved
    least = UNSET if hard is None else floor(1000 * hard.least) / 1000
    return as_line(
        filled(
            ManeuversDocument,
            graph,
            scenario=scenario.name,
            rulebook=maneuvers.rules.name,
            horizon_s=maneuver_report.horizon_s(graph),
            bounds=None if graph.bounds is None else asdict(graph.bounds),
            traces=maneuvers.traces,
            satisfying=maneuvers.satisfying,
            violating=maneuvers.violating,
            open=maneuvers.open,
            exact=maneuvers.exact,
            judged=answers.judged,
            unknown=maneuvers.unknown,
            not_judged=not_judged_data(maneuvers.not_judged, maneuvers.rules),
            by_default=maneuvers.by_default,
            dead_end=_dead_end(maneuvers),
            seconds=round(seconds, 6),
            scene=UNSET if scenario.account is None else _scene(maneuvers, scenario.account),
            violated_before=_each(maneuvers.violated_before, partial(filled, PastViolation)),
            least_violating=_each(answers.best, partial(_ranked, maneuvers, answers)),
            ranked=_each(answers.ranked, partial(_ranked, maneuvers, answers)),
            maneuvers=_each(
                answers.listed,
                lambda maneuver: _maneuver(
                    graph,
                    maneuver,
                    trajectory=_trajectory(maneuver, maneuvers, answers.driven),
                    open=_open(answers.verdicts.get(maneuver.nodes), maneuvers),
                    chances=_chances(answers, maneuver),
                ),
            ),
            likeliest=maneuver_report.likeliest(scenario) if several else UNSET,
            worlds=_each(answers.worlds, _world),
            rules=_each(answers.prunings, partial(_pruning, maneuvers)),
            classes=UNSET if answers.classes is None else _classes(maneuvers, *answers.classes),
            least_braking=UNSET if hard is None or hard.later else least,
            least_braking_later=least if hard is not None and hard.later else UNSET,
            in_way=maneuvers.in_way if maneuver_report.lists_none(maneuvers, answers) else UNSET,
        )
    )


def _dead_end(maneuvers: Maneuvers) -> DeadEndData | None:
    """The dead end if there is no maneuver, else None."""
    end = maneuvers.dead_end
    if end is None:
        return None
    last_s = maneuvers.graph.layers[end.layer].start_s
    return DeadEndData(last_s=last_s, closed_by=end.closed_by, opened_by=end.opened_by)


def _each(items: Iterable[Item] | None, data: Callable[[Item], Data]) -> list[Data] | UnsetType:
    return UNSET if items is None else [data(item) for item in items]


def _world(world: AlternativeCounts) -> WorldData:
    return filled(WorldData, world, prediction=world.number + 1, weight=float(world.weight))


def _scene(maneuvers: Maneuvers, account: Account) -> SceneData:
    derived = maneuver_report.derived_signals(maneuvers, account)
    return filled(
        SceneData,
        account,
        obstacles=account.recorded,
        recorded_until_s=account.until_s,
        derived={
            name: DerivedSignal(value=value, because=why) for name, (value, why) in derived.items()
        },
    )


def _ranked(maneuvers: Maneuvers, answers: ManeuverAnswers, ranked: RankedManeuver) -> ManeuverData:
    in_doubt = maneuvers.in_doubt or bool(ranked.open)
    return _maneuver(
        maneuvers.graph,
        ranked.maneuver,
        trajectory=_trajectory(ranked.maneuver, maneuvers, answers.driven),
        place=ranked.place,
        penalty=_penalty(ranked.penalty),
        at_least=_penalty(ranked.at_least) if in_doubt else UNSET,
        members=ranked.members,
        violations=_violations(maneuvers, ranked.violations),
        open=open_data(ranked.open, maneuvers.rules) if in_doubt else UNSET,
        chances=_chances(answers, ranked.maneuver),
    )


def _penalty(penalty: Mapping[PenaltyRank, Fraction]) -> list[LevelPenalty]:
    return [
        filled(LevelPenalty, rank, levels=[level or None for level in rank.levels], weight=weight)
        for rank, weight in penalty.items()
    ]


def _open(verdict: Verdict | None, maneuvers: Maneuvers) -> list[OpenData] | UnsetType:
    return UNSET if verdict is None else open_data(verdict.open, maneuvers.rules)


def _maneuver(graph: NavigationGraph, maneuver: Maneuver, **details: Any) -> ManeuverData:
    cells = [
        filled(CellData, layer.cells[index], cell=index, start_s=layer.start_s)
        for layer, index in zip(graph.layers, maneuver.nodes, strict=True)
    ]
    bounds = [filled(EnvelopeData, bounds) for bounds in envelope(graph, maneuver.nodes)]
    details.setdefault("trajectory", _trajectory(maneuver))
    return filled(ManeuverData, maneuver, cells=cells, envelope=bounds, **details)


def _trajectory(
    maneuver: Maneuver,
    maneuvers: Maneuvers | None = None,
    scores: TrajectoryScores | None = None,
) -> TrajectoryData | UnsetType:
    """The trajectory of a maneuver, if it has one, with the parts of its cost, and its verdict."""
    driven = maneuver.trajectory
    if driven is None:
        return UNSET
    costs = {"changes": maneuver.changes or 0.0, **asdict(driven.cost)}
    verdict: TrajectoryVerdictData | UnsetType = UNSET
    if maneuvers is not None and scores is not None and maneuver.nodes in scores.of:
        score = scores.of[maneuver.nodes]
        verdict = filled(
            TrajectoryVerdictData,
            score,
            satisfied=score.satisfied_as_judged,
            until_s=scores.until_s,
            violations=_violations(maneuvers, score.violations, scores.time_s),
            open=open_data(score.open, maneuvers.rules),
        )
    return filled(TrajectoryData, driven, costs=costs, verdict=verdict)


def _violations(
    maneuvers: Maneuvers,
    violations: Iterable[Violation],
    time_s: Callable[[int], float] | None = None,
) -> list[ManeuverViolation]:
    """Violations with their times: those of layers, unless ``time_s`` gives those of states."""
    rules = {rule.name: rule for rule in maneuvers.rules.rules}
    time_of = time_s or (lambda layer: maneuvers.graph.layers[layer].start_s)
    return [
        filled(
            ManeuverViolation,
            violation,
            cite=rules[violation.rule].cite,
            inherited_from=rules[violation.rule].inherited_from or UNSET,
            lost_s=None if violation.step is None else time_of(violation.step),
            level=rules[violation.rule].level or None,
            weight=rules[violation.rule].weight,
        )
        for violation in violations
    ]


def _chances(answers: ManeuverAnswers, maneuver: Maneuver) -> ChancesData | UnsetType:
    chances = answers.chances.get(maneuver.nodes)
    if chances is None:
        return UNSET
    rules = [
        RuleProbabilityData(
            rule=rule.rule.name,
            strength=rule.rule.strength,
            kept=_float(rule.kept),
            bindings=[
                BindingProbability(
                    binding=binding.binding,
                    kept=float(binding.kept),
                    kept_at_most=_above(binding.kept, binding.at_most),
                )
                for binding in rule.bindings
            ],
            kept_at_most=_above(rule.kept, rule.at_most),
        )
        for rule in chances.rules
    ]
    hard = _float(chances.hard)
    return ChancesData(
        clear=float(chances.clear),
        every_hard_rule=hard,
        rules=rules,
        every_hard_rule_at_most=_above(chances.hard, chances.hard_at_most),
    )


def _pruning(maneuvers: Maneuvers, pruning: RulePruning) -> PruningData:
    rule, example = pruning.rule, pruning.example
    violations = _violations(maneuvers, pruning.violations)
    return filled(
        PruningData,
        pruning,
        rule=rule.name,
        strength=rule.strength,
        example=example and _maneuver(maneuvers.graph, example, violations=violations),
    )


def _classes(
    maneuvers: Maneuvers, classes: HomotopyClasses, variants: Sequence[Variant]
) -> ClassesData:
    return filled(
        ClassesData,
        classes,
        counting_steps=[rule.name for rule in maneuvers.counting_steps()],
        representatives=[
            _maneuver(maneuvers.graph, variant.cheapest, members=variant.members)
            for variant in variants
        ],
    )


def _above(least: Fraction | None, greatest: Fraction | None) -> float | UnsetType:
    """The upper bound, unset if equal to the lower one."""
    return UNSET if greatest is None or greatest == least else float(greatest)


def _float(probability: Fraction | None) -> float | None:
    return None if probability is None else float(probability)
