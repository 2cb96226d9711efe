"""Participants of unknown type: what a rule about their type would say of them is open."""

from functools import cache

import numpy as np
import pytest

import rulec
from rulec.extraction.possible_types import PossibleTypes
from rulec.recordings.mending.mended_recording import mended
from rulec.report.verdicts.recording_answer import AnswerLayout, RecordingAnswer
from rulec.report.verdicts.violation_tally import ViolationTally

T = np.arange(0, 12.05, 0.1)
KINDS = ("vehicle", "bicycle", "pedestrian")

BOOK = """\
rulebook zebra
use road
hard rule let_across (p: pedestrian) {
  require never (on_crossing(p) and distance_to_crossing < 30 m and speed > 30 km/h)
}
hard rule nobody {
  require never (count p: pedestrian (not not_crossing(p)) >= 1 and speed > 30 km/h)
}
hard rule nobody_at_all { require never (some p: pedestrian (on_crossing(p))) }
hard rule some_reason {
  require always (distance_to_crossing < 10 m implies some p: pedestrian (not not_crossing(p)))
}
hard rule distance (v: vehicle) { require never (behind(v) and gap(v) < 10 m) }
hard rule others (o: road_user) { require never (behind(o) and gap(o) < 10 m) }
"""


@cache
def book():
    return rulec.compile(rulec.parse_rulebook(BOOK))


def scene(kind, *, farther=0.0, side="right", standing=False):
    """Ego drives at 43 km/h over a zebra, onto which somebody goes from its right meanwhile."""
    road = rulec.build_lanelet("road", [(0, 0), (600, 0)], limit_mps=13.9, types=["urban"])
    zebra = rulec.build_lanelet("zebra", [(102, -6), (102, 6)], types=["crosswalk"], width=4.0)
    bodies = [rulec.build_participant("ego", "car", T, 10 + 12 * T, 0 * T, step_s=0.1)]
    if kind:
        y = (-5 + 1.2 * (T - 3)).clip(-5, 8) if not standing else 0 * T - 5
        size = {"length": 0.6, "width": 0.6, "heading": 0 * T + np.pi / 2}
        x = 102 + farther + 0 * T
        bodies.append(rulec.build_participant("x", kind, T, x, y, step_s=0.1, **size))
    return rulec.build_recording([road, zebra], bodies, step_s=0.1, side=side)


def verdicts(kind, rules=None, **how):
    """Rule -> how it comes out, and for an open one on what it depends."""
    wanted = rulec.RequestedDrives(("ego",), as_recorded=True)
    recorded = rulec.verify_recording(scene(kind, **how), rules or book(), wanted=wanted)
    (answer,) = recorded.answers()
    found = {violation.rule: "violated" for violation in answer.answer.violations}
    found |= {rule.rule: "not judged" for rule in answer.answer.not_judged}
    return found | {part.rule: part.depends_on for part in answer.answer.open}


def test_who_may_be_a_pedestrian_may_have_to_be_let_across():
    assert verdicts("pedestrian")["let_across"] == "violated"
    assert "let_across" not in verdicts("bicycle")
    assert verdicts("unknown")["let_across"] == ("pedestrian",)


def test_crowds_of_what_may_be_pedestrians():
    assert verdicts("pedestrian")["nobody"] == "violated"
    found = verdicts("unknown")
    assert (found["nobody"], found["nobody_at_all"]) == (("pedestrian",), ("pedestrian",))


def test_who_may_be_the_reason_may_excuse():
    assert verdicts("bicycle")["some_reason"] == "violated"
    assert "some_reason" not in verdicts("pedestrian")
    assert verdicts("unknown")["some_reason"] == ("pedestrian",)


@pytest.mark.parametrize("kind", [None, "unknown"])
def test_who_is_far_away_opens_nothing(kind):
    assert verdicts(kind, farther=300.0) == verdicts(None)


def test_who_stands_beside_the_road_has_to_be_let_across_by_nobody():
    found = verdicts("unknown", "de", farther=40.0, standing=True)
    assert found == verdicts(None, "de")


def test_rules_about_all_road_users_know_it():
    found = {kind: verdicts(kind).get("others") for kind in (*KINDS, "unknown")}
    assert len(set(found.values())) == 1


@pytest.mark.parametrize("rules", [None, "de"])
def test_what_is_known_is_so_whatever_it_is(rules):
    """What no type would break is kept, and what every type breaks is violated."""
    typed = {kind: verdicts(kind, rules) for kind in KINDS}
    unknown = verdicts("unknown", rules)
    for rule in {rule for found in (*typed.values(), unknown) for rule in found}:
        each = {found.get(rule, "kept") for found in typed.values()}
        if unknown.get(rule, "kept") in ("kept", "violated"):
            assert each == {unknown.get(rule, "kept")}
    assert any(isinstance(names, tuple) and "pedestrian" in names for names in unknown.values())


def test_the_answer_names_the_types_on_request():
    recorded = rulec.verify_recording(scene("unknown"), book())
    tally = ViolationTally()
    for answer in recorded.answers():
        tally.add(answer, [rule.name for rule in book().rules])
    answer = RecordingAnswer(recorded, tally, {}, AnswerLayout(80, why=True))
    assert "pedestrian" in answer.as_text()


def test_defaults_leave_nothing_open():
    request = rulec.RequestedDrives(("ego",), defaults=True)
    (answer,) = rulec.verify_recording(scene("unknown"), book(), wanted=request).answers()
    assert answer.answer.open == ()


@pytest.mark.parametrize(("mps", "kinds"), [(1.4, [*KINDS]), (10.0, ["vehicle", "bicycle"])])
def test_nobody_walks_so_fast(mps, kinds):
    road = rulec.build_lanelet("road", [(0, 0), (600, 0)])
    some = rulec.build_participant("x", "unknown", T, mps * T, 0 * T, step_s=0.1)
    recording = mended(rulec.build_recording([road], [some], step_s=0.1))
    assert [x.participants[0].type for x in PossibleTypes(recording).recordings()] == kinds
