"""Trajectories of maneuvers in recorded scenes, scored as drives."""

import json
from dataclasses import replace

import numpy as np
import pytest

import rulec
from rulec.cli.main import main
from rulec.diagnostics import RulecError
from rulec.scoring.maneuver_trajectories import trajectory_scores
from rulec.scoring.sampled_ways import recorded_way, sampled_ways
from support.builders.recordings import SAMPLES, recording, straight, vehicle

STEP_S = 0.5
FOLLOWING = next(iter(SAMPLES))
TURNED = 0.7
"""The direction (rad) of the road, which is nowhere along an axis."""


def world(*, slow_mps=6.0, until_s=6.0, beyond_s=6.0, limit_kmh=50, side="right"):
    """Ego at 10 m/s in the right one of two lanes, 30 m behind a slow car that ends early."""
    ahead = np.array([np.cos(TURNED), np.sin(TURNED)])
    left = np.array([-ahead[1], ahead[0]]) * (1 if side == "right" else -1)
    beside = "left_of" if side == "right" else "right_of"
    back = "right_of" if side == "right" else "left_of"
    town = {"types": ["urban"], "limit_mps": limit_kmh / 3.6}
    lanes = [
        rulec.build_lanelet("near", [-100 * ahead, 400 * ahead], **{beside: "far"}, **town),
        rulec.build_lanelet(
            "far", [-100 * ahead + 3.5 * left, 400 * ahead + 3.5 * left], **{back: "near"}, **town
        ),
    ]

    def car(name, start_m, speed, until):
        t = np.arange(0, until + STEP_S / 2, STEP_S)
        places = (start_m + speed * t)[:, None] * ahead
        return rulec.build_participant(name, "car", t, *places.T, step_s=STEP_S)

    bodies = [car("ego", 0, 10.0, 1.0), car("slow", 30, slow_mps, until_s)]
    bodies.append(car("far ahead", 300, 10.0, beyond_s))
    return rulec.build_recording(lanes, bodies, step_s=STEP_S, side=side)


def scene(recorded, book="de"):
    at_present = rulec.Choice(ego="ego", at_s=1.0)
    return rulec.find_maneuvers(rulec.load_scenario(recorded, at_present), book)


def test_a_trajectory_is_driven_where_the_maneuver_is():
    found = scene(world())
    listed = found.cheapest(3, perhaps=True)
    scores = rulec.score_trajectories(found, listed)
    assert len(scores) == len(listed) == 3
    ahead = np.array([np.cos(TURNED), np.sin(TURNED)])
    for path, maneuver in zip(scores.paths, listed, strict=True):
        # The recording's step is the witness's, so its states are among the path's
        states = np.array(maneuver.trajectory.states)
        wanted = np.arange(1, 9) * STEP_S
        s = np.interp(wanted, states[:, 0], states[:, 1])
        # Ego is at 10 m when the scene begins; linear interpolation is off by a t² / 8
        assert path[:, :2] @ ahead - 10 == pytest.approx(s, abs=0.15)
        across = path[:, :2] @ [-ahead[1], ahead[0]]
        assert across[-1] == pytest.approx(states[-1, 3], abs=0.2)
        moved = np.hypot(*np.diff(path[:, :2], axis=0).T)
        assert moved == pytest.approx((path[1:, 3] + path[:-1, 3]) / 2 * STEP_S, abs=0.05)


def test_its_verdict_is_that_of_the_recording_in_which_it_is_driven():
    recorded = world(limit_kmh=30)
    found = scene(recorded)
    scores = rulec.score_trajectories(found, found.cheapest(2, perhaps=True))
    own = rulec.TrafficWorld(recorded, "ego", 1.0)
    for score, path in zip(scores.candidates, scores.paths, strict=True):
        driven = rulec.verify_recording(
            own.recording_of(path, own.past), "de", rulec.RequestedDrives(("ego",))
        )
        (verdict,) = [answer.answer for answer in driven.answers()]
        ruled = {violation.rule for violation in verdict.violations}
        # At 36 km/h where 30 are allowed, as before: not charged while it goes on
        assert "speed_limit" in ruled
        assert {violation.rule for violation in score.violations} <= ruled
        assert {open_rule.rule for open_rule in score.open} <= {
            open_rule.rule for open_rule in verdict.open
        } | ruled


def test_a_certain_verdict_where_the_maneuver_is_open():
    found = scene(world(slow_mps=12.0))
    listed = found.cheapest(1, perhaps=True)
    assert found.verdict(listed[0]).open
    (score,) = rulec.score_trajectories(found, listed).candidates
    assert not score.violations
    open_before = {doubtful.rule for doubtful in found.verdict(listed[0]).open}
    assert {doubtful.rule for doubtful in score.open} < open_before


def test_a_mirrored_scene_is_scored_where_it_was_recorded():
    recorded = world(side="right")
    right, left = scene(recorded), scene(recorded, "gb")
    assert left.graph.scenario.account.mirrored
    ahead = np.array([np.cos(TURNED), np.sin(TURNED)])
    for found in (right, left):
        paths = rulec.score_trajectories(found, found.cheapest(1, perhaps=True)).paths
        assert np.abs(paths[..., :2] @ [-ahead[1], ahead[0]]).max() < 1.0
        assert (paths[..., :2] @ ahead > 10).all()
        assert np.abs(paths[..., 2] - TURNED).max() < 0.2


def test_trajectories_are_scored_until_the_recording_ends():
    found = scene(world(until_s=3.0, beyond_s=3.0))
    listed = found.cheapest(1, perhaps=True)
    driven = trajectory_scores(found, listed)
    assert (driven.until_s, driven.is_cut) == (2.0, True)
    assert rulec.score_trajectories(found, listed).paths.shape == (1, 4, 4)
    whole = trajectory_scores(scene(world()), listed)
    assert (whole.until_s, whole.is_cut) == (4.0, False)


def test_who_is_alone_is_scored_until_the_horizon():
    recorded = world(until_s=1.0, beyond_s=1.0)
    alone = replace(recorded, participants=recorded.participants[:1])
    found = scene(alone)
    assert rulec.score_trajectories(found, found.cheapest(1, perhaps=True)).paths.shape[1] == 8
    # How the others go on from where the recording ends is not known
    ends = scene(recorded)
    with pytest.raises(RulecError, match=r"the recording ends where the scene begins.*R0781"):
        rulec.score_trajectories(ends, ends.cheapest(1, perhaps=True))


def test_assumptions_hold_for_trajectories_too():
    recorded = world()
    plain = rulec.load_scenario(recorded, rulec.Choice(ego="ego", at_s=1.0))
    assumed = rulec.Assumptions(values={"headlamps": "dipped_beam", "visibility": 1000.0})
    judged = []
    for assumptions in (None, assumed):
        found = rulec.find_maneuvers(plain, "de", assumptions=assumptions)
        (score,) = rulec.score_trajectories(found, found.cheapest(1, perhaps=True)).candidates
        judged.append({rule.rule for rule in score.not_judged} | {x.rule for x in score.open})
    assert judged[1] < judged[0]


def test_an_ego_of_a_planning_problem_begins_to_drive():
    lanes = [straight(1, 0, 300)]
    others = [vehicle(5, {k: (60 + 5 * k, 0.0) for k in range(12)}, speed=10.0)]
    made = replace(recording(lanes, others, ego=(20.0, 0.0), goals=[(200.0, 0.0)]), side="right")
    found = rulec.find_maneuvers(rulec.load_scenario(made), "de")
    scores = rulec.score_trajectories(found, found.cheapest(1, perhaps=True))
    assert scores.paths[0, 0, 0] == pytest.approx(20, abs=2)
    assert not scores.candidates[0].off_road


WITHIN = """rulebook within
use road
hard rule slowly { require always (speed >= 1 km/h implies speed <= 90 km/h) }
hard rule slower { require always (motorway implies speed <= 1 km/h) }
hard rule far (v: vehicle) { require always (tunnel and beside(v) implies speed <= 1 km/h) }
"""


@pytest.mark.parametrize(
    ("rules", "lawful", "tested"),
    [
        # Nobody knows whether it is a motorway, and nobody is beside ego
        (WITHIN, True, (("slowly",), (), ())),
        (WITHIN.replace("motorway", "speed >= 1 km/h and tunnel"), True, (("slowly",), (), ())),
        # What lacks a word is told beside what is kept
        (
            WITHIN.replace("motorway implies", "speed >= 1 km/h implies tunnel or"),
            True,
            (("slowly",), (), ("slower",)),
        ),
        # As fast as is allowed, within the tolerance
        (
            WITHIN.replace("motorway implies speed <= 1", "speed >= 1 km/h implies speed <= 36"),
            False,
            (("slowly",), ("slower",), ()),
        ),
        # Silence is no lawfulness
        (WITHIN.replace("speed >= 1 km/h", "tunnel"), False, ((), (), ())),
    ],
)
def test_lawful_is_who_keeps_each_rule_that_is_surely_met(tmp_path, rules, lawful, tested):
    (tmp_path / "within.rules").write_text(rules)
    scene = rulec.load_scenario(world(), rulec.Choice(ego="ego", at_s=1.0))
    found = rulec.find_maneuvers(scene, tmp_path / "within.rules")
    (listed,) = found.cheapest(1, perhaps=True)
    scores = trajectory_scores(found, [listed])
    assert (listed.nodes in scores.lawful_as_driven) is lawful
    own = scores.tested[listed.nodes]
    assert (own.kept, own.undecided, own.not_judged) == tested


def test_another_way_may_be_lawful_where_the_cheapest_is_not():
    """Ego is 19 m behind one at half its speed: it has to brake, or to pull out."""
    found = scene(world(slow_mps=5.0))
    listed = found.cheapest(1, perhaps=True)
    scores = trajectory_scores(found, listed)
    assert not scores.lawful_as_driven
    assert scores.lawful
    assert scores.n_tried == len({listed[0].nodes, *scores.sampled})


def test_what_ego_was_recorded_to_do_is_among_the_ways():
    found = rulec.find_maneuvers(rulec.load_scenario(FOLLOWING, rulec.Choice(ego="3")), "de")
    recorded = rulec.read_recording(FOLLOWING)
    (ego,) = [one for one in recorded.participants if one.id == "3"]
    way = recorded_way(found.graph, found.graph.scenario.account.origin)
    assert len(way.nodes) == len(found.graph.layers)
    assert way.motion[0, [0, 2]] == pytest.approx((0.0, found.graph.scenario.ego.d), abs=0.05)
    places = np.array([(ego.states[k].x, ego.states[k].y) for k in range(len(way.times_s))])
    driven = np.hypot(*np.diff(places, axis=0).T).sum()
    assert way.motion[-1, 0] == pytest.approx(driven, rel=0.02)
    assert way.nodes in trajectory_scores(found, []).sampled
    # Whose track ends before the horizon was not recorded to do anything
    assert recorded_way(scene(world()).graph, scene(world()).graph.scenario.account.origin) is None


def test_sampled_ways_are_drivable_through_their_cells_and_meet_nobody():
    found = scene(world(slow_mps=5.0))
    graph = found.graph
    ways = sampled_ways(graph, found.witness_search.others)
    assert {len(way.nodes) for way in ways} == {len(graph.layers)}
    assert len({way.nodes for way in ways}) > 2
    times = np.arange(0, 4.001, 0.1)
    for way in ways:
        for before, after, links in zip(way.nodes, way.nodes[1:], graph.successors, strict=False):
            assert after in links[before]
        s, along, d, across = way.at(times).T
        assert (s[0], d[0], along[0]) == pytest.approx((0.0, graph.scenario.ego.d, 10.0), abs=0.05)
        assert (along >= 0).all()
        assert np.abs(np.diff(along) / 0.1).max() < 5.01
        assert np.abs(np.diff(across) / 0.1).max() < 2.01
        # Both bodies are 4.5 m long; ego is at 10 m and the other at 35 m when the scene begins
        ahead = 25 + 5 * times - s
        beside = np.abs(d - graph.scenario.ego.d) >= 1.6
        assert (beside | (ahead > 4.45)).all()


def test_what_has_no_trajectory_is_refused():
    built_in = rulec.find_maneuvers("s1", "esterle2019")
    with pytest.raises(RulecError, match=r"not of a scene from a recording.*R0781"):
        rulec.score_trajectories(built_in, built_in.cheapest(1))
    found = scene(world())
    bare = [replace(maneuver, trajectory=None) for maneuver in found.cheapest(2, perhaps=True)]
    with pytest.raises(RulecError, match=r"maneuver 0 has no trajectory.*R0781"):
        rulec.score_trajectories(found, bare)
    assert not trajectory_scores(found, bare).of
    assert trajectory_scores(built_in, built_in.cheapest(1)) is None


def test_the_command_tells_the_verdict(capsys):
    # docs/for_developers.md has the same violation of the recorded drive
    lost = "violates following_distance for v = 2 from 2.5 s on"
    command = ["maneuvers", str(FOLLOWING), "-r", "de", "--ego", "1"]
    assert main([*command, "--list", "2"]) == 0
    told = capsys.readouterr().out
    assert told.count("   trajectory: ") == 2
    assert f"   trajectory: {lost};" in told
    main([*command, "--list", "2", "--json"])
    found = json.loads(capsys.readouterr().out)
    verdicts = [maneuver["trajectory"]["verdict"] for maneuver in found["maneuvers"]]
    lawful = found["lawful"]
    assert f"lawful      {lawful} of " in told
    assert lawful > sum(verdict["lawful"] for verdict in verdicts)
    ways = found["lawful_ways"]
    assert len({tuple(way["cells"]) for way in ways}) == len(ways) > 2
    for way in ways:
        assert [row[0] for row in way["states"]] == [0.5 * number for number in range(9)]
        assert way["states"][0] == pytest.approx(ways[0]["states"][0])
    counts = [found[name] for name in ("free", "lawful", "closed", "undecided")]
    assert (sum(counts), counts[1]) == (found["traces"], lawful)
    # Who violates a rule has met it; it is not among those that it keeps
    assert not verdicts[0]["lawful"]
    assert "following_distance" not in verdicts[0]["kept"]
    (violation,) = verdicts[0]["violations"]
    assert (violation["rule"], violation["binding"]) == ("following_distance", {"v": "2"})
    assert (violation["lost_s"], verdicts[0]["until_s"]) == (2.5, 4.0)
    main([*command, "--rank", "1"])
    assert "   trajectory: " in capsys.readouterr().out
