"""Slow traffic with noisy places: from step to step noise is faster than it, and goes anywhere."""

import numpy as np
import pytest

import rulec
from rulec import RulecError, recording_from_columns

LANES = {
    "lane": ["street"] * 2,
    "x": [0.0, 300.0],
    "y": [0.0, 0.0],
    "limit_kmh": [50] * 2,
    "type": ["urban"] * 2,
}
COLUMNS = [(), ("heading",), ("heading", "speed"), ("vx", "vy"), ("speed",)]

BOOK = """\
rulebook slow
use road
hard rule limit { require always (speed <= limit) }
hard rule forward { require never reversing }
hard rule distance (v: vehicle) { require never (behind(v) and gap(v) < 4 m) }
"""


def queue(mps, columns=(), *, step_s=0.1, noise_m=0.3, seed=1, **changed):
    """Five cars that drive along x, 7.5 m from bumper to bumper, for 20 s."""
    random = np.random.default_rng(seed)
    t = np.arange(round(20 / step_s) + 1) * step_s
    rows = []
    for number in range(5):
        noise = random.normal(0, noise_m, (2, len(t)))
        along, aside = random.normal(0, 0.05, (2, len(t)))
        own = {"track": [f"c{number}"] * len(t), "t": t.round(3)}
        own |= {"x": 10 + 12.0 * number + mps * t + noise[0], "y": noise[1]}
        own |= {"heading": aside / 2, "speed": mps + along, "vx": mps + along, "vy": aside}
        rows.append(own | {name: change(own) for name, change in changed.items()})
    names = ("track", "t", "x", "y", *columns)
    return {name: np.concatenate([own[name] for own in rows]).tolist() for name in names}


def doubts(*told, **changed):
    remarks = recording_from_columns(queue(*told, **changed), LANES).remarks
    assumed = ("all tracks are taken", "what is not stated", "lanes are taken")
    return [remark for remark in remarks if not remark.startswith(assumed)]


@pytest.mark.parametrize("columns", COLUMNS)
@pytest.mark.parametrize("mps", [0.5, 1.4, 2.0])
@pytest.mark.parametrize("step_s", [0.04, 0.1, 0.5])
def test_noise_is_no_motion(columns, mps, step_s):
    assert doubts(mps, columns, step_s=step_s) == []


def test_who_stands_does_not_move():
    for seed in range(5):
        assert doubts(0.0, ("heading", "speed"), noise_m=1.0, seed=seed) == []


@pytest.mark.parametrize("columns", [("heading", "speed"), ("heading", "vx", "vy")])
def test_noise_does_not_make_anybody_back(columns):
    recording = recording_from_columns(queue(1.4, columns), LANES)
    speeds = [state.speed for body in recording.participants for state in body.states.values()]
    assert min(speeds) > 1.0


def test_headings_are_those_of_the_motion():
    recording = recording_from_columns(queue(1.4), LANES)
    headings = [x.heading for body in recording.participants for x in body.states.values()]
    assert np.abs(headings).max() < np.radians(30)


def test_slow_traffic_is_judged():
    """It keeps its distance, and to its lane and the limit."""
    recording = recording_from_columns(queue(1.4, ("heading", "speed")), LANES)
    book = rulec.compile(rulec.parse_rulebook(BOOK))
    answers = [drive.answer for drive in rulec.verify_recording(recording, book).answers()]
    assert not any(answer.violations for answer in answers)
    assert any(not answer.open and not answer.not_judged for answer in answers)


@pytest.mark.parametrize("mps", [1.4, 3.0])
def test_headings_that_do_not_fit_are_found_all_the_same(mps):
    turned = {"heading": lambda own: np.pi / 2 - own["heading"]}
    with pytest.raises(RulecError, match="headings do not fit the motion"):
        recording_from_columns(queue(mps, ("heading",), **turned), LANES)


def test_speeds_in_another_unit_are_found_all_the_same():
    changed = {"speed": lambda own: own["speed"] * 3.6}
    with pytest.raises(RulecError, match="times what places and times say") as refused:
        doubts(3.0, ("heading", "speed"), **changed)
    assert "call the column `speed_kmh`" in refused.value.diagnostics[0].help


def test_who_backs_does_so_in_noise():
    backs = {"heading": lambda own: own["heading"] + np.pi}
    recording = recording_from_columns(queue(1.0, ("heading", "speed"), **backs), LANES)
    speeds = [state.speed for body in recording.participants for state in body.states.values()]
    assert max(speeds) < 0
