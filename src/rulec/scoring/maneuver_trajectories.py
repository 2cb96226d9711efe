"""Trajectories of maneuvers in a recorded scene, scored like what a planner samples.

A maneuver has a verdict for all positions in its cells. Its trajectory is one way to drive it, and
its verdict may be certain where that of the maneuver is open.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.cell_words.ego_boxes import body_size
from rulec.cell_words.probe_drives import driver
from rulec.extraction.recording_verdicts import DriveVerdict
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.monitoring.moments.drive_facts import facts_of
from rulec.monitoring.verdict import Verdict
from rulec.partition.motion.witness_trajectory import WitnessTrajectory
from rulec.planning import Maneuvers
from rulec.planning.ranking.cheapest import Maneuver
from rulec.recordings.recording import Recording
from rulec.recordings.track import Track, TrackOutlines, TrackStates
from rulec.scenario.recorded.scene_origin import SceneOrigin
from rulec.scoring.candidate_score import CandidateScore
from rulec.scoring.score import score
from rulec.scoring.scores import Scores
from rulec.scoring.scoring_messages import NO_TRAJECTORY
from rulec.scoring.traffic_world import TrafficWorld

_STANDING_MPS = 0.05
"""Slower than this, ego's heading is that of the road."""

_MOST_TURNED = np.pi / 4
"""The greatest angle (rad) between ego's heading and the road."""

_ROUNDING = 1e-6


@dataclass(frozen=True, slots=True)
class TestedRules:
    """The hard rules whose trigger a trajectory surely meets: those kept, and the undecided ones.

    A rule without a trigger is met by all.
    """

    kept: tuple[str, ...]
    undecided: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class TrajectoryScores:
    """The scores of maneuvers' trajectories and the rules that these meet, by the maneuvers' nodes.

    Violations are those of states ``step_s`` (s) apart, the first one after the scene's beginning;
    the last one is at ``until_s`` (s). ``is_cut`` if the recording ends before the horizon.
    """

    step_s: float
    until_s: float
    is_cut: bool
    of: Mapping[tuple[int, ...], CandidateScore]
    tested: Mapping[tuple[int, ...], TestedRules]

    @property
    def lawful(self) -> frozenset[tuple[int, ...]]:
        """The maneuvers whose trajectory keeps each hard rule that it meets, and meets some."""
        return frozenset(
            nodes
            for nodes, score in self.of.items()
            if score.is_judged
            and not score.off_road
            and self.tested[nodes].kept
            and not self.tested[nodes].undecided
            and all(violation.strength == "soft" for violation in score.violations)
        )

    def time_s(self, step: int) -> float:
        """The time (s) of a state of a trajectory."""
        return round((step + 1) * self.step_s, 6)


def trajectory_scores(maneuvers: Maneuvers, listed: Sequence[Maneuver]) -> TrajectoryScores | None:
    """The scores of those maneuvers that have a trajectory; None if there is no world for them.

    Also if the maneuvers continue a past that is not the recording's. Raises RulecError R0507.
    """
    driven = [maneuver for maneuver in listed if maneuver.trajectory is not None]
    n_states = _scored_states(maneuvers)
    if not driven or not n_states or maneuvers.after is not None:
        return None
    step_s = _origin(maneuvers).recording.step_s
    scores = score_trajectories(maneuvers, driven)
    found = zip(driven, scores.candidates, strict=True)
    of = {maneuver.nodes: candidate for maneuver, candidate in found}
    tested = {nodes: _tested(candidate, scores.rules) for nodes, candidate in of.items()}
    until_s = round(n_states * step_s, 6)
    return TrajectoryScores(step_s, until_s, until_s < _horizon_s(maneuvers) - step_s, of, tested)


def _tested(score: CandidateScore, rules: CompiledRulebook) -> TestedRules:
    """The hard rules that a trajectory, with its past, surely meets."""
    met: set[str] = set()
    # Opportunities of all rules, also of those that are not judged
    nothing_known = Verdict("", ())
    for driven in score.drives:
        if isinstance(driven, DriveVerdict) and isinstance(driven.answer, Verdict):
            exposures = facts_of(driven.drive.arrays, rules, nothing_known).exposure
            met |= {name for name, exposure in exposures.items() if exposure.opportunities}
    doubtful = {x.rule for x in score.open}.union(x.rule for x in score.not_judged)
    broken = {violation.rule for violation in score.violations}
    tested = [x.name for x in rules.rules if x.strength == "hard" and x.name in met - broken]
    return TestedRules(
        tuple([name for name in tested if name not in doubtful]),
        tuple([name for name in tested if name in doubtful]),
    )


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
    origin, account = _origin(maneuvers), maneuvers.graph.scenario.account
    is_mirrored = account is not None and account.mirrored
    times_s = np.arange(1, n_states + 1, dtype=float64) * origin.recording.step_s
    paths = np.empty((len(known), n_states, 4))
    for path, trajectory in zip(paths, known, strict=True):
        path[:] = _in_recording(origin, trajectory, times_s)
    if is_mirrored:
        paths[:, :, (1, 2)] *= -1
    world = _world_of(maneuvers, origin, is_mirrored=is_mirrored)
    return score(paths, world, maneuvers.rules, world.past)


def _in_recording(
    origin: SceneOrigin, trajectory: WitnessTrajectory, times_s: NDArray[float64]
) -> NDArray[float64]:
    """A trajectory's x, y (m), heading (rad) and speed (m/s) in the recording, a row each time."""
    s, along, d, across = trajectory.at(times_s).T
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
