"""Words in cells hold for every drive through them, and so do the verdicts on maneuvers."""

import os
import random
from dataclasses import replace
from itertools import pairwise
from math import atan2, floor, hypot
from types import SimpleNamespace

import numpy as np
import pytest
from hypothesis import HealthCheck, assume, given, settings
from hypothesis import strategies as st

from rulec import RulecError, compile_rulebook, find_maneuvers
from rulec.cell_words.place_words import PlaceWords, SceneWords
from rulec.cell_words.probe_drives import LaneProbe, probe_drives
from rulec.cell_words.road_frame import RoadFrame
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.scenario import Choice
from rulec.scenario.recorded.recorded_scene import seen_from_ego
from rulec.vocabulary.partial_values import UNKNOWN, Interval, OneOf
from support.builders.recorded_data import RECORDINGS
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.generators.driven_motions import paths_of
from support.oracles.compared_maneuvers import check, check_on_edges, check_sampled, compared
from support.oracles.witness_drives import begins_on_an_edge, states_of

MOTIONS = int(os.environ.get("RULEC_TEST_MOTIONS", "5000"))
"""So many random motions in each recording, or fewer where most leave its cells; each takes 16 ms
when nothing else runs."""

NARROW = {"BEL_Putte-10_2_T-1"}
"""No random motion keeps to the cells beside one that reaches into ego's lane."""

FILES = sorted(RECORDINGS.glob("*.xml"))
LANES = (straight(1, 0, 300, left_of=2), straight(2, 0, 300, y=4, right_of=1))


@pytest.fixture(scope="module")
def german():
    return compile_rulebook("de")


OVERTAKEN = vehicle(10, {k: (75.0 + k, 0.0) for k in range(41)}, speed=10.0)
"""A slow car ahead of ego, in the lane that is nearer to the kerb in either country."""


@pytest.mark.parametrize("prediction", ["recorded", "constant"])
def test_a_scene_is_mirrored_for_rules_of_the_other_side(prediction):
    made = replace(recording(LANES, [OVERTAKEN], ego=(60, 0)), side="right")
    choice, british = Choice(prediction=prediction), compile_rulebook("gb")
    here = find_maneuvers(seen_from_ego(made, choice, "f.xml"), british)
    there = find_maneuvers(seen_from_ego(mirrored_recording(made), choice, "f.xml"), british)
    assert here.graph.scenario.account.mirrored
    assert not there.graph.scenario.account.mirrored
    assert (here.traces, here.satisfying, here.violating, here.open) == (
        there.traces,
        there.satisfying,
        there.violating,
        there.open,
    )
    assert {one.rule.name for one in here.rule_outcomes() if one.judged} == {
        one.rule.name for one in there.rule_outcomes() if one.judged
    }


def test_a_mirrored_scene_is_mirrored_back(german):
    made = replace(recording(LANES, [OVERTAKEN], ego=(60, 0)), side="right")
    scene = seen_from_ego(made, Choice(), "f.xml")
    mirrored = find_maneuvers(scene, compile_rulebook("gb")).graph.scenario
    assert find_maneuvers(mirrored, compile_rulebook("gb")).graph.scenario == mirrored
    back = find_maneuvers(mirrored, german)
    assert back.graph.scenario == scene
    assert back.satisfying == find_maneuvers(scene, german).satisfying


def test_a_scene_of_the_rules_side_is_not_mirrored():
    made = recording(LANES, [OVERTAKEN], ego=(60, 0))
    for side in ("right", None):
        scene = seen_from_ego(replace(made, side=side), Choice(), "f.xml")
        assert not find_maneuvers(scene, compile_rulebook("de")).graph.scenario.account.mirrored
    unsaid = seen_from_ego(replace(made, side=None), Choice(), "f.xml")
    assert not find_maneuvers(unsaid, compile_rulebook("gb")).graph.scenario.account.mirrored


def test_a_mirrored_scene_keeps_its_step_and_horizon_and_other_changes_are_refused():
    made = replace(recording(LANES, [OVERTAKEN], ego=(60, 0)), side="right")
    scene = seen_from_ego(made, Choice(), "f.xml")
    shorter = find_maneuvers(replace(scene, horizon_s=2.0, step_s=1.0), compile_rulebook("gb"))
    assert [layer.start_s for layer in shorter.graph.layers] == [0, 1, 2]
    emptied = replace(scene, obstacles=())
    with pytest.raises(RulecError, match="R0418"):
        find_maneuvers(emptied, compile_rulebook("gb"))
    assert find_maneuvers(emptied, compile_rulebook("de")).judges


def test_one_who_leaves_the_road_and_comes_back_is_the_same(german):
    """A drive gives it another name then; cells call it by its id."""
    away = {k: (95.0 + 5 * k, 400.0) for k in range(3, 6)}
    comes = vehicle(10, {k: (95.0 + 5 * k, 0.0) for k in range(13)} | away, speed=3.0)
    made = replace(recording(LANES, [comes], ego=(60, 0)), side="right")
    found = find_maneuvers(seen_from_ego(made, Choice(), "f.xml"), german)
    assert check(found, 2)
    assert [*found.paths.objects] == ["10"]


@pytest.mark.parametrize(("start", "heading"), [((200.0, 0.0), 0.0), ((100.0, 8.0), np.pi)])
def test_cells_at_ends_where_vehicles_turn_around_are_of_the_road_that_ends(start, heading, german):
    road = [
        straight(1, 0, 300, 0, predecessors=(4,), successors=(2,)),
        lanelet(
            2,
            [(300, 0), (303, 2), (304, 4), (303, 6), (300, 8)],
            predecessors=(1,),
            successors=(3,),
        ),
        lanelet(3, [(300, 8), (0, 8)], predecessors=(2,), successors=(4,)),
        lanelet(4, [(0, 8), (-3, 6), (-4, 4), (-3, 2), (0, 0)], predecessors=(3,), successors=(1,)),
        lanelet(5, [(40, -6), (40, 2)], types=frozenset({"crosswalk"})),
    ]
    made = recording(road, [], ego=start, heading=heading)
    start_state = replace(made.problems[0].start, speed=3.0)
    made = replace(
        made,
        side="right",
        complete=frozenset({"lanes", "junctions", "crossings"}),
        problems=(replace(made.problems[0], start=start_state),),
    )
    found = find_maneuvers(seen_from_ego(made, Choice(), "f.xml"), german)
    assert check(found, 4)


@pytest.mark.parametrize("kind", ["bus", "car"])
def test_a_format_that_tells_no_school_bus_has_none_for_maneuvers_as_for_drives(kind):
    other = vehicle(10, dict.fromkeys(range(13), (90.0, 4.0)), kind, speed=0.0)
    made = replace(recording(LANES, [other], ego=(60, 0)), side="right")
    found = find_maneuvers(seen_from_ego(made, Choice(), "f.xml"), compile_rulebook("us-ca"))
    untold = {name for one in found.not_judged if one.rule == "school_bus" for name in one.untold}
    assert "school_bus" in untold


@pytest.mark.parametrize(("far_left", "most"), [(30.0, 41.0), (60.0, 60.0)])
def test_distances_to_junctions_between_two_places(far_left, most):
    """Right behind a junction it is as far to the next one as it gets, place or no place.

    Or as far as it is in a lane to which ego may change later.
    """
    lanes = tuple(
        LaneProbe(number, np.arange(5.0), [{"distance_to_junction": metres} for metres in far])
        for number, far in enumerate([(1.0, 0.0, 40.0, 39.0, 38.0), (far_left,) * 5])
    )
    straightened = SimpleNamespace(straight=np.array([-2.0, 2.0, 6.0]))
    probes = SimpleNamespace(
        origin=SimpleNamespace(lanes=straightened),
        lanes=lanes,
        stretches=((0, 0.0, 4.0), (1, 0.0, 4.0)),
    )
    places = PlaceWords(probes, frozenset({"distance_to_junction"}))
    (found,) = places.of_cells(
        SimpleNamespace(s=(np.array([1.0]), np.array([3.0])), d=(np.zeros(1), np.zeros(1)))
    )
    assert found["distance_to_junction"] == Interval(0.0, most)


def test_what_never_changes_is_known_of_all_times_once_it_is_of_one():
    told, untold = ({"two_wheeled": {"a": value}} for value in (False, UNKNOWN))
    probes = SimpleNamespace(timed=[SimpleNamespace(states=[told, untold, {}])])
    scene = SceneWords(probes, frozenset(), no_junction=True, no_crossing=True, straight=True)
    assert scene.constants(frozenset({"two_wheeled", "ego_type"})) == told


def test_nobody_is_there_before_it_is_recorded_nor_too_far_away_to_count(german):
    """What is said of them would be unknown, and every rule about them open."""
    comes = vehicle(10, {k: (80.0 + 5 * k, 4.0) for k in range(3, 13)}, speed=10.0)
    far = vehicle(11, dict.fromkeys(range(13), (285.0, 0.0)), speed=0.0)
    made = replace(recording(LANES, [comes, far], ego=(60, 0)), side="right")
    scene = seen_from_ego(made, Choice(), "f.xml")
    found = find_maneuvers(scene, german, horizon_s=2.0, step_s=1.0)
    # Ego gets to 60 + 36 m at most, and who is 150 m ahead of its front counts
    assert dict(found.words.present) == {"10": (2, 2)}


def test_what_every_drive_is_told_is_told_in_cells(german):
    """A source that says that there are no officers says so of maneuvers, too."""
    made = recording(LANES, ego=(60, 0))
    made = replace(made, side="right", complete=made.complete | {"officer"})
    found = find_maneuvers(seen_from_ego(made, Choice(), "f.xml"), german, horizon_s=1.0)
    states = [state for layer in found.words.states for state in layer]
    assert {state["told_to_stop"] for state in states} == {False}


@st.composite
def scenes(draw):
    """Ego on one of two lanes among up to four vehicles of even speeds."""
    vehicles = []
    for number in range(draw(st.integers(0, 4))):
        y = draw(st.sampled_from([0.0, 4.0])) + draw(st.floats(-0.5, 0.5))
        start, speed = draw(st.floats(20, 160)), draw(st.floats(0, 20))
        places = {k: (start + speed * k / 2, y) for k in range(13)}
        vehicles.append(vehicle(number + 10, places, speed=speed))
    ego = 60.0, draw(st.sampled_from([0.0, 4.0]))
    made = recording(LANES, vehicles, ego=ego)
    (problem,) = made.problems
    start = replace(problem.start, speed=draw(st.floats(0, 20)))
    problem = replace(problem, start=start)
    return seen_from_ego(replace(made, problems=(problem,)), Choice(), "file.xml")


@given(scenes())
@settings(max_examples=12, suppress_health_check=list(HealthCheck))
def test_random_scenes(german, scene):
    try:
        found = find_maneuvers(scene, german, horizon_s=2.0)
    except RulecError:
        assume(False)
    check(found, 2)


def driven_among(
    others, rules, motion, y=4.0, bounds="car", speed=10.0, *, lanes=LANES, aside=0.0, step_s=0.5
):
    """Compare a motion on the left lane, from 2 to 6 m, with its maneuver: the words in cells."""
    made = recording(lanes, others, ego=(60.0, y), step_s=step_s)
    (problem,) = made.problems
    start = replace(problem.start, speed=hypot(speed, aside), heading=atan2(aside, speed))
    scene = seen_from_ego(replace(made, problems=(replace(problem, start=start),)), Choice(), "f")
    horizon_s = step_s * (len(motion) - 1)
    found = find_maneuvers(scene, rules, horizon_s=horizon_s, step_s=step_s, bounds=bounds)
    path = paths_of(found.graph, motion)
    nodes = tuple(next(iter(cells)) for cells in path)
    assert compared(found, [(nodes, np.array(motion))]) == 1
    return [found.paths.states[p][node] for p, node in enumerate(nodes)]


def test_who_reaches_into_the_lane_of_a_wide_vehicle_is_in_its_way(german):
    # 2.4 m wide at y = 1, 0.2 m beyond the mark; ego, 2.5 m, drifts from y = 3.2 to 2.8 m
    wide = vehicle(10, {k: (20.0 + 5 * k, 1.0) for k in range(13)}, speed=10.0, width=2.4)
    motion = [(0.0, 10.0, -0.8, 0.0), (5.0, 10.0, -1.0, -0.8), (10.0, 10.0, -1.2, 0.0)]
    states = driven_among([wide], german, motion, 3.2, "bus")
    assert [state["lateral"]["10"] == "left_of" for state in states[1:]] == [False, False]


def test_who_comes_into_a_lane_is_behind_a_cycle_at_its_other_edge(german):
    # Ego's middle gets to y = 1.8 in the lane from -2 to 2 m, in which the cycle keeps to y = -1.6
    rider = vehicle(
        10, {k: (90.0 + 2 * k, -1.6) for k in range(13)}, "bicycle", 1.8, 0.6, speed=4.0
    )
    motion = [(0.0, 10.0, -1.2, 0.0), (5.0, 10.0, -1.45, -1.0), (10.0, 10.0, -2.2, -2.0)]
    states = driven_among([rider], german, motion, 2.8)
    assert [state["precedes"]["10"] for state in states] == [False, False, UNKNOWN]


def test_who_has_come_to_be_in_the_way_in_doubt_is_so_until_that_is_sure(german):
    # A car's left side is over the mark at y = 2 by 2 cm, less than places are known to, and then
    # before it. Ego, 2.5 m wide, has its right side there, and goes on into the car's lane
    over = {k: (90.0 + 5 * k, y) for k, y in enumerate([0.5, 1.02, 0.975, *[0.9] * 10])}
    other = vehicle(10, over, speed=10.0, width=2.0)
    across = [
        (-0.4, -1.0),
        (-1.1, -1.8),
        (-1.775, -0.9),
        (-2.225, -0.9),
        (-2.675, -0.9),
        (-2.9, 0.0),
    ]
    motion = [(5.0 * k, 10.0, *own) for k, own in enumerate(across)]
    states = driven_among([other], german, motion, 3.6, "bus", aside=-1.0)
    assert "same_lane" in states[2]["lateral"]["10"].values


def test_a_side_for_a_moment_is_that_before_and_after(german):
    # Ego gets over the mark at y = 2 in the third state, and the other one 0.1 s later behind it:
    # for a fifth of a second it would be left of it, and is in its lane before and after
    comes = {k: (75.0 + k, 0.75 + 0.1 * k) for k in range(41)}
    comes = vehicle(10, comes, speed=10.0)
    motion = [(k * 1.0, 10.0, 1.76 + 0.16 * k, 1.6) for k in range(6)]
    states = driven_among([comes], german, motion, 1.76, aside=1.6, step_s=0.1)
    assert states[2]["lateral"]["10"] == OneOf(frozenset({"same_lane", "left_of"}))


@pytest.mark.parametrize("gained", [8.0, -9.0])
def test_speeds_are_means_over_two_steps_that_are_longer_than_half_a_second(german, gained):
    """With a state every second they are from one second before to one after."""
    speeds = [10.0, 10.0 + gained, 10.0 + gained]
    motion = [(0.0, speeds[0], 0.0, 0.0), (10.0 + gained / 2, speeds[1], 0.0, 0.0)]
    motion.append((motion[1][0] + speeds[2], speeds[2], 0.0, 0.0))
    ahead = vehicle(10, {k: (160.0 + 20 * k, 4.0) for k in range(6)}, speed=20.0)
    states = driven_among([ahead], german, motion, step_s=1.0)
    # The first state has the mean over the second after it
    assert states[0]["speed"].low <= 3.6 * (10.0 + gained / 2) <= states[0]["speed"].high


def corner(metres):
    """Lanes round a corner that begins at x = 84, and places so far (m) outside its middle."""
    angles = np.array([0.0, np.pi / 4, np.pi / 2])
    lanes = (
        straight(1, 0, 84, successors=[2]),
        lanelet(2, around(12.0, angles), predecessors=[1], successors=[3]),
        lanelet(3, [(96, 12), (96, 200)], predecessors=[2]),
    )
    angles = np.linspace(0.2, 1.4, 5)
    return lanes, zip(angles.tolist(), around(12.0 + metres, angles), strict=True)


def around(radius, angles):
    return [(84 + radius * np.sin(one), 12 - radius * np.cos(one)) for one in angles]


def test_a_middle_that_leads_back_for_a_hand_leads_nobody_back(german):
    """As in USA_Peach-3_1: one beside the kink was as far along the road as its end."""
    lanes = (
        straight(1, 0, 84, successors=[2]),
        lanelet(2, [(84, 0.0), (83.85, 0.01), (88, 0.25)], predecessors=[1], successors=[3]),
        straight(3, 88, 300, y=0.25, predecessors=[2]),
    )
    ahead = vehicle(10, {k: (84.0 + k, -2.5) for k in range(13)}, speed=2.0)
    motion = [(5.0 * k, 10.0, 0.0, 0.0) for k in range(3)]
    states = driven_among([ahead], german, motion, 0.0, lanes=lanes)
    # Its rear is at 82 m, ego's front at 62.25 m
    assert states[0]["gap"]["10"].low <= 19.75 <= states[0]["gap"]["10"].high


def test_lines_cut_corners_each_in_its_own_way(german):
    """How far ego is from who stands beside a bend is not told more exactly than drives differ."""
    lanes, places = corner(3.2)
    riders = [
        vehicle(n, dict.fromkeys(range(13), place), "bicycle", 1.8, 0.6, heading=turned)
        for n, (turned, place) in enumerate(places, 10)
    ]
    motion = [(3.0 * k, 6.0, 0.0, 0.0) for k in range(5)]
    driven_among(riders, german, motion, 0.0, speed=6.0, lanes=lanes)


@pytest.mark.parametrize(("count", "said"), [(2, True), (3, UNKNOWN)])
def test_a_jam_is_on_half_of_the_lanes(german, count, said):
    """Ego stands behind four in its lane, and nobody is on the others."""
    lanes = (
        straight(
            k, 0, 300, y=4.0 * k - 4, right_of=k - 1 or None, left_of=k + 1 if k < count else None
        )
        for k in range(1, count + 1)
    )
    queue = [vehicle(n, dict.fromkeys(range(13), (7.0 * n, 0.0))) for n in range(10, 14)]
    motion = [(0.0, 0.0, 0.0, 0.0)] * 3
    states = driven_among(queue, german, motion, 0.0, speed=0.0, lanes=tuple(lanes))
    assert states[0]["congested"] is said


def test_what_is_shorter_than_places_are_apart_is_asked_for(german):
    """After 0.5 s ego is on 0.5 m of carriageway between two junctions."""
    inside, ends = {"types": frozenset({"intersection"})}, [0, 61, 65.2, 65.7, 90, 300]
    lanes = tuple(
        straight(k, *own, successors=[k + 1], predecessors=[k - 1], **({} if k % 2 else inside))
        for k, own in enumerate(pairwise(ends), 1)
    )
    motion = [(5.45 * k, 10.9, 0.0, 0.0) for k in range(3)]
    states = driven_among([], german, motion, 0.0, speed=10.9, lanes=lanes)
    assert "carriageway" in states[1]["surface"].values


def frame_of(lanes, rules):
    """The road of a scene on lanes, ego at x = 60."""
    made = replace(recording(lanes, ego=(60.0, 0.0)), side="right")
    graph = find_maneuvers(seen_from_ego(made, Choice(), "f"), rules, horizon_s=1.0).graph
    origin = graph.scenario.account.origin
    return RoadFrame(probe_drives(graph, origin, rules, "right", frozenset()), half_m=2.0)


def test_where_a_lane_has_ended_those_of_the_other_direction_may_lie(german):
    lanes = (
        straight(1, 0, 100, left_of=2, successors=[3]),
        straight(2, 0, 100, y=4, right_of=1),
        straight(3, 100, 300, predecessors=[1]),
    )
    frame = frame_of(lanes, german)
    ends = np.array([20.0, 20.0]), np.array([35.0, 60.0])
    sides = np.array([-1.0, -1.0]), np.array([1.0, 1.0])
    # Its left side at y = 1 m is 5 m from the left bound of two lanes, and 1 m from that of one
    assert frame.gap_to_oncoming_lanes(ends, sides).tolist() == [5.0, 1.0]


def test_where_a_road_bends_the_middle_of_a_body_is_beside_its_place(german):
    """Ends 2 m from the middle are 2² / 2 / 12 m aside on a circle of 12 m, from s = 24 m on."""
    lanes = (
        straight(1, 0, 84, successors=[2]),
        lanelet(2, around(12.0, np.linspace(0.0, np.pi / 2, 40)), predecessors=[1], successors=[3]),
        lanelet(3, [(96, 12), (96, 200)], predecessors=[2]),
    )
    ends = np.array([0.0, 30.0, 0.0]), np.array([10.0, 36.0, 36.0])
    straight_on, bends, both = frame_of(lanes, german).bent(ends)
    assert straight_on == pytest.approx(0.0, abs=1e-6)
    assert 4 / 24 <= bends <= both <= 2 * 4 / 24


def test_beyond_a_split_somebody_is_in_any_of_its_lanes(german):
    lanes = (
        straight(1, 0, 100, successors=[2, 3]),
        straight(2, 100, 300, left_of=3, predecessors=[1]),
        straight(3, 100, 300, y=4, right_of=2, predecessors=[1]),
    )
    ahead = vehicle(10, {k: (130.0 + 5 * k, 0.0) for k in range(13)}, speed=10.0)
    motion = [(5.0 * k, 10.0, 0.0, 0.0) for k in range(3)]
    states = driven_among([ahead], german, motion, 0.0, lanes=lanes)
    assert states[0]["lateral"]["10"] is UNKNOWN or "same_lane" in states[0]["lateral"]["10"].values


ACROSS = [(0.0, 0.0), (0.225, 0.9), (0.9, 1.8), (1.8, 1.8), (2.7, 1.8), (3.375, 0.9), (3.6, 0.0)]
"""Places and speeds (m, m/s) across the road, every 0.5 s, of who changes lanes to the left."""


@pytest.mark.parametrize(("split_m", "y"), [(50, 2.0), (70, 0.0)])
def test_somebody_before_a_split_is_behind_any_of_its_lanes(german, split_m, y):
    """Ego changes to the left one, before the split or beyond: it is that of the one behind."""
    lanes = (
        straight(1, 0, split_m, y=y, successors=[2, 3]),
        straight(2, split_m, 300, left_of=3, predecessors=[1]),
        straight(3, split_m, 300, y=4, right_of=2, predecessors=[1]),
    )
    behind = vehicle(10, {k: (20.0 + k, y) for k in range(25)}, speed=2.0)
    motion = [(5.0 * k, 10.0, *own) for k, own in enumerate(ACROSS)]
    states = driven_among([behind], german, motion, 0.0, lanes=lanes)
    assert states[-1]["lateral"]["10"] is UNKNOWN


def test_of_who_is_behind_where_the_next_lane_comes_from_elsewhere_nothing_is_said(german):
    lanes = (
        straight(1, 0, 50, successors=[2]),
        lanelet(4, [(0, 40), (50, 4)], successors=[3]),
        straight(2, 50, 300, left_of=3, predecessors=[1]),
        straight(3, 50, 300, y=4, right_of=2, predecessors=[4]),
    )
    behind = vehicle(10, {k: (20.0 + k, 0.0) for k in range(25)}, speed=2.0)
    motion = [(5.0 * k, 10.0, *own) for k, own in enumerate(ACROSS)]
    states = driven_among([behind], german, motion, 0.0, lanes=lanes)
    assert {state["lateral"]["10"] for state in states} == {UNKNOWN}


def test_who_is_beside_the_road_of_the_next_lane_alone_is_there(german):
    lanes = (
        straight(1, 0, 50, successors=[2]),
        lanelet(4, [(20, 60), (50, 4)], successors=[3]),
        straight(2, 50, 300, left_of=3, predecessors=[1]),
        straight(3, 50, 300, y=4, right_of=2, predecessors=[4]),
    )
    places = {k: (44.0 + 0.236 * k, 15.2 - 0.441 * k) for k in range(25)}
    comes = vehicle(10, places, speed=1.0, heading=atan2(-56, 30))
    motion = [(5.0 * k, 10.0, *own) for k, own in enumerate(ACROSS)]
    states = driven_among([comes], german, motion, 0.0, lanes=lanes)
    assert [states[0][name]["10"] for name in ("lateral", "gap")] == [UNKNOWN, UNKNOWN]
    assert states[0]["oncoming"]["10"] is False


def test_a_junction_of_the_next_lane_is_that_of_who_goes_on_there(german):
    crosses = {"types": frozenset({"intersection"})}
    lanes = (
        straight(1, 0, 80, left_of=4, successors=[2]),
        straight(2, 80, 90, left_of=5, successors=[3], predecessors=[1]),
        straight(3, 90, 300, left_of=6, predecessors=[2]),
        straight(4, 0, 80, y=4, right_of=1, successors=[5]),
        straight(5, 80, 90, y=4, right_of=2, successors=[6], predecessors=[4], **crosses),
        straight(6, 90, 300, y=4, right_of=3, predecessors=[5]),
    )
    motion = [(5.0 * k, 10.0, *own) for k, own in enumerate([(0.0, 0.0)] * 4 + ACROSS)]
    states = driven_among([], german, motion, 0.0, lanes=lanes)
    # Ego's front is at 82.25 m then
    assert states[4]["enters_junction"] is UNKNOWN


@pytest.mark.parametrize(("onward", "said"), [((), False), ((3,), UNKNOWN)])
def test_who_changes_to_a_lane_that_leaves_the_road_is_on_another_one(german, onward, said):
    lanes = (
        straight(1, 0, 150, left_of=2, successors=[4]),
        straight(2, 0, 150, y=4, right_of=1, successors=onward),
        lanelet(3, [(150, 4), (300, 60)], predecessors=[2]),
        straight(4, 150, 300, predecessors=[1]),
    )
    ahead = vehicle(10, dict.fromkeys(range(13), (120.0, 0.0)))
    motion = [(5.0 * k, 10.0, 0.0, 0.0) for k in range(7)]
    states = driven_among([ahead], german, motion, 0.0, lanes=lanes)
    assert states[0]["leads_elsewhere"]["10"] is said


def test_who_passes_a_cycle_may_overtake(german):
    rider = vehicle(10, {k: (62.0 + 2 * k, 0.0) for k in range(13)}, "bicycle", 1.8, 0.6, speed=4.0)
    motion = [(5.0 * k, 10.0, 0.0, 0.0) for k in range(5)]
    states = driven_among([rider], german, motion)
    assert states[0]["overtaking"] is not False


@pytest.mark.skipif(not FILES, reason="CommonRoad's scenarios are not here")
@pytest.mark.parametrize(
    ("book", "file", "most"),
    [
        *(("de", file, 2) for file in FILES[:2]),
        *(("gb", file, 2) for file in FILES[:2]),
        *(pytest.param("de", file, 12, marks=pytest.mark.long) for file in FILES),
        *(pytest.param("gb", file, 12, marks=pytest.mark.long) for file in FILES),
    ]
    or [("", "", 0)],
    ids=lambda item: getattr(item, "stem", None),
)
def test_recordings(book, file, most):
    check(find_maneuvers(file, compile_rulebook(book)), most)


@pytest.mark.parametrize("beside", [-0.03, -1e-4, 0.0, 1e-4, 0.04])
def test_motions_that_begin_where_cells_meet(german, beside):
    """Ego begins on the mark at y = 2 m, or by it, behind one in either lane."""
    ahead = vehicle(10, {k: (95.0 + 3 * k, 0.0) for k in range(13)}, speed=6.0)
    left = vehicle(11, {k: (85.0 + 6 * k, 4.0) for k in range(13)}, speed=12.0)
    made = replace(recording(LANES, [ahead, left], ego=(60.0, 2.0 + beside)), side="right")
    (problem,) = made.problems
    problem = replace(problem, start=replace(problem.start, speed=10.0))
    scene = seen_from_ego(replace(made, problems=(problem,)), Choice(), "file.xml")
    found = find_maneuvers(scene, german, horizon_s=2.0)
    assert begins_on_an_edge(found)
    assert check_on_edges(found, 60, random.Random(7)) > 20


@pytest.mark.long
@pytest.mark.skipif(not FILES, reason="CommonRoad's scenarios are not here")
@pytest.mark.parametrize("file", FILES or [""], ids=lambda file: getattr(file, "stem", ""))
def test_random_motions_in_recordings(german, file):
    found = find_maneuvers(file, german)
    step_s, _ = states_of(found)
    of_layer = found.graph.step_s / step_s
    if abs(of_layer - round(of_layer)) > 1e-9:
        # Layers begin where the recording has states, and the bounds in the rules fit them.
        every = next(k for k in range(floor(of_layer), 0, -1) if round(1 / step_s) % k == 0)
        found = find_maneuvers(file, german, step_s=step_s * every)
    number = check_sampled(found, MOTIONS, random.Random(file.stem))
    if begins_on_an_edge(found):
        # US101-11_4: ego begins 3 cm from where it would be clear of one in the next lane
        number += check_on_edges(found, MOTIONS // 10, random.Random(file.stem))
    assert number > 0 or found.traces == 1 or file.stem in NARROW


@pytest.mark.parametrize(
    ("examples", "motions"), [(8, 25), pytest.param(400, 200, marks=pytest.mark.long)]
)
def test_random_motions_in_random_scenes(german, examples, motions):
    number = 0

    @given(scenes(), st.integers(0, 10**6))
    @settings(max_examples=examples, suppress_health_check=list(HealthCheck))
    def in_a_scene(scene, seed):
        nonlocal number
        try:
            found = find_maneuvers(scene, german, horizon_s=2.0)
        except RulecError:
            assume(False)
        number += check_sampled(found, motions, random.Random(seed), words=True)

    in_a_scene()
    assert number > 5 * examples
