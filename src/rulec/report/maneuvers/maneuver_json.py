"""Maneuvers, their violations and probabilities as JSON (see docs/commands.md)."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict
from fractions import Fraction
from functools import partial
from typing import Any, TypeVar

from msgspec import UNSET, UnsetType

from rulec.monitoring.verdict import Verdict, Violation
from rulec.partition import AdjacencyName, ExtentName, NavigationGraph, PartitionName, envelope
from rulec.planning import Maneuvers, RankedManeuver, RulePruning
from rulec.planning.probability.rule_probability import AlternativeCounts
from rulec.planning.ranking.cheapest import Maneuver
from rulec.planning.ranking.homotopy import HomotopyClasses, Variant
from rulec.planning.ranking.penalties import PenaltyRank
from rulec.report.json_document import JsonDocument, JsonPart, Number, as_line, filled
from rulec.report.maneuvers import maneuver_report
from rulec.report.maneuvers.dead_end_json import DeadEndData, dead_end_data
from rulec.report.maneuvers.maneuver_report import ManeuverAnswers
from rulec.report.maneuvers.trajectory_json import TrajectoryData, trajectory_data
from rulec.report.verdicts.verdict_json import (
    NotJudgedRule,
    OpenData,
    not_judged_data,
    open_data,
)
from rulec.rulebook.rulebook_model import Strength
from rulec.scenario import Account
from rulec.scenario.scenario_model import Surface

Item = TypeVar("Item")
Data = TypeVar("Data", bound=JsonPart)


class DerivedSignal(JsonPart, frozen=True, kw_only=True):
    """A signal that the recording supplies, and the reason for its value."""

    value: bool | int | float | str
    because: str


class SceneData(JsonPart, frozen=True, kw_only=True):
    """Account of a recorded scene: counts of obstacles, and derived signals."""

    reference: str
    obstacles: int
    left_out: int
    recorded_until_s: float
    remarks: Sequence[str]
    derived: Mapping[str, DerivedSignal]


class LevelPenalty(JsonPart, frozen=True, kw_only=True):
    """The summed weight of violated rules by levels; null is no level."""

    strength: Strength
    levels: Sequence[str | None]
    weight: Number


class ManeuverViolation(JsonPart, frozen=True, kw_only=True):
    """A violated rule; ``lost_s`` is null if final only at the end.

    ``inherited_from`` names the rulebook whose law it is where this one has not confirmed it.
    """

    rule: str
    cite: str
    binding: Mapping[str, str]
    lost_s: float | None
    strength: Strength
    level: str | None
    weight: Number
    inherited_from: str | UnsetType = UNSET


class CellData(JsonPart, frozen=True, kw_only=True):
    """A cell of the maneuver, with its relation to every obstacle."""

    cell: int
    start_s: float
    surface: Surface
    signature: Mapping[str, str | tuple[str, str]]


class EnvelopeData(JsonPart, frozen=True, kw_only=True):
    """The bounds in a layer, in metres; profiles are pairs (s, d)."""

    s_min: float
    s_max: float
    d_left: Sequence[tuple[float, float]]
    d_right: Sequence[tuple[float, float]]


class BindingProbability(JsonPart, frozen=True, kw_only=True):
    """The probability that a rule is kept for some objects, or its bounds."""

    binding: Mapping[str, str]
    kept: float
    kept_at_most: float | UnsetType = UNSET


class RuleProbabilityData(JsonPart, frozen=True, kw_only=True):
    """The probability that a rule is kept, null if unknown.

    If there is a ``kept_at_most`` both are bounds, since it depends on unknown values.
    """

    rule: str
    strength: Strength
    kept: float | None
    bindings: Sequence[BindingProbability]
    kept_at_most: float | UnsetType = UNSET


class ChancesData(JsonPart, frozen=True, kw_only=True):
    """The probabilities that nobody hits ego, and that rules are kept."""

    clear: float
    every_hard_rule: float | None
    rules: Sequence[RuleProbabilityData]
    every_hard_rule_at_most: float | UnsetType = UNSET


class ManeuverData(JsonPart, frozen=True, kw_only=True):
    """A maneuver: cost (1/s), margin, cells and bounds in time.

    One that is ranked has ``place``, ``penalty``, ``members`` with this penalty and ``violations``;
    a class's has ``members``, an example of a pruning ``violations``. Where not all is known
    ``open`` is what depends on it; it is in the ``penalty``, and not in the one ``at_least``.
    """

    place: int | UnsetType = UNSET
    penalty: Sequence[LevelPenalty] | UnsetType = UNSET
    members: int | UnsetType = UNSET
    at_least: Sequence[LevelPenalty] | UnsetType = UNSET
    violations: Sequence[ManeuverViolation] | UnsetType = UNSET
    open: Sequence[OpenData] | UnsetType = UNSET
    cost: float
    margin_s: float | None
    cells: Sequence[CellData]
    envelope: Sequence[EnvelopeData]
    trajectory: TrajectoryData | UnsetType = UNSET
    chances: ChancesData | UnsetType = UNSET


class PastViolation(JsonPart, frozen=True, kw_only=True):
    """A violation by the past, which no maneuver can mend."""

    rule: str
    binding: Mapping[str, str]
    step: int | None


class WorldData(JsonPart, frozen=True, kw_only=True):
    """Counts for an obstacle's less likely prediction, numbered from 1."""

    obstacle: str
    prediction: int
    weight: float
    traces: int
    satisfying: int
    open: int


class PruningData(JsonPart, frozen=True, kw_only=True):
    """Counts of maneuvers violating a rule, and no other hard one (``alone``).

    On ``open`` more it depends on what is unknown.
    """

    rule: str
    strength: Strength
    violating: int
    alone: int | None
    open: int
    example: ManeuverData | None


class ClassesData(JsonPart, frozen=True, kw_only=True):
    """The counts of homotopy classes, and the cheapest satisfying members of some.

    So many more are ``open``.
    """

    total: int
    satisfying: int
    divided: int
    open: int
    counting_steps: Sequence[str]
    representatives: Sequence[ManeuverData]


class ManeuversDocument(JsonDocument, frozen=True, kw_only=True):
    """The counts of maneuvers in a scenario, and further answers asked for.

    On ``open`` more than those ``satisfying`` it depends on what is ``unknown``; ``exact`` is false
    if there was too much to look at, and some may be known after all. ``judged`` are the rules that
    half of them or more keep or violate for sure, null unless cells have words. With ``bounds`` of
    ego's motion (m, s) they are paths through reachable cells, else through all. ``least_braking``
    (m/s²) is there where one is shown that brakes hard, and none brakes less than that.
    """

    scenario: str
    rulebook: str
    partition: PartitionName
    adjacency: AdjacencyName
    extent: ExtentName
    step_s: float
    horizon_s: float
    nodes: int
    edges: int
    bounds: Mapping[str, float] | None
    traces: int
    satisfying: int
    violating: int
    open: int
    exact: bool
    judged: Sequence[str] | None
    unknown: Sequence[str]
    not_judged: Sequence[NotJudgedRule]
    by_default: Sequence[str]
    dead_end: DeadEndData | None
    seconds: float
    scene: SceneData | UnsetType = UNSET
    violated_before: Sequence[PastViolation] | UnsetType = UNSET
    least_violating: Sequence[ManeuverData] | UnsetType = UNSET
    ranked: Sequence[ManeuverData] | UnsetType = UNSET
    maneuvers: Sequence[ManeuverData] | UnsetType = UNSET
    likeliest: float | UnsetType = UNSET
    worlds: Sequence[WorldData] | UnsetType = UNSET
    rules: Sequence[PruningData] | UnsetType = UNSET
    classes: ClassesData | UnsetType = UNSET
    least_braking: float | UnsetType = UNSET


def as_json(maneuvers: Maneuvers, answers: ManeuverAnswers, seconds: float) -> str:
    """Write the counts and what was asked for."""
    graph, scenario = maneuvers.graph, maneuvers.graph.scenario
    several = any(obstacle.alternatives for obstacle in scenario.obstacles)
    several = several or answers.worlds is not None
    least = maneuver_report.least_braking(maneuvers, answers)
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
            judged=_judged(maneuvers),
            unknown=maneuvers.unknown,
            not_judged=not_judged_data(maneuvers.not_judged, maneuvers.rules),
            by_default=maneuvers.by_default,
            dead_end=dead_end_data(maneuvers),
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
                    open=_open(answers.verdicts.get(maneuver.nodes), maneuvers),
                    chances=_chances(answers, maneuver),
                ),
            ),
            likeliest=maneuver_report.likeliest(scenario) if several else UNSET,
            worlds=_each(answers.worlds, _world),
            rules=_each(answers.prunings, partial(_pruning, maneuvers)),
            classes=UNSET if answers.classes is None else _classes(maneuvers, *answers.classes),
            least_braking=UNSET if least is None else round(least, 3),
        )
    )


def _judged(maneuvers: Maneuvers) -> list[str] | None:
    """The rules that the words of cells judge; None where cells have none."""
    if maneuvers.words is None:
        return None
    return [outcomes.rule.name for outcomes in maneuvers.rule_outcomes() if outcomes.judged]


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
    driven = trajectory_data(maneuver)
    return filled(
        ManeuverData, maneuver, cells=cells, envelope=bounds, trajectory=driven, **details
    )


def _violations(maneuvers: Maneuvers, violations: Iterable[Violation]) -> list[ManeuverViolation]:
    rules = {rule.name: rule for rule in maneuvers.rules.rules}
    return [
        filled(
            ManeuverViolation,
            violation,
            cite=rules[violation.rule].cite,
            inherited_from=rules[violation.rule].inherited_from or UNSET,
            lost_s=None
            if violation.step is None
            else maneuvers.graph.layers[violation.step].start_s,
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
    """The greater bound; nothing if it is the lesser one."""
    return UNSET if greatest is None or greatest == least else float(greatest)


def _float(probability: Fraction | None) -> float | None:
    return None if probability is None else float(probability)
