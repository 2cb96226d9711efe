"""Trajectories of maneuvers in a recorded scene, scored like what a planner samples.

A maneuver has a verdict for all positions in its cells. Its trajectory is one way to drive it, and
its verdict may be certain where that of the maneuver is open.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from typing import TypeAlias, TypeVar

import numpy as np
from numpy import float64

from rulec.array_types import Floats
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.cell_words.ego_boxes import body_size
from rulec.cell_words.probe_drives import driver
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.monitoring.moments.drive_facts import facts_of
from rulec.monitoring.verdict import Verdict
from rulec.planning import Maneuvers
from rulec.planning.ranking.cheapest import Maneuver
from rulec.recordings.recording import Recording
from rulec.recordings.track import Track, TrackOutlines, TrackStates
from rulec.scenario.recorded.scene_origin import SceneOrigin
from rulec.scoring.candidate_score import CandidateScore
from rulec.scoring.charges import traces_of
from rulec.scoring.sampled_ways import SampledWay, recorded_way, sampled_ways
from rulec.scoring.score import score
from rulec.scoring.scores import Scores
from rulec.scoring.scoring_messages import NO_TRAJECTORY
from rulec.scoring.traffic_world import TrafficWorld
from rulec.trace.trace_arrays import TraceArrays

_STANDING_MPS = 0.05
"""Slower than this, ego's heading is that of the road."""

_MOST_TURNED = np.pi / 4
"""The greatest angle (rad) between ego's heading and the road."""

_ROUNDING = 1e-6

_MOST_TESTED = 24
"""Of so many ways it is looked up which rules they meet, which takes longer than their scores."""

_MOST_CHEAPEST = 3
"""Of so many maneuvers the trajectories are judged if no way is lawful and none is listed."""

_Found = TypeVar("_Found")

_Motion: TypeAlias = Callable[[Floats], Floats]
"""By times (s) a motion: a row each of s, speed along, d, speed across (m, m/s)."""


@dataclass(frozen=True, slots=True)
class TestedRules:
    """The hard rules whose trigger a trajectory surely meets: those kept, and the open ones.

    Beside them those that are not judged, for lack of words. A rule without a trigger is met by
    all.
    """

    kept: tuple[str, ...]
    undecided: tuple[str, ...]
    not_judged: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TrajectoryScores:
    """The scores of maneuvers' trajectories and the rules that these meet, by the maneuvers' nodes.

    Violations are those of states ``step_s`` (s) apart, the first one after the scene's beginning;
    the last one is at ``until_s`` (s). ``is_cut`` if the recording ends before the horizon.
    ``sampled`` are the maneuvers of further ways that ego may drive, with the gentlest of these
    that is lawful, if any is; ``tested`` has some of these, too.
    """

    step_s: float
    until_s: float
    is_cut: bool
    of: Mapping[tuple[int, ...], CandidateScore]
    tested: Mapping[tuple[int, ...], TestedRules]
    sampled: Mapping[tuple[int, ...], SampledWay | None]

    @property
    def lawful_as_driven(self) -> frozenset[tuple[int, ...]]:
        """The maneuvers whose trajectory keeps each hard rule that it meets, and meets some."""
        return frozenset(
            nodes
            for nodes, score in self.of.items()
            if _may_be_lawful(score)
            and self.tested[nodes].kept
            and not self.tested[nodes].undecided
        )

    @property
    def lawful(self) -> frozenset[tuple[int, ...]]:
        """The maneuvers of which a trajectory or another way does."""
        return self.lawful_as_driven.union(nodes for nodes, way in self.sampled.items() if way)

    @property
    def n_tried(self) -> int:
        """The number of maneuvers tried."""
        return len(self.of.keys() | self.sampled.keys())

    def time_s(self, step: int) -> float:
        """The time (s) of a state of a trajectory."""
        return round((step + 1) * self.step_s, 6)


def trajectory_scores(maneuvers: Maneuvers, listed: Sequence[Maneuver]) -> TrajectoryScores | None:
    """The scores of those maneuvers that have a trajectory; None if there is no world for them.

    And whether further ways that ego may drive are lawful; if none is and nothing is listed, the
    scores of the cheapest maneuvers. None, too, if the maneuvers continue a past that is not the
    recording's. Raises RulecError R0507.
    """
    n_states = _scored_states(maneuvers)
    if not n_states or maneuvers.after is not None:
        return None
    step_s = _origin(maneuvers).recording.step_s
    sampled, tested = _sampled(maneuvers, n_states)
    if not listed and not any(sampled.values()):
        listed = maneuvers.cheapest(_MOST_CHEAPEST, perhaps=True)
    driven = [maneuver for maneuver in listed if maneuver.trajectory is not None]
    of: dict[tuple[int, ...], CandidateScore] = {}
    if driven:
        scores = score_trajectories(maneuvers, driven)
        of = {one.nodes: own for one, own in zip(driven, scores.candidates, strict=True)}
        tested |= {nodes: _tested(candidate, scores.rules) for nodes, candidate in of.items()}
    until_s = round(n_states * step_s, 6)
    return TrajectoryScores(
        step_s=step_s,
        until_s=until_s,
        is_cut=until_s < _horizon_s(maneuvers) - step_s,
        of=of,
        tested=tested,
        sampled=sampled,
    )


_ByNodes: TypeAlias = dict[tuple[int, ...], _Found]


def _sampled(
    maneuvers: Maneuvers, n_states: int
) -> tuple[_ByNodes[SampledWay | None], _ByNodes[TestedRules]]:
    """The maneuvers of ways that ego may drive, with the gentlest lawful one, if any is.

    No more than a number are looked at, the gentlest first; of some also the rules that they meet.
    """
    search = maneuvers.witness_search
    recorded = recorded_way(maneuvers.graph, _origin(maneuvers))
    ways = [] if recorded is None else [recorded]
    ways += [] if search is None else sampled_ways(maneuvers.graph, search.others)
    found: _ByNodes[SampledWay | None] = {way.nodes: None for way in ways}
    tested: _ByNodes[TestedRules] = {}
    if not ways:
        return found, tested
    scores = _scores(maneuvers, [way.at for way in ways], n_states)
    hard = {rule.name for rule in scores.rules.rules if rule.strength == "hard"}
    kept: set[str] = set()
    for number in scores.perhaps_allowed.nonzero()[0].tolist()[:_MOST_TESTED]:
        way, traces, doubtful = ways[number], scores.traces_of(number), scores.open_rules[number]
        if found[way.nodes] or not traces or _met(traces, scores.rules, hard & doubtful):
            continue
        # Most meet what an earlier one met: to look up all rules takes longest
        if not _met(traces, scores.rules, kept - doubtful):
            (alone,) = _scores(maneuvers, [way.at], n_states).candidates
            own = _tested(alone, scores.rules)
            if not own.kept:
                continue
            tested[way.nodes] = own
            kept.update(own.kept)
        found[way.nodes] = way
    return found, tested


def _may_be_lawful(score: CandidateScore) -> bool:
    """Whether a drive is on the road, and violates no hard rule."""
    is_broken = any(violation.strength == "hard" for violation in score.violations)
    return score.is_judged and not score.off_road and not is_broken


def _tested(score: CandidateScore, rules: CompiledRulebook) -> TestedRules:
    """The hard rules that a trajectory, with its past, surely meets."""
    hard = {rule.name for rule in rules.rules if rule.strength == "hard"}
    met = _met(traces_of(score), rules, hard.difference(x.rule for x in score.violations))
    doubtful, lacking = ({x.rule for x in those} for those in (score.open, score.not_judged))
    tested = [rule.name for rule in rules.rules if rule.name in met]
    return TestedRules(
        tuple([name for name in tested if name not in doubtful | lacking]),
        tuple([name for name in tested if name in doubtful]),
        tuple([name for name in tested if name in lacking]),
    )


def _met(traces: Sequence[TraceArrays], rules: CompiledRulebook, asked: Set[str]) -> set[str]:
    """The rules among these, also those not judged, whose trigger surely holds somewhere."""
    others = tuple([rule.name for rule in rules.rules if rule.name not in asked])
    known = Verdict("", (), kept_regardless=others)
    exposures = [facts_of(own, rules, known).exposure for own in (traces if asked else ())]
    return {name for own in exposures for name, exposure in own.items() if exposure.opportunities}


def _scored_states(maneuvers: Maneuvers) -> int:
    """The number of the recording's steps for which trajectories can be scored; 0 if for none.

    They end with the recording: a scene lets the others go on beyond it, a recording does not. If
    ego is alone, nobody could go on.
    """
    account = maneuvers.graph.scenario.account
    if account is None or not _is_recorded(maneuvers):
        return 0
    origin, seconds = _origin(maneuvers), _horizon_s(maneuvers)
    if any(one.id != origin.start.participant for one in origin.recording.participants):
        seconds = min(seconds, account.until_s)
    return max(0, int(seconds / origin.recording.step_s + _ROUNDING))


def _is_recorded(maneuvers: Maneuvers) -> bool:
    """Whether the scene has a recording whose words its cells have."""
    account = maneuvers.graph.scenario.account
    return account is not None and account.origin is not None and maneuvers.words is not None


def _horizon_s(maneuvers: Maneuvers) -> float:
    return (len(maneuvers.graph.layers) - 1) * maneuvers.graph.step_s


def _origin(maneuvers: Maneuvers) -> SceneOrigin:
    account = maneuvers.graph.scenario.account
    assert account is not None, "the scene is recorded"
    assert isinstance(account.origin, SceneOrigin), "the others move as recorded"
    return account.origin


def score_trajectories(maneuvers: Maneuvers, listed: Sequence[Maneuver]) -> Scores:
    """Score the trajectories of some of a recorded scene's maneuvers, in their order.

    The others do what was recorded, and ego's recorded past counts. Coordinates of the result are
    the recording's, also if the scene is mirrored. Raises RulecError R0781 for maneuvers without a
    trajectory, or whose scene has no recording; R0507 if a rule was compiled for another step than
    the recording's.
    """
    n_states = _scored_states(maneuvers)
    if not n_states:
        if _is_recorded(maneuvers):
            raise NO_TRAJECTORY.error(
                None,
                "the recording ends where the scene begins, and how the others go on is not known",
                help="begin earlier, or add to the recording what the others are expected to do",
            )
        raise NO_TRAJECTORY.error(
            None,
            "the maneuvers are not of a scene from a recording with bounds of ego's motion",
            help="find the maneuvers of a recording, in the partition `fine`",
        )
    driven = [maneuver.trajectory for maneuver in listed]
    known = [trajectory for trajectory in driven if trajectory is not None]
    if len(known) < len(driven):
        raise NO_TRAJECTORY.error(
            None,
            f"maneuver {driven.index(None)} has no trajectory",
            help="take maneuvers of `cheapest`, or with a trajectory (`maneuver.trajectory`)",
        )
    return _scores(maneuvers, [trajectory.at for trajectory in known], n_states)


def _scores(maneuvers: Maneuvers, ways: Sequence[_Motion], n_states: int) -> Scores:
    """The scores of motions along the scene's road, for so many of the recording's steps."""
    origin, account = _origin(maneuvers), maneuvers.graph.scenario.account
    is_mirrored = account is not None and account.mirrored
    times_s = np.arange(1, n_states + 1, dtype=float64) * origin.recording.step_s
    paths = np.array([_in_recording(origin, motion_at(times_s)) for motion_at in ways])
    if is_mirrored:
        paths[:, :, (1, 2)] *= -1
    world = _world_of(maneuvers, origin, is_mirrored=is_mirrored)
    return score(paths, world, maneuvers.rules, world.past)


def _in_recording(origin: SceneOrigin, motion: Floats) -> Floats:
    """A motion's x, y (m), heading (rad) and speed (m/s) in the recording, a row each time."""
    s, along, d, across = motion.T
    places, road = origin.places(s, d)
    turned = np.arctan2(across, np.maximum(along, _STANDING_MPS))
    turned[along < _STANDING_MPS] = 0.0
    heading = road + np.clip(turned, -_MOST_TURNED, _MOST_TURNED)
    return np.column_stack((places, heading, np.hypot(along, across)))


def _world_of(maneuvers: Maneuvers, origin: SceneOrigin, *, is_mirrored: bool) -> TrafficWorld:
    """The recorded world of a scene, in which ego is there at the scene's beginning."""
    recording, ego = _with_start(maneuvers, origin)
    if is_mirrored:
        recording = mirrored_recording(recording)
    assumptions = maneuvers.reading.assumptions
    wanted = RequestedDrives(assumed=assumptions.values, defaults=assumptions.defaults)
    now_s = origin.start.step * recording.step_s
    return TrafficWorld(recording, ego, now_s, wanted)


def _with_start(maneuvers: Maneuvers, origin: SceneOrigin) -> tuple[Recording, str]:
    """The recording with ego among its participants, and ego's id."""
    recording, start = origin.recording, origin.start
    if start.participant is not None:
        return recording, start.participant
    row = start.state.x, start.state.y, start.state.heading, start.state.speed, 0.0
    track = Track(np.array([start.step]), np.array([row]), *body_size(maneuvers.graph))
    ego = replace(driver(origin), states=TrackStates(track), outlines=TrackOutlines(track))
    return replace(recording, participants=(*recording.participants, ego)), ego.id
