"""Penalties, places, the guard, the reward and margins of candidates, and what is refused."""

from dataclasses import replace

import numpy as np
import pytest

import rulec
from rulec.api.rulebook_compilation import machines
from rulec.diagnostics import RulecError
from rulec.extraction.tracks import tracks
from rulec.extraction.tracks.matching import lanelet_graph
from rulec.monitoring.verdict import OpenVerdict, RuleNotJudged, Violation
from rulec.scoring.rescoring import verdicts_of
from rulec.scoring.score import score
from rulec.scoring.scores import CandidateScore, Scores
from rulec.scoring.traffic_world import TrafficWorld
from support.builders.scored_worlds import STEP_S, along, car, street

GERMAN = machines("de")


def candidate(number, *violated, maybe=(), off_road=0):
    return CandidateScore(
        number,
        violations=tuple(Violation(rule, "hard", {}, 0) for rule in violated),
        open=tuple(OpenVerdict(rule, "hard", {}, ("not told",)) for rule in maybe),
        not_judged=(),
        off_road=off_road,
        why="",
        drives=(),
    )


def scores(*candidates):
    paths = np.zeros((len(candidates), 3, 4))
    paths[:, :, 0] = np.arange(len(candidates))[:, None] ** 2
    return Scores(GERMAN, candidates, (), paths, 1)


# Levels of the German book: red_light emergency > speed_limit, following_distance gaps >
# keep_near_side courtesy
ORDERED = scores(
    candidate(0, "speed_limit"),
    candidate(1, "red_light"),
    candidate(2),
    candidate(3, "speed_limit", "following_distance", "keep_near_side"),
    candidate(4, maybe=["speed_limit"]),
    candidate(5, off_road=2),
    candidate(6, "speed_limit"),
    candidate(7, "red_light", off_road=1),
)


def test_printed_scores_say_in_a_line_what_was_not_judged():
    assert repr(ORDERED) == "Scores(de: 1 of 8 allowed)"
    wanting = {"a": ("wet", "lane_kind"), "b": ("lane_kind",), "c": ("lamps",), "d": ("fog",)}
    untold = [RuleNotJudged(rule, "hard", words) for rule, words in wanting.items()]
    faulty = RuleNotJudged("e", "soft", (), why="it is too large")
    one = replace(candidate(0), not_judged=(*untold[:2], faulty))
    other = replace(candidate(1), not_judged=tuple(untold[1:]))
    n_rules = len(GERMAN.rules)
    assert repr(scores(one, other)) == (
        f"Scores(de: 2 of 2 allowed; 5 of {n_rules} rules not judged for lack of "
        "lane_kind (2), fog (1), lamps (1), and 1 more)"
    )
    (silent,) = scores(replace(candidate(0), not_judged=(faulty,))).candidates
    assert repr(scores(silent)) == f"Scores(de: 1 of 1 allowed; 1 of {n_rules} rules not judged)"


def test_the_order_of_candidates():
    # What is open counts as violated, and comes before what is
    assert ORDERED.places.tolist() == [3, 5, 1, 4, 2, 7, 3, 6]
    assert ORDERED.best == 2
    assert [row["place"] for row in ORDERED.rows()] == ORDERED.places.tolist()


def test_penalties_by_rank():
    levels = [rank.levels for rank in ORDERED.ranks if rank.strength == "hard"]
    emergency, gaps = (
        next(k for k, own in enumerate(levels) if name in own) for name in ("emergency", "gaps")
    )
    assert ORDERED.penalties[:, emergency].tolist() == [0, 1, 0, 0, 0, 0, 0, 1]
    assert ORDERED.penalties[:, gaps].tolist() == [1, 0, 0, 2, 0, 0, 1, 0]
    assert ORDERED.penalties_at_most[:, gaps].tolist() == [1, 0, 0, 2, 1, 0, 1, 0]


def test_the_reward_goes_with_the_order():
    rewards = ORDERED.reward(worth=100.0)
    by_place = rewards[np.argsort(ORDERED.places, kind="stable")]
    assert (np.diff(by_place) <= 0).all()
    assert rewards[2] == 0
    assert rewards[1] < rewards[3] < rewards[0] == rewards[4]
    assert rewards[5] == 2 * (rewards[7] - rewards[1])


def test_the_guard():
    assert np.flatnonzero(ORDERED.allowed).tolist() == [2]
    assert np.flatnonzero(ORDERED.perhaps_allowed).tolist() == [2, 4]
    assert {ORDERED.nearest_allowed(number) for number in range(8)} == {2}
    assert scores(candidate(0, "red_light")).nearest_allowed(0) is None
    # At 0, 1, 4 and 9 m
    some = scores(candidate(0), candidate(1, "red_light"), candidate(2, "red_light"), candidate(3))
    assert [some.nearest_allowed(number) for number in range(4)] == [0, 0, 0, 3]


def steady(speed, start, count=8):
    x = start[0] + speed * STEP_S * np.arange(1, count + 1)
    return along(np.column_stack((x, 0 * x)), start)


def test_margins_are_in_units():
    # Cars are 4.5 m long. At time 0 ego is at -18 m, and the other one, as fast, stays 30 m ahead
    world = street([car("ahead", 12.0, x=12.0)], speed=12.0)
    futures = [steady(12.0, world.past[-1]), steady(18.0, world.past[-1])]
    found = score(np.array(futures), world, GERMAN, world.past)
    kept = {one.rule: one for one in found.margins(0)}
    assert not kept["speed_limit"].violated
    assert kept["speed_limit"].margin.unit == "km/h"
    assert kept["speed_limit"].margin.by == pytest.approx(50 - 43.2, abs=0.01)
    assert kept["following_distance"].margin.value == pytest.approx(30 - 4.5, abs=0.01)
    over = [one for one in found.margins(1) if one.rule == "speed_limit" and one.violated]
    assert min(one.margin.by for one in over) > 0
    assert {one.state for one in over} == {
        one.step for one in found.candidates[1].violations if one.rule == "speed_limit"
    }


def speeding(speeds, start):
    """A future with these speeds (m/s), one a state."""
    x = start[0] + STEP_S * np.cumsum(speeds)
    return np.column_stack((x, 0 * x, 0 * x, speeds))


def test_margins_after_a_past_that_was_too_fast():
    world = street([car("ahead", 18.0, x=300.0)], speed=18.0)
    steps = np.arange(1, 17)
    too_fast, slower = np.maximum(18.0 - steps, 14.5), np.maximum(18.0 - 2 * steps, 13.0)
    again = np.where(steps > 10, 25.0, slower)
    future = [speeding(own, world.past[-1]) for own in (too_fast, slower, again)]
    found = score(np.array(future), world, GERMAN, world.past)
    assert [violation.rule for violation in found.violated_before] == ["speed_limit"]
    told = [[x for x in found.margins(n) if x.rule == "speed_limit"] for n in range(3)]
    by_speed = [next(x for x in own if x.margin.text == "speed") for own in told]
    # As fast until half of its states are over, and then judged anew
    assert (by_speed[0].violated, by_speed[0].state) == (True, 8)
    assert by_speed[0].margin.value == pytest.approx(14.5 * 3.6, abs=0.1)
    # It ends what the past did: from then on it keeps the limit by so much
    assert not by_speed[1].violated
    assert 2 <= by_speed[1].state < 16
    assert by_speed[1].margin.value < 50
    # Speeds are means around a state
    assert by_speed[2].violated
    assert by_speed[2].state in (9, 10)
    assert by_speed[2].margin.value > 60


@pytest.mark.parametrize(
    ("kind", "limit_kmh", "kmh"),
    [("urban", 70, 55), ("urban", 30, 20), ("country", 120, 90), ("country", 70, 45)],
)
def test_the_margin_of_a_kept_limit_is_to_the_one_that_applies(kind, limit_kmh, kmh):
    lane = rulec.build_lanelet("l", [(-200, 0), (800, 0)], types=[kind], limit_mps=limit_kmh / 3.6)
    t, speed = STEP_S * np.arange(7), kmh / 3.6
    ego = rulec.build_participant("ego", "car", t, speed * t, 0 * t, step_s=STEP_S)
    world = TrafficWorld(rulec.build_recording([lane], [ego], step_s=STEP_S, side="right"), "ego")
    found = score(steady(speed, world.past[-1])[None], world, GERMAN, world.past)
    (own,) = [one for one in found.margins(0) if one.rule == "speed_limit"]
    assert (own.margin.text, own.margin.against) == ("speed", "limit")
    assert own.margin.limit - own.margin.value == pytest.approx(limit_kmh - kmh, abs=0.01)


def test_what_does_not_count_in_a_state_has_no_margin():
    """Nobody is red, no line and no crossing is there, and no sign stands in the way of a limit."""
    world = street([], speed=22.0)
    found = score(steady(22.0, world.past[-1])[None], world, GERMAN, world.past)
    told = {(one.rule, one.margin.text) for one in found.margins(0)}
    assert ("speed_limit", "speed") in told
    assert not {"limit", "ego_mass", "distance_to_crossing"} & {text for _, text in told}
    assert "red_light" not in {rule for rule, _ in told}


def test_a_margin_is_of_the_state_that_it_names():
    # It rolls over the line of a stop sign: too fast before, and never slow enough
    lanes = stop_sign_lanes()
    t = 0.1 * np.arange(21)
    ego = rulec.build_participant("ego", "car", t, 44 + 8 * t, 0 * t, step_s=0.1)
    world = TrafficWorld(rulec.build_recording(lanes, [ego], step_s=0.1, side="right"), "ego")
    ahead = 0.1 * np.arange(1, 121)
    slows = np.minimum(ahead, 5)
    x = 60 + 8 * slows - slows**2 / 2 + 3 * (ahead - slows)
    speeds = np.maximum(8 - ahead, 3)
    future = np.column_stack((x, 0 * x, 0 * x, speeds))
    found = score(future[None], world, GERMAN, world.past)
    own = [one for one in found.margins(0) if one.rule == "stop_sign" and one.violated]
    assert own
    for one in own:
        assert one.margin.value == pytest.approx(3.6 * speeds[one.state], abs=0.4)


def stop_sign_lanes():
    def lane(name, *points, **more):
        return rulec.build_lanelet(name, points, types=["urban"], limit_mps=50 / 3.6, **more)

    line = [(100, 1.75), (100, -1.75)]
    inside = {"junction": "J"}
    return [
        lane("in", (-300, 0), (100, 0), signs=["STOP"], stop_line=line, successors=["j"]),
        lane("j", (100, 0), (120, 0), successors=["out"], foes=["cj"], **inside),
        lane("out", (120, 0), (400, 0)),
        lane("ci", (110, -200), (110, -10), successors=["cj"]),
        lane("cj", (110, -10), (110, 10), successors=["co"], foes=["j"], **inside),
        lane("co", (110, 10), (110, 200)),
    ]


@pytest.mark.parametrize("past_mps", [17.0, 12.0])
@pytest.mark.parametrize(
    ("peak_mps", "outcome"), [(13.95, "open"), (16.0, "violated"), (12.0, "kept")]
)
def test_a_past_that_was_too_fast_hides_nothing_that_comes_later(past_mps, peak_mps, outcome):
    """It slows to 43 km/h, which ends what the past did, and then gains speed once more."""
    lane = rulec.build_lanelet("l", [(-400, 0), (900, 0)], types=["urban"], limit_mps=50 / 3.6)
    t = 0.1 * np.arange(41)
    ego = rulec.build_participant("ego", "car", t, past_mps * t, 0 * t, step_s=0.1)
    world = TrafficWorld(rulec.build_recording([lane], [ego], step_s=0.1, side="right"), "ego")
    ahead = 0.1 * np.arange(1, 161)
    knots, speeds = [0, 2, 4, 5, 7.5, 8.5, 16], [past_mps, 12, 12, peak_mps, peak_mps, 12, 12]
    own = np.interp(ahead, knots, speeds)
    x = world.past[-1, 0] + np.cumsum(own * 0.1)
    found = score(np.column_stack((x, 0 * x, 0 * x, own))[None], world, GERMAN, world.past)
    assert ("speed_limit" in {one.rule for one in found.violated_before}) == (past_mps > 14)
    assert found.outcomes("speed_limit") == [outcome]


def test_the_nearest_allowed_of_equals_is_itself():
    equal = Scores(GERMAN, [candidate(k) for k in range(3)], (), np.zeros((3, 2, 4)), 1)
    assert [equal.nearest_allowed(number) for number in range(3)] == [0, 1, 2]


def test_a_candidate_that_leaps_does_not_take_all_memory():
    bend = 150 * np.array([(np.sin(a), 1 - np.cos(a)) for a in np.linspace(0, 2.6, 120)])
    lane = rulec.build_lanelet("bend", bend, types=["urban"], limit_mps=50 / 3.6)
    t = STEP_S * np.arange(4)
    a = 5 * t / 150
    places = 150 * np.sin(a), 150 * (1 - np.cos(a))
    ego = rulec.build_participant("ego", "car", t, *places, step_s=STEP_S, heading=a)
    world = TrafficWorld(rulec.build_recording([lane], [ego], step_s=STEP_S, side="right"), "ego")
    future = along([(10.0, 0.35), (12.5, 0.55), (1e7, 0.8)], world.past[-1])
    (row,) = score(future[None], world, GERMAN, world.past).rows()
    assert row["off_road"]


@pytest.mark.parametrize(
    "candidates",
    [
        [[0, 0, 0, 1]],
        np.zeros((2, 3, 5)),
        np.zeros((0, 3, 4)),
        [[[0, 0, 0, np.nan]]],
        [[[0, 0, 0, 1e300]]],
        "none",
        [[[0, 0, 0, 1]], [[0, 0]]],
        [[["0", "0", "0", "1"]]],
        np.zeros((1, 3, 4), dtype=complex),
        np.ma.masked_array(np.zeros((1, 3, 4)), mask=np.eye(3, 4)),
    ],
)
def test_arrays_that_make_no_sense(candidates):
    with pytest.raises(RulecError) as caught:
        score(candidates, street(), GERMAN)
    assert [found.code for found in caught.value.diagnostics] == ["R0780"]


@pytest.mark.parametrize(
    ("candidates", "way_out"),
    [
        ([[0, 0, 0, 1]], "put a single candidate into a list: `[candidate]`"),
        (np.zeros((0, 3, 4)), "give at least one candidate"),
        (np.zeros((2, 3, 5)), "give x, y, heading, speed of each state, and at least one state"),
        ([[[0, 0, 0, np.nan]]], "leave out candidates that have no place in some state"),
        ("none", "give lists of numbers of equal length, or `numpy.array("),
    ],
)
def test_the_way_out_of_arrays_that_make_no_sense(candidates, way_out):
    with pytest.raises(RulecError) as caught:
        score(candidates, street(), GERMAN)
    assert caught.value.diagnostics[0].help.startswith(way_out)


@pytest.mark.parametrize("number", [-1, 2])
def test_a_candidate_that_there_is_not(number):
    world = street()
    scores = score(np.array([steady(5.0, world.past[-1])] * 2), world, GERMAN)
    for ask in (scores.nearest_allowed, scores.margins):
        with pytest.raises(IndexError, match=f"numbered from 0 to 1, not {number}"):
            ask(number)
        with pytest.raises(TypeError, match="`number` is a whole number"):
            ask(1.0)


def test_a_past_that_makes_no_sense():
    world = street()
    with pytest.raises(RulecError, match="R0780"):
        score(steady(5.0, world.past[-1])[None], world, GERMAN, [[1, 2, 3]])


@pytest.mark.parametrize("nothing", [street().past[:0], [], np.empty((0, 4))])
def test_a_past_without_states_is_none(nothing):
    world = street()
    candidates = np.array([steady(5.0, world.past[-1]), steady(30.0, world.past[-1])])
    without, found = score(candidates, world, GERMAN), score(candidates, world, GERMAN, nothing)
    assert [one.violations for one in found.candidates] == [
        one.violations for one in without.candidates
    ]
    assert without.candidates[1].violations


def test_a_single_state_takes_a_past_to_be_judged():
    world = street()
    future = steady(10.0, world.past[-1], count=1)
    for after in (None, world.past[:0]):
        with pytest.raises(RulecError, match=r"single state without a past.*R0780"):
            score(future[None], world, GERMAN, after)
    (found,) = score(future[None], world, GERMAN, world.past[-1:]).candidates
    assert (found.off_road, found.why) == (0, "")
    (found,) = score(steady(10.0, world.past[-1], count=2)[None], world, GERMAN).candidates
    assert (found.off_road, found.why) == (0, "")


@pytest.mark.parametrize("bad", [np.empty((0, 3)), np.empty((0, 2, 4)), [[1, 2, 3, 4], [5]]])
def test_a_past_without_states_has_the_columns(bad):
    with pytest.raises(RulecError, match="R0780"):
        score(steady(5.0, street().past[-1])[None], street(), GERMAN, bad)


def test_an_ego_that_is_not_there():
    recording = street().recording
    for ego in ("eggo", ""):
        with pytest.raises(RulecError, match="R0612"):
            TrafficWorld(recording, ego)


@pytest.mark.parametrize("now_s", [-1.0, 12.0, 1e12])
def test_a_present_at_which_nobody_is_recorded(now_s):
    # Of the street's two vehicles one is there from 0 s to 11.5 s
    recording = street([car("slow", 6.0, x=30.0)]).recording
    with pytest.raises(RulecError, match=r"nobody is recorded.*R0612"):
        TrafficWorld(recording, "ego", now_s)


def test_a_present_just_before_ego_is_there():
    world = TrafficWorld(street().recording, "ego", -STEP_S)
    assert (world.now, len(world.past)) == (-1, 0)


def test_questions_that_make_no_sense():
    world = street()
    found = score(steady(5.0, world.past[-1])[None], world, GERMAN)
    with pytest.raises(ValueError, match="has no rule `speed_limits`; did you mean `speed_limit`"):
        found.outcomes("speed_limits")
    with pytest.raises(TypeError, match="`worth` is a number, not NoneType"):
        found.reward(worth=None)
    for worth in (0.0, -1.0, 1e300):
        with pytest.raises(ValueError, match="worth"):
            found.reward(worth)


@pytest.mark.parametrize("step_s", [0.1, 0.2])
@pytest.mark.parametrize("y", [0.0, 40.0])
def test_rules_compiled_for_another_step_are_refused(step_s, y):
    within = "always (speed > 3 m/s implies eventually[<= 1 s] speed > 5 m/s)"
    book = rulec.parse_rulebook(f"rulebook b use road hard rule r {{ require {within} }}")
    world, other = street(), rulec.compile_rulebook(book, step_s=step_s)
    future = steady(10.0, world.past[-1]) + np.array([0.0, y, 0.0, 0.0])
    for after in (None, world.past):
        assert score(future[None], world, rulec.compile_rulebook(book), after).candidates
        with pytest.raises(RulecError) as caught:
            score(future[None], world, other, after)
        assert [found.code for found in caught.value.diagnostics] == ["R0507"]
    # A recording's drives still say so one by one
    (drive,) = rulec.verify_recording(world.recording, other)
    assert drive.answer.error.diagnostics[0].code == "R0507"


def test_who_is_on_no_lane_is_not_judged():
    world = street()
    far = along([(5.0 * k, 40.0) for k in range(8)], world.past[-1])
    (found,) = score(far[None], world, GERMAN).candidates
    assert (found.off_road, found.satisfied) == (8, None)
    assert found.why
    assert not found.violations


def test_each_past_is_judged_by_itself_though_the_last_one_is_remembered():
    def before(world, speed):
        times = np.arange(-19, 1) * STEP_S
        past = np.column_stack((speed * times, 0 * times, 0 * times, 0 * times + speed))
        future = past[:4] + np.array([speed * 20 * STEP_S, 0, 0, 0])
        return score([future], world, GERMAN, past).violated_before

    world = street()
    found = [before(world, speed) for speed in (10.0, 10.0, 30.0, 10.0)]
    assert [len(own) > 0 for own in found] == [False, False, True, False]
    assert found == [before(street(), speed) for speed in (10.0, 10.0, 30.0, 10.0)]


def test_what_is_known_of_a_world_is_not_found_again(monkeypatch):
    world = street([car("ahead", 12.0, x=12.0)])
    future = steady(10.0, world.past[-1])[None]
    before = score(future, world, GERMAN).rows()

    def again(*_):
        raise AssertionError("that is known since the world was prepared")

    for module, name in (
        (tracks, "tolerances_of"),
        (tracks, "lanelet_area"),
        (lanelet_graph, "lanelet_area"),
    ):
        monkeypatch.setattr(module, name, again)
    assert score(future, world, GERMAN).rows() == before


def test_what_the_past_leaves_open_is_charged_to_no_candidate():
    # As fast as the limit: that it was not above is open
    world = street(speed=50 / 3.6)
    slower, as_fast = [speeding(np.full(8, mps), world.past[-1]) for mps in (10.0, 50 / 3.6)]
    found = score(np.array([slower, as_fast]), world, GERMAN, world.past)
    # Before any candidate's score has been made
    assert found.allowed.tolist() == [True, False]
    charged, before = (
        [[own.rule for own in results] for results in zip_of]
        for zip_of in (
            [one.open for one in found.candidates],
            [one.open_before for one in found.candidates],
        )
    )
    assert "speed_limit" not in charged[0]
    assert "speed_limit" in before[0]
    assert "speed_limit" in charged[1]
    assert "speed_limit" not in before[1]
    # With and without a past, both are as `verify_recording` says together
    (_, verdict), *_ = verdicts_of(found.candidates[0].drives)
    assert sorted(charged[0] + before[0]) == sorted(own.rule for own in verdict.open)


def test_a_duty_that_waits_for_its_end_is_not_left_to_the_past(tmp_path):
    book = tmp_path / "slow.rules"
    book.write_text(
        'rulebook slow\nuse road\n\nhard rule slow_down {\n  says "Slow down."\n'
        "  require always (speed > 40 km/h implies eventually speed < 20 km/h)\n}\n"
    )
    world = street(speed=12.0)
    steady_on = speeding(np.full(8, 8.0), world.past[-1])
    stops = speeding(np.full(8, 2.0), world.past[-1])
    found = score(np.array([steady_on, stops]), world, machines(str(book)), world.past)
    assert [len(one.open) for one in found.candidates] == [1, 0]
    assert found.allowed.tolist() == [False, True]


def test_a_past_left_open_is_no_licence_for_what_depends_on_it(tmp_path):
    # Whether it was too fast is open; if it was, it must not be fast again
    book = tmp_path / "once.rules"
    book.write_text(
        'rulebook once\nuse road\n\nhard rule only_once {\n  says "Be fast once."\n'
        "  require never (speed > 50 km/h and next (speed < 45 km/h and next eventually"
        " speed > 60 km/h))\n}\n"
    )
    world = street(speed=50 / 3.6)
    again = speeding([10.0] * 4 + [25.0] * 4, world.past[-1])
    never = speeding([10.0] * 8, world.past[-1])
    found = score(np.array([again, never]), world, machines(str(book)), world.past)
    assert found.allowed.tolist() == [False, True]


@pytest.mark.parametrize("later", [[16.0] * 20, [20.0, *[16.0] * 8]])
def test_a_candidate_in_two_drives_has_the_margins_of_each(later):
    urban = {"types": ["urban"], "limit_mps": 50 / 3.6}
    lanes = [
        rulec.build_lanelet("a", [(0, 0), (100, 0)], **urban),
        rulec.build_lanelet("b", [(160, 0), (500, 0)], **urban),
    ]
    t = STEP_S * np.arange(3)
    ego = rulec.build_participant("ego", "car", t, 5 + 10 * t, 0 * t, step_s=STEP_S)
    recording = rulec.build_recording(lanes, [ego], step_s=STEP_S, side="right")
    world = TrafficWorld(recording, "ego")
    candidate = speeding(np.array([20.0] * 10 + later), world.past[-1])
    found = score(candidate[None], world, GERMAN, world.past)
    own = found.candidates[0]
    assert len(list(verdicts_of(own.drives))) == 2
    told = [one for one in found.margins(0) if one.rule == "speed_limit"]
    steps = [violation.step for violation in own.violations if violation.rule == "speed_limit"]
    assert [(one.violated, one.state) for one in told] == [(True, step) for step in steps]
    assert [round(one.margin.value) for one in told] == [72, 58]
    # And what is kept in both has one
    kept = [one.rule for one in found.margins(0) if not one.violated]
    assert len(kept) == len(set(kept))
