"""Recordings made by hand, judged by books of law, with verdicts thought through."""

import json
from dataclasses import replace
from math import pi

import numpy as np
import pytest

from rulec.api.rulebook_compilation import machines
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.violation_evidence import evidence_of
from rulec.recordings.recording import Weather
from rulec.report.findings.findings_of_drives import DriveFindings
from rulec.report.verdicts import recording_json, verdict_report
from support.builders.drive_verdicts import violated
from support.builders.recordings import recording, straight, vehicle

STEP_S = 0.5
MOTORWAY = {"types": frozenset({"highway"})}
GERMAN = machines("de")
BRITISH = machines("gb")


def two_lanes(**more):
    """A road of two lanes that lead along the x axis; 1 is the right one."""
    return [
        straight(1, 0, 1000, y=0.0, left_of=2, **more),
        straight(2, 0, 1000, y=4.0, right_of=1, **more),
    ]


def going(number, x, y, mps, count=20, **more):
    """Straight on, at a constant speed."""
    places = {k: (x + mps * STEP_S * k, y) for k in range(count)}
    return vehicle(number, places, speed=mps, **more)


def test_overtaking_on_the_right_on_a_motorway():
    # 7 is 4 m long at 20 m/s from x = 50, 8 beside at 30 m/s from x = 20: their bodies are level
    # while |30 - 10 t| < 4, so 8 is beside from 3.0 s (2.6 s is no state) and in front from 3.5 s.
    cars = [going(7, 50, 4.0, 20.0), going(8, 20, 0.0, 30.0)]
    found = violated(recording(two_lanes(**MOTORWAY), cars), GERMAN)
    assert found["8"] == {"near_side_passing": 3.5}
    # 7 is on the left of two lanes with nobody to overtake
    assert set(found["7"]) == {"keep_near_side"}


@pytest.mark.parametrize(("y", "heading", "passed"), [(8, pi, False), (4, pi, True), (4, 0, True)])
def test_a_queue_on_the_other_side_of_the_road_is_not_overtaken(y, heading, passed):
    # 8 stands on a lane that leads the other way; or on the left one of ego's, either way round.
    # Ego's rear, 18 + 20 t, is level with its end, 102, after 4.2 s.
    lanes = [*two_lanes(), straight(3, 1000, 0, y=8.0)]
    cars = [going(7, 20, 0.0, 20.0), going(8, 100, y, 0.0, heading=heading)]
    found = violated(recording(lanes, cars), GERMAN, egos=("7",))
    assert found["7"].get("near_side_passing") == (4.5 if passed else None)


def test_who_is_overtaken_and_speeds_up_is_told_by_whom():
    """7 gains 2 m/s each second after 2 s at 20 m/s, 8 comes past it at 40; 9 is far ahead.

    All traffic is recorded, so that 7 had not to brake before.
    """
    times = [k * STEP_S for k in range(20)]
    places = {k: (200 + 20 * t + max(t - 2, 0) ** 2, 0.0) for k, t in enumerate(times)}
    cars = [vehicle(7, places), going(8, 120, 4.0, 40.0), going(9, 500, 4.0, 40.0)]
    found = recording(two_lanes(**MOTORWAY), cars)
    found = replace(found, complete=frozenset({"arrivals"}))
    judged = RecordingVerdicts(found, GERMAN, RequestedDrives(egos=("7",)), "by hand")
    (one,) = judged.answers()
    (violation,) = [x for x in one.answer.violations if x.rule == "being_overtaken"]
    evidence = evidence_of(violation, one.drive, GERMAN, {})
    assert evidence.whom == ("8",)
    text = verdict_report.as_text(
        replace(one.answer, violations=(violation,)), GERMAN, whom=[("8",)]
    )
    assert "being_overtaken in right_of_way [§ 5(6) s. 1]: cannot be kept" in text
    assert "because of 8" in text
    findings = DriveFindings(judged, "by hand.xml")
    finding = next(x for x in findings.add(one) if x.rule == "being_overtaken")
    assert finding.other == ("8",)
    assert "towards 8" in finding.says
    said = json.loads(recording_json.as_json(one, judged, ()))["violations"]
    assert [x["evidence"]["whom"] for x in said if x["rule"] == "being_overtaken"] == [["8"]]


def test_overtaking_on_the_left():
    cars = [going(7, 50, 0.0, 20.0), going(8, 20, 4.0, 30.0)]
    found = violated(recording(two_lanes(**MOTORWAY), cars), GERMAN)
    assert found["7"] == {}
    # 8 stays on the left for too long: it has passed 7 by more than 2 s of its way, 60 m, when
    # 10 t - 30 - 4 > 60, at 9.5 s
    assert found["8"] == {"keep_near_side": 9.5}


def test_the_same_overtaking_in_a_mirror_for_a_book_of_the_other_side():
    from dataclasses import replace

    cars = [going(7, 50, 4.0, 20.0), going(8, 20, 0.0, 30.0)]
    found = replace(recording(two_lanes(**MOTORWAY), cars), side="right")
    mirrored = violated(found, BRITISH)
    as_recorded = violated(found, BRITISH, as_recorded=True)
    # Rule 268 advises against passing on the left, the near side in Britain: with the mirror 8 did
    assert mirrored["8"]["near_side_passing"] == 3.5
    # As recorded it passed on the far side, the right one
    assert "near_side_passing" not in as_recorded["8"]


@pytest.mark.parametrize(("side", "slow", "fast"), [("left", 4.0, 8.0), ("right", 8.0, 4.0)])
def test_a_finding_is_where_the_file_has_it_mirrored_or_not(side, slow, fast):
    # 8 passes 7 on the near side of its traffic: in the file that is the left one, or the right.
    lanes = [
        straight(1, 0, 1000, y=4.0, left_of=2, **MOTORWAY),
        straight(2, 0, 1000, y=8.0, right_of=1, **MOTORWAY),
    ]
    cars = [going(7, 50, slow, 20.0), going(8, 20, fast, 30.0)]
    found = replace(recording(lanes, cars), side=side)
    judged = RecordingVerdicts(found, BRITISH, RequestedDrives(), "by hand")
    assert judged.mirrored == (side == "right")
    findings = DriveFindings(judged, "by hand.xml")
    places = {}
    for one in judged.answers():
        for violation in one.answer.violations:
            place = evidence_of(violation, one.drive, BRITISH, {}).place
            places.setdefault(one.drive.ego, set()).add(place.y)
        for finding in findings.add(one):
            if finding.outcome == "violated":
                assert finding.y in places[finding.vehicle]
    assert places["8"] == {fast}


@pytest.mark.parametrize(("gap_m", "rules"), [(60, set()), (40, {"half"}), (12, {"half", "safe"})])
def test_keeping_distance(gap_m, rules):
    # At 30 m/s (108 km/h) half the speedometer is 54 m. At equal speeds ego is safe with what it
    # drives while it reacts, 30 m.
    cars = [going(7, 104 + gap_m, 0.0, 30.0), going(8, 100, 0.0, 30.0)]
    names = {"half": "following_distance_half_speedometer", "safe": "following_distance"}
    found = violated(recording([straight(1, 0, 1000, **MOTORWAY)], cars), GERMAN)
    assert found == {"7": {}, "8": {names[rule]: 0.0 for rule in rules}}


def test_what_is_assumed_is_judged():
    cars = [going(7, 0, 0.0, 15.0)]  # 54 km/h
    found = recording([straight(1, 0, 1000)], cars)
    assert violated(found, GERMAN) == {"7": {}}
    assert violated(found, GERMAN, assumed={"built_up": True}) == {"7": {"speed_limit": 0.0}}
    assert violated(found, GERMAN, assumed={"limit": 50.0}) == {"7": {"speed_limit": 0.0}}


LAMPS = frozenset({"dipped_beam", "main_beam", "front_fog_lamp"})


@pytest.mark.parametrize(
    ("recorded", "assumed", "is_dark"),
    [(None, True, True), (None, None, False), (True, None, True), (True, False, False)],
)
def test_in_an_assumed_night_lamps_that_are_off_are_known(recorded, assumed, is_dark):
    """By day there may be weaker lamps than those recorded."""
    car = going(7, 0, 0.0, 15.0)
    car = replace(car, shows=LAMPS, lamps=dict.fromkeys(car.states, frozenset()))
    found = recording([straight(1, 0, 1000)], [car])
    found = replace(found, weather=Weather(night=recorded))
    values = {} if assumed is None else {"night": assumed}
    rules = violated(found, GERMAN, assumed=values)["7"]
    assert ("lights_at_night" in rules) == is_dark


def test_from_python():
    import rulec

    cars = [going(7, 50, 4.0, 20.0), going(8, 20, 0.0, 30.0)]
    judged = rulec.verify_recording(recording(two_lanes(), cars), "esterle2019")
    answers = list(judged.answers())
    assert [(one.drive.ego, one.answer.satisfied) for one in answers] == [("7", True), ("8", True)]
    assert judged.by_default(answers[0].drive.words) == {"R1": (), "R2": (), "R3": ()}


@pytest.mark.parametrize(("stands_at", "blamed"), [(95, False), (200, True)])
def test_who_goes_round_nobody_yet_is_on_the_wrong_side(stands_at, blamed):
    """Ego is on the other half from 60 to 105 m: past one that stands there, or long before it."""
    road = [straight(1, 0, 400, y=0.0), straight(2, 400, 0, y=4.0)]
    places = {k: (10 + 5 * k, 4.0 if 10 <= k <= 19 else 0.0) for k in range(36)}
    ego = vehicle(7, {k: at for k, at in places.items() if at[0] < 180}, speed=10.0)
    found = violated(recording(road, [ego, going(8, stands_at, 0.0, 0.0, 36)]), GERMAN, egos=("7",))
    assert ("wrong_way" in found["7"]) is blamed


@pytest.mark.parametrize(("book", "rule"), [("de", True), ("us", False)])
def test_who_drives_close_behind_a_tram(book, rule):
    """At 15 m/s ego needs 15 + 225 / 16 m, one of 10 m/s on rails 100 / 6 m: 12.4 m between."""
    tram = going(8, 60, 0.0, 10.0, kind="train", length=20.0)
    for count, near in ((9, False), (15, True)):
        ego = going(7, 10, 0.0, 15.0, count)  # 38 m behind it, 5 m less each second
        found = violated(recording(two_lanes(), [ego, tram]), machines(book), egos=("7",))
        blamed = "following_distance_behind_rail_vehicles" in found["7"]
        assert blamed is (rule and near)


@pytest.mark.parametrize(("faster", "blamed"), [(0.0, True), (2.0, False)])
def test_whom_another_one_leaves_behind_does_not_follow_it_in_britain(faster, blamed):
    """Ego, at 30 m/s, goes out behind one 26 m ahead that is as fast, or 7 km/h faster."""
    ego = vehicle(7, {k: (15 * k, 0.0 if k < 6 else 4.0) for k in range(20)}, speed=30.0)
    ahead = going(8, 30, 4.0, 30.0 + faster)
    found = violated(recording(two_lanes(**MOTORWAY), [ego, ahead]), BRITISH, egos=("7",))
    assert ("following_distance" in found["7"]) is blamed


@pytest.mark.parametrize(("back_at", "blamed"), [(24, True), (21, True), (17, False)])
def test_who_meets_somebody_long_after_it_pulled_out_had_no_room_for_it(back_at, blamed):
    """Ego pulls out at 2.5 s, at 20 m/s, past one at 12; another one at 20 m/s meets it at 11 s."""
    road = [straight(1, 0, 800, y=0.0), straight(2, 800, 0, y=4.0)]
    across = np.interp(range(34), [3, 6, back_at - 3, back_at], [0.0, 4.0, 4.0, 0.0])
    ego = vehicle(7, {k: (10 * k, float(y)) for k, y in enumerate(across)}, speed=20.0)
    slow = going(8, 40, 0.0, 12.0, 34)
    other = vehicle(9, {k: (440 - 10 * k, 4.0) for k in range(34)}, speed=20.0, heading=pi)
    found = violated(recording(road, [ego, slow, other]), GERMAN, egos=("7",))
    assert ("pulling_out" in found["7"]) is blamed


@pytest.mark.parametrize("seconds", [0.5, 3.0])
@pytest.mark.parametrize(("apart", "blamed"), [(40, True), (200, False)])
def test_who_joins_a_motorway_at_a_usual_pace_gives_way(seconds, apart, blamed):
    """Ego, at 20 m/s, moves over from 5 s on; one at 31 m/s is so far behind it at 6.5 s."""
    through = {"types": frozenset({"interstate", "mainCarriageWay"})}
    entry = {"types": frozenset({"interstate", "accessRamp"})}
    road = [
        straight(1, 0, 400, y=0.0, left_of=2, **entry),
        straight(2, 0, 1000, y=4.0, right_of=1, left_of=3, **through),
        straight(3, 0, 1000, y=8.0, right_of=2, **through),
    ]
    begins = 6.5 - seconds / 2
    across = [float(np.interp(k / 2, [begins, begins + seconds], [0.0, 4.0])) for k in range(24)]
    ego = vehicle(7, {k: (100 + 10 * k, y) for k, y in enumerate(across)}, speed=20.0)
    other = going(8, 230 - apart - 31 * 6.5, 4.0, 31.0, 24)
    found = violated(recording(road, [ego, other]), GERMAN, egos=("7",))
    assert ("joining_motorway" in found["7"]) is blamed


def test_who_drives_along_a_lane_for_cycles():
    """5 s on its own lane, 2.5 s over to the one for cycles, 5 s along that, all at 10 m/s."""
    cycles = straight(2, 0, 1000, y=-2.5, width=1.5, left_of=1, types=frozenset({"bicycleLane"}))
    lane = straight(1, 0, 1000, y=0.0, width=3.5, limit_mps=50 / 3.6)
    across = np.interp(np.arange(25), [10, 15], [0.0, -2.5])
    car = vehicle(7, {k: (50 + 5 * k, y) for k, y in enumerate(across)}, speed=10.0, width=1.8)
    beside = recording([replace(lane, right_of="2"), cycles], [car])
    assert "cycle_lane" in violated(beside, BRITISH)["7"]
    assert "bus_lane" in violated(beside, GERMAN)["7"]
    # A map without any may have left them out
    (judged,) = RecordingVerdicts(
        recording([lane], [car]), BRITISH, RequestedDrives(), ""
    ).answers()
    assert "cycle_lane" in {rule.rule for rule in judged.answer.not_judged}


@pytest.mark.parametrize(("walks_at", "blamed"), [(-1.4, False), (-6.0, True)])
def test_who_goes_round_one_that_walks_along_the_road(walks_at, blamed):
    """Ego, 14 m/s, is on the other half for 4 s; on its own one somebody comes towards it there.

    Ego's front is level with the walker after some 5.7 s: (100 - 10 - 2) m at 15.4 m/s.
    """
    lanes = [straight(1, 0, 600, width=3.5), straight(2, 600, 0, 3.5, width=3.5)]
    across = np.interp(np.arange(24), [3, 8, 15, 20], [0.0, 2.3, 2.3, 0.0])
    car = vehicle(7, {k: (10 + 7 * k, y) for k, y in enumerate(across)}, speed=14.0, width=1.8)
    places = {k: (100 - 0.7 * k, walks_at) for k in range(24)}
    walker = vehicle(8, places, "pedestrian", length=0.5, width=0.5, speed=1.4, heading=pi)
    found = violated(recording(lanes, [car, walker]), GERMAN, egos=("7",))
    assert ("wrong_way" in found["7"]) is blamed


@pytest.mark.parametrize(
    ("book", "apart", "blamed"), [("de", 1, True), ("fr", 1, True), ("de", 40, False)]
)
def test_who_comes_back_from_the_other_half_before_one_that_it_has_overtaken(book, apart, blamed):
    """Both drive at 16 m/s as ego comes back, after 10 s, so far ahead; it has been at 20 m/s."""
    lanes = [straight(1, 0, 1000, width=3.5), straight(2, 1000, 0, 3.5, width=3.5)]
    behind = vehicle(8, {k: (100 + 8 * k, 0.0) for k in range(30)}, speed=16.0, width=1.8)
    steps = np.arange(30)
    # Its middle is over the mark, at 1.75 m, in the state 20
    ahead = 100 + 8 * steps + 4 + apart + np.where(steps < 16, 2.0 * (steps - 16), 0.0)
    across = np.interp(steps, [2, 6, 18, 22], [0.0, 3.5, 3.5, 0.0])
    speeds = np.where(steps < 16, 20.0, 16.0)
    car = vehicle(7, {int(k): (float(ahead[k]), float(across[k])) for k in steps}, width=1.8)
    states = {k: replace(state, speed=float(speeds[k])) for k, state in car.states.items()}
    found = violated(recording(lanes, [replace(car, states=states), behind]), machines(book))
    assert ("safe_return" in found["7"]) is blamed


@pytest.mark.parametrize(
    ("walks_at", "begins_m", "found"),
    [(-1.5, 44, "open"), (-1.5, 46, "violated"), (-3.5, 44, "kept"), (-3.5, 46, "kept")],
)
def test_whom_ego_goes_past_between_two_states(walks_at, begins_m, found):
    """Ego, 14 m/s and 4 m long, comes 6.4 m a state nearer to one of 0.5 m that walks ahead.

    Their bodies are level where their middles are within 2.25 m: from 44 m on these are 3.2 m from
    each other in state 8 and as far in state 9, from 46 m on 1.2 m in state 8. Across the road
    there are 0.4 m between them, or 2.4 m, where the law wants 1.5 m in town and 2 m outside.
    """
    lane = straight(1, 0, 600, width=8.0, types=frozenset({"urban"}))
    car = vehicle(7, {k: (begins_m + 7 * k, 0.0) for k in range(20)}, speed=14.0, width=1.7)
    places = {k: (98.4 + 0.6 * k, walks_at) for k in range(20)}
    walker = vehicle(8, places, "pedestrian", length=0.5, width=0.5, speed=1.2)
    (judged,) = RecordingVerdicts(
        recording([lane], [car, walker]), GERMAN, RequestedDrives(("7",)), ""
    ).answers()
    asked, answer = "lateral_gap_to_pedestrians", judged.answer
    assert asked not in {rule.rule for rule in answer.not_judged}
    assert (asked in {rule.rule for rule in answer.open}) is (found == "open")
    assert (asked in {rule.rule for rule in answer.violations}) is (found == "violated")
