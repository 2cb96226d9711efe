"""A recorded drive from above: where things are, what is said of a violation, one page for all."""

import json
import re
import shutil
import subprocess
import xml.etree.ElementTree as ET
from dataclasses import replace
from math import cos, pi, sin
from pathlib import Path

import numpy as np
import pytest

import rulec
from rulec.api.pictures import drive_drawing
from rulec.extraction.recording_verdicts import DriveVerdict, RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.recordings.recording import Light
from rulec.report.pictures.drawing.canvas import Area, LabelText
from rulec.report.pictures.drawing.picture_formats import as_bytes
from rulec.report.pictures.drives import drive_page
from rulec.report.pictures.drives.drive_page import scene_data
from rulec.report.pictures.drives.drive_picture import (
    _View,
    chosen_moment,
    drive_entries,
    drive_picture,
)
from rulec.report.pictures.drives.scene_of_drive import SIGHT_M, drive_scene, nearest_points
from rulec.vocabulary.partial_values import Interval
from support.builders.recordings import recording, straight, vehicle
from support.oracles.page_policy import check_policy

HOSTILE = "</script><script>alert('x')</script>&<b>"
STATES = 9


BOOK = """\
rulebook near
use road
traffic right
hard rule following_distance (v: vehicle) {
  cite    "§ 4(1)"
  says    "Keep a distance."
  require always (behind(v) and same_lane(v) implies safe_gap(v))
}
hard rule warned { require never told_to_go }
"""


@pytest.fixture(scope="module")
def rules(tmp_path_factory):
    file = tmp_path_factory.mktemp("near") / "near.rules"
    file.write_text(BOOK, encoding="utf-8")
    return rulec.compile_rulebook(file)


def going(number, x, y, mps, **more):
    places = {step: (x + mps * 0.5 * step, y) for step in range(STATES)}
    return vehicle(number, places, speed=mps, **more)


def closing_up(name="9", side=None):
    """Car 1 at 15 m/s, 26 m behind a car at 11 m/s: 2 m less in each state.

    To stop behind it takes 15 + (225 - 121) / 16 = 21.5 m, which are left until state 2.
    """
    light = Light(0, (("green", 4), ("red", 100)))
    lanelets = [
        straight(1, -50, 60, successors=(2,), lights=(light,), limit_mps=50 / 3.6),
        straight(2, 60, 150, predecessors=(1,), limit_mps=50 / 3.6),
        straight(3, 20, 24, y=9, types=frozenset({"crosswalk"})),
        straight(4, 4000, 4100),
    ]
    far = vehicle(8, dict.fromkeys(range(STATES), (900.0, 0.0)))
    cars = [going(1, 0, 0, 15), going(name, 30, 0.5, 11), far]
    return replace(recording(lanelets, cars), side=side)


def judged(found, rules, ego="1", **wanted):
    verdicts = RecordingVerdicts(found, rules, RequestedDrives(egos=(ego,), **wanted), "by hand")
    return verdicts, next(iter(verdicts.answers()))


def scene_of(found, rules, **wanted):
    verdicts, answer = judged(found, rules, **wanted)
    kept = frozenset({"following_distance"})
    return drive_scene(answer.drive, answer.answer, verdicts, kept)


@pytest.fixture(scope="module")
def scene(rules):
    return scene_of(closing_up(), rules)


def world(scene, points):
    """Places of a scene in the recording's frame again: ego is at x = 7.5 m a state."""
    return np.asarray(points) - scene.bodies[0].poses[0, :2]


def test_everybody_in_sight(scene):
    assert [body.id for body in scene.bodies] == ["1", "9"]
    ego, other = scene.bodies
    assert world(scene, ego.poses[:, :2]) == pytest.approx(
        np.array([(7.5 * n, 0) for n in range(STATES)])
    )
    assert world(scene, other.outline(2)).min(axis=0) == pytest.approx([30 + 11 - 2, 0.5 - 1])
    assert ego.speeds[4] == pytest.approx(54)
    assert ego.outline(STATES) is None
    assert len(ego.shapes) == 1


def test_the_map(scene):
    assert [area.surface for area in scene.areas] == ["lane", "lane", "crossing"]
    assert scene.areas[0].tip == "lanelet 1, limit 50 km/h"
    (light,) = scene.lights
    assert light.colours == ((0, "green"), (4, "red"))
    assert (light.colour_at(3), light.colour_at(8)) == ("green", "red")
    assert world(scene, light.line).tolist() == [[60, 2], [60, -2]]
    (sign,) = scene.signs
    assert (sign.text, sign.name) == ("50", "limit 50 km/h")
    assert {mark.kind for mark in scene.marks} == {"unsaid"}
    # Both bounds of two lanelets; those of a crossing are none.
    assert len(scene.marks) == 4


GAP = "gap(9) 20.00±0.05 m < 21.5±0.4 m, by at least 1.1 m"


def test_a_violation_is_measured(scene):
    (violation,) = scene.violations
    assert (violation.rule, violation.state, violation.time_s) == ("following_distance", 3, 1.5)
    assert violation.measured == (f"at {violation.time_s:g} s: {GAP}",)
    assert violation.deciding_values == ("station(9) behind", "lateral(9) same_lane")
    assert violation.against == ("9",)
    assert violation.short == "hard, § 4(1), for 9"
    # The number of the picture is that of the explanation, in each state in which both are shown
    assert violation.gap_text(3) == "20.00±0.05 m"
    (sides,) = violation.narrowly.values()
    shown = [(violation.gap_text(state), text) for state, text in enumerate(sides) if text]
    assert len(shown) > 1
    assert not [both for both in shown if both[0].split()[0] != both[1].split()[0]]
    # 3 m to the side, 4 m along the road: the line is 5 m long, whatever the gap.
    aside = violation.links.copy()
    aside[3] = (0, 0, 4, 3)
    for gap, shown in (
        (4.0, "5.0 m"),
        (Interval(3.5, 4.25), "5.0 m"),
        (Interval(4, 5), "4.5±0.5 m"),
    ):
        drawn = replace(violation, links=aside, gaps=(None, None, None, gap))
        assert drawn.gap_text(3) == shown
    # From the middle of ego's front to that of the other's rear.
    assert world(scene, violation.links[3].reshape(2, 2)) == pytest.approx(
        np.array([(22.5 + 2, 0.0), (30 + 16.5 - 2, 0.5)])
    )


def test_the_moment(scene):
    (violation,) = scene.violations
    assert chosen_moment(scene, None) == (3, violation)
    assert chosen_moment(scene, 3.3) == (7, violation)
    assert chosen_moment(scene, 99) == (STATES - 1, violation)
    quiet = replace(scene, violations=())
    assert chosen_moment(quiet, None) == (STATES // 2, None)


def test_a_picture_is_right_side_up(scene):
    """What has more y is further up: the crossing is to the left of the road, which goes right."""
    picture = drive_picture(scene, 3, scene.violations[0])
    areas = {mark.style: mark for mark in picture.marks if isinstance(mark, Area)}
    tops = {style: min(y for _, y in areas[style].rings[0]) for style in ("road", "own", "against")}
    assert tops["road"] < tops["against"] < tops["own"]
    assert areas["against"].tip == "9, car, 40 km/h"
    crossing = areas["zebra"].rings[0]
    assert max(y for _, y in crossing) < tops["road"]
    texts = [mark.text for mark in picture.marks if isinstance(mark, LabelText)]
    assert {"1.5 s", "20.00±0.05 m", "1 · 54 km/h", "9 · 40 km/h"} <= set(texts)
    assert any(text.startswith("measured at ") and text.endswith(GAP) for text in texts)
    # Nothing is drawn outside of the map but words.
    for mark in picture.marks:
        if isinstance(mark, Area):
            assert all(14 <= x <= 886 for x, _ in mark.rings[0])


@pytest.mark.parametrize(("x", "is_seen"), [(30, True), (900, False)])
def test_the_legend_has_what_is_drawn(scene, x, is_seen):
    """The other car is another's body, drawn or out of the picture; so is the crossing."""
    away = np.array([x - 30, 0, 0])
    there = replace(scene.bodies[1], poses=scene.bodies[1].poses + away)
    areas = [
        replace(area, ring=area.ring + away[:2]) if area.surface == "crossing" else area
        for area in scene.areas
    ]
    found = replace(scene, bodies=(scene.bodies[0], there), areas=tuple(areas), violations=())
    entries = dict(drive_entries(found, None, drive_picture(found, 3, None)))
    assert ("vehicle" in entries, "zebra" in entries) == (is_seen, is_seen)
    assert {"own", "trail"} <= entries.keys()


def test_no_label_covers_that_of_the_scale(scene):
    """Cars stand all over the lower right; each has its label elsewhere, or none."""
    other, (x, y) = scene.bodies[1], scene.bodies[0].poses[3, :2]
    parked = [
        replace(other, id=f"{n}{k}", poses=other.poses * 0 + (x + 22 + 3 * n, y - 4 * k, 0))
        for n in range(6)
        for k in range(4)
    ]
    found = replace(scene, bodies=(scene.bodies[0], *parked), violations=())
    texts = [mark for mark in drive_picture(found, 3, None).marks if isinstance(mark, LabelText)]
    scale = next(text for text in texts if text.text in ("10 m", "20 m", "50 m"))
    left, top, right, bottom = scale.bounds
    covering = [
        text.text
        for text in texts
        if text is not scale
        and (left < text.bounds[2] and text.bounds[0] < right)
        and (top < text.bounds[3] and text.bounds[1] < bottom)
    ]
    assert covering == []


def test_a_mirrored_recording_is_drawn_as_it_was_recorded(rules, scene):
    left = scene_of(closing_up(side="left"), rules)
    assert "judged as its mirror image" in left.notes[0]
    other = world(left, left.bodies[1].poses[:, :2])
    assert other == pytest.approx(world(scene, scene.bodies[1].poses[:, :2]))
    links = [found.violations[0].links[3].reshape(2, 2) for found in (left, scene)]
    # From ego's front, 2 m before its middle at 7.5 m a state, to the other's back.
    for link, found in zip(links, (left, scene), strict=True):
        assert world(found, link)[:, 0] == pytest.approx([3 * 7.5 + 2, 30 + 3 * 5.5 - 2])


def test_who_is_far_is_not_drawn(rules):
    """A car at 40 m/s is in sight for a while."""
    fast = going(5, -SIGHT_M - 30, -0.5, 40)
    found = closing_up()
    found = replace(found, participants=(*found.participants, fast))
    (body,) = (body for body in scene_of(found, rules).bodies if body.id == "5")
    # It comes nearer by 12.5 m a state: at state 3 it is 112.5 m behind.
    assert (body.first, len(body.poses)) == (3, STATES - 3)
    data = scene_data(replace(scene_of(found, rules), bodies=(body,)))["bodies"][0]
    assert (data["first"], data["states"], data["runs"]) == (3, STATES - 3, [])


def test_nearest_points_of_turned_bodies(scene):
    """Squares of 2 m with their corners at each other: 10 m less two half diagonals."""
    ego, other = scene.bodies
    square = np.array([(1, 1), (-1, 1), (-1, -1), (1, -1)], dtype=float)
    turned = {
        "shapes": (square,),
        "shape": np.zeros(1, dtype=int),
        "first": 0,
        "speeds": np.zeros(1),
    }
    left = replace(ego, poses=np.array([[0, 0, pi / 4]]), **turned)
    right = replace(other, poses=np.array([[10, 0, pi / 4]]), **turned)
    (link,) = nearest_points(left, right, 1)
    assert link == pytest.approx([2**0.5, 0, 10 - 2**0.5, 0])
    assert np.isnan(nearest_points(left, None, 1)).all()


def test_what_is_beyond_the_view_is_cut_off():
    view = _View(left=0.0, top=10.0, scale=1.0, box=(0.0, 0.0, 10.0, 10.0))

    def seen(points):
        return [[(x, 10 - y) for x, y in part.points] for part in view.lines(points, "trail")]

    ring = np.array([(-5, -5), (5, -5), (5, 5), (-5, 5)])
    (area,) = view.area(ring, "ground")
    assert {(x, 10 - y) for x, y in area.rings[0]} == {(0, 0), (5, 0), (5, 5), (0, 5)}
    assert list(view.area(ring + 20, "ground")) == []
    zigzag = np.array([(-5, 5), (5, 5), (5, 15), (8, 15), (8, 5)])
    assert seen(zigzag) == [[(0, 5), (5, 5), (5, 10)], [(8, 10), (8, 5)]]
    circle = np.array([(5 + 4 * cos(a), 5 + 4 * sin(a)) for a in np.linspace(0, 6, 9).tolist()])
    (whole,) = seen(circle)
    assert np.array(whole) == pytest.approx(circle)


@pytest.fixture(scope="module")
def hostile_page(rules):
    verdicts, _ = judged(closing_up(HOSTILE), rules)
    drawing = drive_drawing(verdicts, kept=frozenset({"following_distance"}))
    return as_bytes(drawing, "html", "f").decode(), as_bytes(drawing, "svg", "f").decode()


def data_of(page):
    (text,) = re.findall(
        r'<script type="application/json" id="data">(.*?)</script>', page, re.DOTALL
    )
    return json.loads(text)


def test_ids_are_escaped(hostile_page):
    page, svg = hostile_page
    assert "<script>alert" not in page
    assert "<b>" not in page
    assert page.count("<script") == 2
    assert any(HOSTILE in (one.text or "") for one in ET.fromstring(svg).iter())
    assert data_of(page)["bodies"][1]["id"] == HOSTILE
    assert data_of(page)["violations"][0]["against"] == [HOSTILE]


def test_a_page_is_whole_and_fetches_nothing(hostile_page):
    page, _ = hostile_page
    assert page.startswith('<!DOCTYPE html>\n<html lang="en">')
    assert "{{" not in page
    assert not re.findall(r"url\((?!#)|@import|fetch\(|XMLHttp|\bsrc=|\bhref=", page)
    assert set(re.findall(r"https?://[^\"' ]*", page)) == {"http://www.w3.org/2000/svg"}
    ids = re.findall(r'\bid="([^"]+)"', page)
    assert len(ids) == len(set(ids))
    for name in re.findall(r'(?:byId|getElementById)\("(\w+)"\)', page):
        assert name in ids
    assert "prefers-color-scheme: dark" in page
    assert "prefers-reduced-motion" in page
    assert 'aria-label="Time"' in page
    assert 'role="status"' in page


def test_the_page_has_every_moment(scene):
    data = scene_data(scene)
    assert (data["states"], data["start"], data["step"]) == (STATES, 0, 0.5)
    ego, other = data["bodies"]
    # Differences in cm: 7.5 m a state.
    assert ego["x"][1:] == [750] * (STATES - 1)
    assert ego["y"] == [0] * STATES
    assert other["turn"] == [0] * STATES
    assert len(other["shapes"]) == 1
    (violation,) = data["violations"]
    assert violation["gaps"][:2] == ["26.00±0.05 m", "24.00±0.05 m"]
    rows = {row["title"]: (row["decides"], row["runs"]) for row in violation["rows"]}
    assert rows["safe_gap(9)"] == (True, [[2, "true", "true"], [8, "false", "off"]])
    # What stands still is there once.
    still = replace(scene.bodies[1], poses=np.tile(scene.bodies[1].poses[0], (STATES, 1)))
    assert len(scene_data(replace(scene, bodies=(still,)))["bodies"][0]["x"]) == 1


@pytest.mark.parametrize("theme", ["auto", "light", "dark"])
def test_a_page_allows_its_own_styles_and_script_alone(scene, theme):
    page = drive_page.drive_page(scene, 0, None, theme)
    check_policy(page)
    with pytest.raises(AssertionError):
        check_policy(page.replace("</script>", " alert(1)</script>"))


def test_a_theme_can_be_fixed(scene):
    page = drive_page.drive_page(scene, 0, None, "dark")
    assert '<html lang="en" data-theme="dark">' in page
    assert data_of(page)["chosen"] == -1


@pytest.mark.skipif(shutil.which("node") is None, reason="there is no Node.js")
def test_the_script_is_valid():
    script = Path(drive_page.__file__).with_name("drive_page.js")
    subprocess.run(["node", "--check", str(script)], check=True)


def test_no_such_drive(rules):
    verdicts, _ = judged(closing_up(), rules)
    with pytest.raises(rulec.RulecError, match="there is no drive `1#7`"):
        drive_drawing(verdicts, "1#7")


def test_without_an_ego_it_is_the_first_that_violates_a_rule(rules):
    # Backwards: the one that is followed stands first.
    found = closing_up()
    found = replace(found, participants=found.participants[1::-1])
    verdicts = RecordingVerdicts(found, rules, RequestedDrives(), "by hand")
    drawing = drive_drawing(verdicts, kept=frozenset({"following_distance"}))
    assert drawing.title == "made by hand, 1: 1 violation by near"


def test_without_an_ego_it_is_the_first_in_time(rules):
    # Car 5, first in the file, has to keep 20 + (400 - 225) / 16 = 31 m to car 1 and loses 2.5 m of
    # 41 m in each state: it violates from state 5 on, car 1 from state 3 on. (To car 9 it has to
    # keep 20 + (400 - 121) / 16 = 37 m and loses 4.5 m of 71 m: from state 8 on.)
    found = closing_up()
    found = replace(found, participants=(going(5, -45, 0, 20), *found.participants))
    verdicts = RecordingVerdicts(found, rules, RequestedDrives(), "by hand")
    times = {
        answer.drive.ego: [violation.step for violation in answer.answer.violations]
        for answer in verdicts.answers()
        if isinstance(answer, DriveVerdict)
    }
    assert (times["5"], times["1"]) == ([5, 8], [3])
    assert drive_drawing(verdicts).title == "made by hand, 1: 1 violation by near"


@pytest.mark.parametrize("form", ["svg", "png", "pdf", "html"])
def test_the_same_bytes_every_time(rules, form):
    pytest.importorskip("matplotlib")
    drawings = [
        rulec.draw_drive(closing_up(), rules, "1", form=form, theme="dark") for _ in range(2)
    ]
    assert drawings[0] == drawings[1]
    assert drawings[0].startswith(
        {"svg": b"<svg", "png": b"\x89PNG", "pdf": b"%PDF", "html": b"<!D"}[form]
    )
