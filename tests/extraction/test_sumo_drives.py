"""Drives in SUMO's data made by hand, judged with verdicts thought through."""

import re

import pytest

from rulec import read_recording
from rulec.api.rulebook_compilation import machines
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives as Wanted
from support.builders.sumo_files import ROAD_NET, body, data, moment, written

STEP_S = 0.5
KERB, FAR = -4.8, -1.6
BOOKS = {"de": machines("de"), "gb": machines("gb")}
LEFT_HAND_NET = re.sub(
    r'(?<=shape=")[^"]+',
    lambda shape: re.sub(r",(-?)([0-9.]+)", lambda y: f",{'' if y[1] else '-'}{y[2]}", shape[0]),
    ROAD_NET.replace("<net ", '<net lefthand="true" '),
)


def going(name, x, y, mps, count):
    """The element of a car of 4 m in each of so many states, its bumper at ``x`` first."""
    return [body(name, x=x + mps * STEP_S * k, y=y, speed=mps) for k in range(count)]


def walking(name, x, y, mps, count):
    """The same of somebody who crosses the road from the kerb on."""
    about = {"element": "person", "kind": "DEFAULT_PEDTYPE", "speed": mps, "edge": ":x_c0"}
    angle = 0 if y < 0 else 180
    towards = 1 if y < 0 else -1
    return [
        body(name, x=x, y=y + towards * mps * STEP_S * k, angle=angle, **about)
        for k in range(count)
    ]


def judged(folder, bodies, book, net=ROAD_NET):
    """Ego -> the hard rules that it violated, and when first; and whether a mirror was needed."""
    steps = [moment(STEP_S * k, *each) for k, each in enumerate(zip(*bodies, strict=True))]
    found = read_recording(written(folder, data(*steps), net=net))
    answers = RecordingVerdicts(found, BOOKS[book], Wanted(defaults=True), "by hand")
    times = {}
    for one in answers.answers():
        known = times.setdefault(one.drive.ego, {})
        for violation in one.answer.violations:
            at = one.drive.time_s(violation.step)
            known[violation.rule] = min(at, known.get(violation.rule, at))
    return times, answers.mirrored


@pytest.mark.parametrize("book", ["de", "gb"])
def test_passing_on_the_side_of_the_kerb(tmp_path, book):
    # Bumpers at 41 + 13 t and 60 + 10 t: ego has passed when 37 + 13 t >= 60 + 10 t, at 8.0 s. One
    # vehicle is no queue; the crossing is at 200, and ego's bumper at 145 by then.
    cars = [going("ego", 41, KERB, 13.0, 20), going("slow", 60, FAR, 10.0, 20)]
    found, mirrored = judged(tmp_path, cars, book)
    assert found["ego"] == {"near_side_passing": 8.0}
    assert mirrored == (book == "gb")


@pytest.mark.parametrize("book", ["de", "gb"])
def test_passing_before_a_crossing(tmp_path, book):
    # Ego, on the far lane, is beside when 130 + 13 t > 145.5 + 9 t, after 3.9 s, and has passed
    # when 126 + 13 t >= 149.5 + 9 t, at 6.0 s. At 5.0 s its bumper is at 195, immediately before
    # the crossing.
    cars = [going("ego", 130, FAR, 13.0, 16), going("slow", 149.5, KERB, 9.0, 16)]
    found, _ = judged(tmp_path, cars, book)
    assert found["ego"]["crossing_overtaking"] == 6.0
    assert "crossing_overtaking" not in found["slow"]


@pytest.mark.parametrize("book", ["de", "gb"])
@pytest.mark.parametrize(("y", "gives_way"), [(-5.0, False), (-20.0, True)])
def test_somebody_on_the_crossing(tmp_path, book, y, gives_way):
    # Ego's bumper is at 196 after half a second, and at 201, on the crossing, after a whole one;
    # who walks is between the lanes then, or far from the road.
    bodies = [going("ego", 191, KERB, 10.0, 8), walking("p", 202, y, 1.0, 8)]
    found, _ = judged(tmp_path, bodies, book)
    assert found["ego"].get("give_way_to_pedestrians") == (None if gives_way else 1.0)


@pytest.mark.parametrize(("mps", "first"), [(13.89, None), (13.0, None), (14.0, 0.0)])
def test_the_limit_of_the_lane(tmp_path, mps, first):
    # 13.89 m/s is how SUMO writes 50 km/h; 14 m/s are 50.4 km/h
    found, _ = judged(tmp_path, [going("ego", 20, KERB, mps, 10)], "de")
    assert found["ego"].get("speed_limit") == first


def test_left_hand_traffic_is_its_mirror_image(tmp_path):
    """The same drives in a left-hand net need none for a British book, and are judged alike."""

    def bodies(side):
        cars = [going("ego", 131, side * KERB, 13.0, 20), going("slow", 150, side * FAR, 10.0, 20)]
        return [*cars, walking("p", 202, side * -5.0, 0.5, 20)]

    assert judged(tmp_path, bodies(1), "gb") == (
        judged(tmp_path, bodies(-1), "gb", LEFT_HAND_NET)[0],
        True,
    )
    assert not judged(tmp_path, bodies(-1), "gb", LEFT_HAND_NET)[1]
