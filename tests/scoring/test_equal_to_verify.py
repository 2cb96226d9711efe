"""What a candidate comes to is what ``verify`` says of the recording in which ego drives it."""

import pickle
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rulec.api.rulebook_compilation import machines
from rulec.diagnostics import RulecError
from rulec.extraction import candidate_drives
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.monitoring.verdict import Verdict
from rulec.recordings.building import build_lanelet, build_participant, build_recording
from rulec.recordings.recording_files import read_recording
from rulec.recordings.recording_format import RecordingSource
from rulec.scoring.charges import columns_of
from rulec.scoring.score import score
from rulec.scoring.traffic_world import TrafficWorld
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.recorded_data import RECORDINGS
from support.builders.scored_worlds import STEP_S, car, lit_junction, stop_junction, street

GERMAN, BRITISH = machines("de"), machines("gb")

LIT = lit_junction()
SIGNED = stop_junction()
BUSY = street(
    [car("slow", 6.0, x=30.0), car("fast", 14.0, x=-40.0, y=3.5), car("near", 9.0, x=-25.0)]
)


def verdict_key(answer):
    if isinstance(answer, NoDrive):
        return answer
    found = answer.answer
    assert isinstance(found, Verdict), found
    violations = [(one.rule, dict(one.binding), one.step) for one in found.violations]
    doubtful = [(one.rule, dict(one.binding), one.because) for one in found.open]
    return answer.drive.start_s, answer.drive.trace, violations, doubtful, found.not_judged


def assert_equal_to_verify(candidates, world, rules, after):
    scores = score(candidates, world, rules, after)
    assert len(scores) == len(candidates)
    for found, candidate in zip(scores.candidates, candidates, strict=True):
        whole = world.recording_of(candidate, after)
        judged = RecordingVerdicts(whole, rules, RequestedDrives((world.ego,)), whole.name)
        expected = [verdict_key(answer) for answer in judged.answers()]
        assert [verdict_key(answer) for answer in found.drives] == expected
    return scores


def driven(start, controls, step_s=STEP_S):
    """A future by acceleration (m/s²) and turn (rad/s), a pair for each state."""
    x, y, heading, speed = start
    rows = []
    for gained, turned in controls:
        speed, heading = max(speed + gained * step_s, 0.0), heading + turned * step_s
        x, y = x + speed * np.cos(heading) * step_s, y + speed * np.sin(heading) * step_s
        rows.append((x, y, heading, speed))
    return rows


pieces = st.tuples(st.sampled_from([-5.0, -1.0, 0.0, 2.0]), st.sampled_from([-0.1, 0.0, 0.0, 0.1]))
controls = st.lists(pieces, min_size=4, max_size=4).map(lambda own: [x for x in own for _ in "12"])


@settings(max_examples=settings().max_examples // 12)
@given(
    st.sampled_from([LIT, SIGNED, BUSY]),
    st.lists(controls, min_size=2, max_size=3),
    st.integers(0, 4),
    st.sampled_from([GERMAN, GERMAN, BRITISH]),
)
def test_random_futures(world, several, n_past, rules):
    candidates = np.array([driven(world.past[-1], own) for own in several])
    # For the British book all is mirrored
    after = world.past[4 - n_past :] if n_past else None
    assert_equal_to_verify(candidates, world, rules, after)


def test_the_wrong_way_on_a_motorway():
    """Whoever comes back against the lanes is blamed for it, among others who do not."""
    world = street([car("slow", 6.0, x=60.0)], types=["interstate"])
    ahead = driven(world.past[-1], [(0.0, 0.0)] * 8)
    back = [(60.0 - 6.0 * k, 3.5, np.pi, 12.0) for k in range(8)]
    scores = assert_equal_to_verify(np.array([ahead, back]), world, GERMAN, None)
    blamed = [
        {one.rule for drive in found.drives for one in drive.answer.violations}
        for found in scores.candidates
    ]
    assert ["wrong_way" in rules for rules in blamed] == [False, True]


def test_who_keeps_right_behind_another_one_is_not_towed():
    """Ego drives itself, though it stays 1 m behind one of 4.5 m that is as fast all the time."""
    world = street([car("lead", 10.0, x=-9.5)])
    x, y, heading, _ = world.past[-1]
    close = [(x + 10.0 * STEP_S * k, y, heading, 10.0) for k in range(1, 9)]
    (found,) = assert_equal_to_verify(np.array([close]), world, GERMAN, world.past).candidates
    assert "following_distance" in {one.rule for one in found.violations}


def test_candidates_are_driven_in_the_night_that_is_assumed():
    """There, lamps that are off are known to be."""
    world = street([])
    ahead = [driven(world.past[-1], [(0.0, 0.0)] * 8)]
    night = replace(world, wanted=RequestedDrives(assumed={"night": True}))
    assert [one.recording_of(ahead[0]).weather.night for one in (world, night)] == [None, True]


def test_what_a_candidate_jerks_blurs_nothing_that_was_recorded():
    step_s, steps = 0.1, np.arange(20)
    lane = build_lanelet("road", [(-50, 0), (300, 0)], types=["urban"])
    t = step_s * steps
    bodies = [
        build_participant(name, "car", t, x + 10 * t, 0 * t, step_s=step_s)
        for name, x in (("ego", 0.0), ("slow", 40.0))
    ]
    world = TrafficWorld(build_recording([lane], bodies, step_s=step_s, side="right"), "ego", 0.4)
    jerking = np.array([(4 + k % 2, 0.5 * (k % 2), 0.0, 10.0) for k in range(40)])
    (found,) = assert_equal_to_verify(jerking[None], world, GERMAN, None).candidates
    gap = found.drives[0].drive.trace.states[0]["gap"]["slow"]
    # Places of recordings built by programs are known to 5 cm
    assert gap.high - gap.low < 0.11


def detected(number, speed, x, turned=(), lost=()):
    """Straight on, but for states in which the box is turned round, or is not seen."""
    k = np.arange(40)
    heading = np.where(np.isin(k, turned), np.pi, 0.0)
    t = 0.1 * k
    body = build_participant(number, "car", t, x + speed * t, 0 * t, step_s=0.1, heading=heading)
    return replace(
        body,
        states={step: one for step, one in body.states.items() if step not in lost},
        outlines={step: one for step, one in body.outlines.items() if step not in lost},
    )


def test_recorded_faults_are_mended_and_candidates_are_meant():
    """Boxes turned round and holes of the past and of others; a future may look anywhere."""
    lane = build_lanelet("road", [(-50, 0), (300, 0)], types=["urban"])
    bodies = [
        detected("ego", 10.0, 0.0, turned=[5], lost=[8]),
        detected("slow", 9.0, 20.0, turned=[12, 13], lost=[20, 21]),
        detected("behind", 10.0, -15.0, turned=[25]),
    ]
    whole = build_recording([lane], bodies, step_s=0.1, side="right")
    world = TrafficWorld(whole, "ego", 1.4)
    # What is lost for a moment is no end of the past
    assert len(world.past) == 15
    assert np.abs(world.past[:, 2]).max() < 1e-9
    ahead = [(14.0 + k, 0.0, 0.0, 10.0) for k in range(1, 25)]
    turned = [(x, y, np.pi if k % 7 == 3 else h, v) for k, (x, y, h, v) in enumerate(ahead)]
    backwards = [(14.0 + k, 0.0, np.pi, 10.0) for k in range(1, 25)]
    jumps = [(14.0 + 30 * (k % 2), 3.0 * (k % 3), 0.5 * k, 10.0) for k in range(1, 25)]
    futures = np.array([ahead, turned, backwards, jumps])
    for after in (None, world.past):
        scores = assert_equal_to_verify(futures, world, GERMAN, after)
        headings = [
            {state.heading for state in world.body_along(future, world.past).states.values()}
            for future in futures[:2]
        ]
        assert [np.pi in own for own in headings] == [False, True]
        assert len(scores) == 4


def test_a_past_that_is_not_asked_about_counts_for_nothing():
    """Another car comes 0.5 s after ego did, and before all that the candidate is judged by."""
    lane = build_lanelet("road", [(-50, 0), (300, 0)], types=["urban"], limit_mps=50 / 3.6)
    bodies = [detected("ego", 10.0, 0.0), detected("ahead", 10.0, 30.0, lost=range(5))]
    world = TrafficWorld(build_recording([lane], bodies, step_s=0.1, side="right"), "ego", 1.0)
    prepared, _ = world.drives("right", 11, 30)
    assert prepared.drives.surroundings.whole.first == 5
    ahead = [(10.0 + k, 0.0, 0.0, 10.0) for k in range(1, 21)]
    assert_equal_to_verify([ahead], world, GERMAN, None)


def test_who_does_not_drive_has_no_future_to_be_scored():
    lane = build_lanelet("road", [(-50, 0), (300, 0)], types=["urban"])
    t = STEP_S * np.arange(5)
    walker = build_participant("walker", "pedestrian", t, 1.0 * t, 0 * t, step_s=STEP_S)
    whole = build_recording([lane], [car("ego", 10.0), walker], step_s=STEP_S, side="right")
    with pytest.raises(RulecError, match="no vehicle `walker` that drives"):
        TrafficWorld(whole, "walker")


def test_order_and_company_change_nothing():
    futures = np.array([driven(BUSY.past[-1], [(a, 0.0)] * 8) for a in (-3.0, 0.0, 2.0)])
    together = score(futures, BUSY, GERMAN, BUSY.past)
    for number, future in enumerate(futures):
        (alone,) = score(future[None], BUSY, GERMAN, BUSY.past).candidates
        own = [verdict_key(one) for one in together.candidates[number].drives]
        assert [verdict_key(one) for one in alone.drives] == own
    back = score(futures[::-1], BUSY, GERMAN, BUSY.past)
    assert back.penalties_at_most.tolist() == together.penalties_at_most.tolist()[::-1]


def test_who_stops_at_a_sign_has_the_same_words_alone_and_with_one_that_drives_on():
    stops, drives = (driven(SIGNED.past[-1], [(a, 0.0)] * 14) for a in (-2.0, 0.0))
    scores = assert_equal_to_verify(np.array([stops, drives]), SIGNED, GERMAN, SIGNED.past)
    ((found,), _) = (one.drives for one in scores.candidates)
    assert [state["cause_to_brake"] for state in found.drive.trace.states][-4:] == [True] * 4


def test_a_gap_beside_another_one_is_as_wide_in_company_of_one_whose_headings_are_noise():
    """The first candidate's headings are wrong by a few 0.0001 rad, the other's by tenths."""
    step_s, speed = 0.1, 10.0
    t = step_s * np.arange(60)
    bodies = [
        build_participant("ego", "car", t[:20], speed * t[:20], 0 * t[:20], step_s=step_s),
        build_participant("beside", "car", t, speed * t, 0 * t + 3.35, step_s=step_s),
    ]
    lane = build_lanelet("lane", [(-100, 0), (500, 0)], types=["urban"], left_of="left")
    left = build_lanelet("left", [(-100, 3.5), (500, 3.5)], types=["urban"], right_of="lane")
    found = build_recording([lane, left], bodies, step_s=step_s, side="right")
    world = TrafficWorld(found, "ego", now_s=1.9)
    noise = np.random.default_rng(1).standard_normal(40)
    nearly, badly = (
        np.column_stack((speed * t[20:], 0 * t[20:], error * noise, speed + 0 * t[20:]))
        for error in (1e-4, 0.2)
    )
    scores = assert_equal_to_verify(np.array([nearly, badly]), world, GERMAN, world.past)
    gaps = [
        [state["lateral_gap"]["beside"] for state in one.drives[0].drive.trace.states][-20:]
        for one in scores.candidates
    ]
    assert all(one.high - one.low < 0.2 for one in gaps[0])
    assert any(one.high - one.low > 0.5 for one in gaps[1])


@pytest.mark.long
@pytest.mark.skipif(not RECORDINGS.is_dir(), reason="no recordings")
def test_recorded_worlds():
    rng = np.random.default_rng(3)
    seen = 0
    for path in sorted(RECORDINGS.glob("*.xml")):
        recording = read_recording(RecordingSource(path))
        moving = [
            body
            for body in recording.participants
            if "vehicle" in body.object_types and not body.standing and len(body.states) > 12
        ]
        for body in moving[:3]:
            now = sorted(body.states)[len(body.states) // 2]
            world = TrafficWorld(recording, body.id, now * recording.step_s)
            rest = [body.states[now + k] for k in range(1, 6) if now + k in body.states]
            recorded = [(one.x, one.y, one.heading, one.speed) for one in rest]
            random = [(rng.uniform(-4, 2), rng.uniform(-0.1, 0.1)) for _ in recorded]
            if recorded:
                futures = [recorded, driven(world.past[-1], random, recording.step_s)]
                assert_equal_to_verify(np.array(futures), world, GERMAN, world.past)
                seen += 1
    assert seen > 20


def test_who_only_reaches_over_the_middle_is_judged_without_who_goes_beyond_it():
    """Both are 20 m behind one that goes straight on as fast as they do."""
    lanes = [
        build_lanelet("there", [(-100, 0), (500, 0)], types=["urban"]),
        build_lanelet("back", [(500, 3.5), (-100, 3.5)], types=["urban"]),
    ]
    bodies = [car("ego", 10.0, x=-15.0, count=4), car("slow", 10.0, x=5.0)]
    world = TrafficWorld(build_recording(lanes, bodies, step_s=STEP_S, side="right"), "ego")
    reaching, beyond = (
        [(world.past[-1][0] + 10.0 * STEP_S * k, y, 0.0, 10.0) for k in range(1, 13)]
        for y in (1.2, 3.5)
    )
    scores = assert_equal_to_verify(np.array([reaching, beyond]), world, GERMAN, None)
    overtaking = [
        {state["overtaking"] for state in found.drives[0].drive.trace.states}
        for found in scores.candidates
    ]
    # Only who is on the other side may have given up
    assert overtaking == [{False}, {UNKNOWN}]


def test_many_candidates_come_to_what_few_do(monkeypatch):
    turns = [(a, t) for a in (-3.0, 0.0, 2.0) for t in (0.0, 0.05)]
    futures = np.array([driven(BUSY.past[-1], [own] * 8) for own in turns])
    few = score(futures, BUSY, GERMAN, BUSY.past)
    monkeypatch.setattr(candidate_drives, "MOST_CELLS", 1)
    many = score(futures, BUSY, GERMAN, BUSY.past)
    assert any(found.open for found in few.candidates)
    for one, other in zip(few.candidates, many.candidates, strict=True):
        assert one.open == other.open
        assert [verdict_key(x) for x in one.drives] == [verdict_key(x) for x in other.drives]
        assert len(one.drives) == len(other.drives)
    assert few.rows() == many.rows()
    assert few.margins(2) == many.margins(2)
    assert pickle.loads(pickle.dumps(many.candidates[1])).open == few.candidates[1].open


def counted(candidates):
    found = columns_of(candidates, GERMAN)
    return [x.tolist() for x in (*found.violated, *found.open, found.off_road, found.late)]


@pytest.mark.parametrize("most_cells", [candidate_drives.MOST_CELLS, 1])
@pytest.mark.parametrize("speed", [10.0, 20.0])
def test_what_is_counted_is_what_scores_say(monkeypatch, speed, most_cells):
    """By the columns, of which no score has been made, and by all scores; also if ego was fast."""
    monkeypatch.setattr(candidate_drives, "MOST_CELLS", most_cells)
    world = street([car("slow", 6.0, x=30.0), car("near", 9.0, x=-25.0)], speed=speed)
    turns = [(a, t) for a in (-3.0, 0.0, 4.0) for t in (0.0, 0.5)]
    futures = np.array([driven(world.past[-1], [own] * 8) for own in turns])
    found = score(futures, world, GERMAN, world.past)
    assert bool(found.violated_before) == (speed > 10)
    before = counted(found.candidates)
    every = tuple(found.candidates)
    assert before == counted(found.candidates) == counted(every)
    assert found.allowed.tolist() == [one.satisfied_as_judged is True for one in every]
    assert {one.satisfied for one in every} <= {False, None}  # by `de`, some rules cannot be judged
    assert found.perhaps_allowed.tolist() == [
        one.satisfied is not False and not one.off_road for one in every
    ]
    whose, which, of_open, doubtful, off_road, _ = before
    rules = [rule.name for rule in GERMAN.rules]
    for numbers, places, charged in (
        (whose, which, [own.violations for own in every]),
        (of_open, doubtful, [own.open for own in every]),
    ):
        assert [(number, rules[place]) for number, place in zip(numbers, places, strict=True)] == [
            (number, one.rule) for number, own in enumerate(charged) for one in own
        ]
        assert numbers
    assert any(off_road)
