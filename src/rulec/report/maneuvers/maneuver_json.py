"""Maneuvers, their violations and probabilities as JSON."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass
from fractions import Fraction
from math import floor
from typing import Any

from rulec.monitoring.verdict import OpenVerdict, Violation
from rulec.partition import envelope
from rulec.planning import Maneuvers, RankedManeuver, RulePruning
from rulec.planning.ranking.cheapest import Maneuver
from rulec.planning.ranking.penalties import PenaltyRank
from rulec.report.json_document import as_line, filled
from rulec.report.maneuvers import maneuver_report
from rulec.report.maneuvers.maneuver_document import (
    BindingProbability,
    CellData,
    ChancesData,
    ClassesData,
    DeadEndData,
    DerivedSignal,
    LawfulWay,
    LevelPenalty,
    ManeuverData,
    ManeuversDocument,
    ManeuverViolation,
    PruningData,
    RuleProbabilityData,
    SceneData,
    TrajectoryData,
    TrajectoryVerdictData,
    WorldData,
)
from rulec.report.maneuvers.maneuver_report import ManeuverAnswers
from rulec.report.verdicts.verdict_json import NotJudgedRule, OpenData, with_rules


def as_json(maneuvers: Maneuvers, answers: ManeuverAnswers, seconds: float) -> str:
    """Write the counts and the further answers."""
    return as_line(_AnsweredManeuvers(maneuvers, answers).document(seconds))


@dataclass(frozen=True)
class _AnsweredManeuvers:
    """Maneuvers and the answers about them, as parts of the document."""

    maneuvers: Maneuvers
    answers: ManeuverAnswers

    def document(self, seconds: float) -> ManeuversDocument:
        """The counts, and the answers to what was asked."""
        maneuvers, answers = self.maneuvers, self.answers
        graph, scenario = maneuvers.graph, maneuvers.graph.scenario
        several = any(obstacle.alternatives for obstacle in scenario.obstacles)
        several = several or answers.worlds is not None
        hard = maneuver_report.hard_braking(maneuvers, answers)
        # Rounded up, it would be more than what is proved
        least = None if hard is None else floor(1000 * hard.least) / 1000
        later = hard is not None and hard.later
        return filled(
            ManeuversDocument,
            graph,
            maneuvers,
            scenario=scenario.name,
            rulebook=maneuvers.rules.name,
            horizon_s=maneuver_report.horizon_s(graph),
            free=maneuvers.satisfying,
            lawful=answers.lawful,
            closed=maneuvers.violating,
            undecided=maneuvers.open - answers.lawful,
            bounds=None if graph.bounds is None else asdict(graph.bounds),
            judged=answers.judged,
            not_judged=with_rules(NotJudgedRule, maneuvers.not_judged, maneuvers.rules),
            dead_end=self._dead_end(),
            seconds=round(seconds, 6),
            scene=self._scene(),
            violated_before=maneuvers.violated_before,
            least_violating=answers.best and [*map(self._ranked, answers.best)],
            ranked=answers.ranked and [*map(self._ranked, answers.ranked)],
            maneuvers=answers.listed and [*map(self._listed, answers.listed)],
            lawful_ways=self._lawful_ways(),
            likeliest=maneuver_report.likeliest(scenario) if several else None,
            worlds=answers.worlds
            and [
                filled(WorldData, world, prediction=world.number + 1, weight=float(world.weight))
                for world in answers.worlds
            ],
            rules=answers.prunings and [*map(self._pruning, answers.prunings)],
            classes=self._classes(),
            least_braking=None if later else least,
            least_braking_later=least if later else None,
            in_way=maneuvers.in_way if maneuver_report.lists_none(maneuvers, answers) else None,
        )

    def _lawful_ways(self) -> list[LawfulWay] | None:
        """The lawful ways in a recorded scene, else None."""
        driven, layers = self.answers.driven, self.maneuvers.graph.layers
        if driven is None:
            return None
        times_s = [layer.start_s for layer in layers]
        return [
            LawfulWay(cells=nodes, states=way.rows_at(times_s))
            for nodes, way in driven.sampled.items()
            if way is not None
        ]

    def _dead_end(self) -> DeadEndData | None:
        """The dead end if there is no maneuver, else None."""
        end = self.maneuvers.dead_end
        if end is None:
            return None
        return filled(DeadEndData, end, last_s=self.maneuvers.graph.layers[end.layer].start_s)

    def _scene(self) -> SceneData | None:
        account = self.maneuvers.graph.scenario.account
        if account is None:
            return None
        derived = {
            name: DerivedSignal(value=value, because=why)
            for name, (value, why) in maneuver_report.derived_signals(
                self.maneuvers, account
            ).items()
        }
        counts = {"obstacles": account.recorded, "recorded_until_s": account.until_s}
        return filled(SceneData, account, derived=derived, **counts)

    def _listed(self, maneuver: Maneuver) -> ManeuverData:
        verdict = self.answers.verdicts.get(maneuver.nodes)
        return self._maneuver(maneuver, open=None if verdict is None else self._open(verdict.open))

    def _ranked(self, ranked: RankedManeuver) -> ManeuverData:
        in_doubt = self.maneuvers.in_doubt or bool(ranked.open)
        return self._maneuver(
            ranked.maneuver,
            place=ranked.place,
            penalty=_penalty(ranked.penalty),
            at_least=_penalty(ranked.at_least) if in_doubt else None,
            members=ranked.members,
            violations=self._violations(ranked.violations),
            open=self._open(ranked.open) if in_doubt else None,
        )

    def _open(self, results: Sequence[OpenVerdict]) -> list[OpenData]:
        return with_rules(OpenData, results, self.maneuvers.rules)

    def _maneuver(self, maneuver: Maneuver, **details: Any) -> ManeuverData:
        graph = self.maneuvers.graph
        cells = [
            filled(CellData, layer.cells[index], cell=index, start_s=layer.start_s)
            for layer, index in zip(graph.layers, maneuver.nodes, strict=True)
        ]
        own = {"trajectory": self._trajectory(maneuver), "chances": self._chances(maneuver)}
        bounds = envelope(graph, maneuver.nodes)
        return filled(ManeuverData, maneuver, cells=cells, envelope=bounds, **own, **details)

    def _trajectory(self, maneuver: Maneuver) -> TrajectoryData | None:
        """The trajectory of a maneuver, if it has one, with its costs and its verdict."""
        driven, scores = maneuver.trajectory, self.answers.driven
        if driven is None:
            return None
        costs = {"changes": maneuver.changes or 0.0, **asdict(driven.cost)}
        score = None if scores is None else scores.of.get(maneuver.nodes)
        verdict = (
            scores
            and score
            and filled(
                TrajectoryVerdictData,
                score,
                scores.tested[maneuver.nodes],
                satisfied=score.satisfied_as_judged,
                lawful=maneuver.nodes in scores.lawful_as_driven,
                not_judged=scores.tested[maneuver.nodes].not_judged,
                until_s=scores.until_s,
                violations=self._violations(score.violations, scores.time_s),
                open=self._open(score.open),
            )
        )
        return filled(TrajectoryData, driven, costs=costs, verdict=verdict)

    def _violations(
        self, violations: Iterable[Violation], time_s: Callable[[int], float] | None = None
    ) -> list[ManeuverViolation]:
        """Violations with their times: those of layers, unless ``time_s`` gives those of states."""
        rules = {rule.name: rule for rule in self.maneuvers.rules.rules}
        time_of = time_s or (lambda layer: self.maneuvers.graph.layers[layer].start_s)
        return [
            filled(
                ManeuverViolation,
                violation,
                rules[violation.rule],
                lost_s=None if violation.step is None else time_of(violation.step),
            )
            for violation in violations
        ]

    def _chances(self, maneuver: Maneuver) -> ChancesData | None:
        chances = self.answers.chances.get(maneuver.nodes)
        if chances is None:
            return None
        rules = [
            filled(
                RuleProbabilityData,
                rule.rule,
                rule=rule.rule.name,
                kept=_float(rule.kept),
                bindings=[
                    filled(
                        BindingProbability,
                        binding,
                        kept=float(binding.kept),
                        kept_at_most=_above(binding.kept, binding.at_most),
                    )
                    for binding in rule.bindings
                ],
                kept_at_most=_above(rule.kept, rule.at_most),
            )
            for rule in chances.rules
        ]
        return filled(
            ChancesData,
            clear=float(chances.clear),
            every_hard_rule=_float(chances.hard),
            rules=rules,
            every_hard_rule_at_most=_above(chances.hard, chances.hard_at_most),
        )

    def _pruning(self, pruning: RulePruning) -> PruningData:
        rule, violations = pruning.rule, self._violations(pruning.violations)
        example = pruning.example and self._maneuver(pruning.example, violations=violations)
        about = {"rule": rule.name, "strength": rule.strength}
        return filled(PruningData, pruning, example=example, **about)

    def _classes(self) -> ClassesData | None:
        if self.answers.classes is None:
            return None
        classes, variants = self.answers.classes
        return filled(
            ClassesData,
            classes,
            counting_steps=[rule.name for rule in self.maneuvers.counting_steps()],
            representatives=[
                self._maneuver(variant.cheapest, members=variant.members) for variant in variants
            ],
        )


def _penalty(penalty: Mapping[PenaltyRank, Fraction]) -> list[LevelPenalty]:
    return [
        filled(LevelPenalty, rank, levels=[level or None for level in rank.levels], weight=weight)
        for rank, weight in penalty.items()
    ]


def _above(least: Fraction | None, greatest: Fraction | None) -> float | None:
    """The upper bound, None if equal to the lower one."""
    return None if greatest is None or greatest == least else float(greatest)


def _float(probability: Fraction | None) -> float | None:
    return None if probability is None else float(probability)
