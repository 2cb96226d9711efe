"""Among participants of unknown type, what is known of candidates is so whatever they are."""

import os
from functools import cache

import numpy as np
import pytest

import rulec

T = np.arange(0, 12.05, 0.1)
KINDS = ("car", "bicycle", "pedestrian")
AHEAD = 0.1 * np.arange(1, 81)

BOOK = """\
rulebook zebra
use road
hard rule let_across (p: pedestrian) {
  require never (on_crossing(p) and distance_to_crossing < 30 m and speed > 30 km/h)
}
hard rule without_reason {
  require always (speed > 40 km/h implies some p: pedestrian (on_crossing(p)))
}
hard rule speeding { require never (speed > 40 km/h) }
"""


@cache
def book():
    return rulec.compile(rulec.parse_rulebook(BOOK))


def world(kind, at=102.0):
    """Ego drives at 43 km/h towards a zebra, onto which somebody goes and stays."""
    road = rulec.build_lanelet("road", [(0, 0), (600, 0)], limit_mps=13.9, types=["urban"])
    zebra = rulec.build_lanelet("zebra", [(at, -6), (at, 6)], types=["crosswalk"], width=4.0)
    now = T[T < 2.05]
    ego = rulec.build_participant("ego", "car", now, 10 + 12 * now, 0 * now, step_s=0.1)
    y = (-5 + 1.2 * (T - 3)).clip(-9, 0)
    size = {"length": 0.6, "width": 0.6, "heading": 0 * T + np.pi / 2}
    other = rulec.build_participant("x", kind, T, at + 0 * T, y, step_s=0.1, **size)
    made = rulec.build_recording([road, zebra], [ego, other], step_s=0.1, side="right")
    return rulec.TrafficWorld(made, "ego")


def going_on(speed):
    gone = speed * AHEAD
    return np.column_stack((34 + gone, 0 * gone, 0 * gone, speed + 0 * gone))


CANDIDATES = np.array([going_on(speed) for speed in (12.0, 9.0, 4.0)])


def outcomes(kind, rules, at=102.0, **after):
    found = rulec.score(CANDIDATES, world(kind, at), rules, **after)
    return {rule.name: found.outcomes(rule.name) for rule in found.rules.rules}


@pytest.mark.parametrize("rules", [None, "de"])
@pytest.mark.parametrize("with_past", [True, False])
def test_what_is_known_is_so_whatever_they_are(rules, with_past):
    rules = rules or book()
    after = {"after": world("unknown").past} if with_past else {}
    typed = [outcomes(kind, rules, **after) for kind in KINDS]
    unknown = outcomes("unknown", rules, **after)
    for rule, found in unknown.items():
        for number, outcome in enumerate(found):
            if outcome in ("kept", "violated"):
                assert {own[rule][number] for own in typed} == {outcome}, (rule, number)


def test_nobody_drives_surely_lawfully_past_who_may_be_a_pedestrian():
    made = world("unknown")
    found = rulec.score(CANDIDATES, made, "de", after=made.past)
    assert found.outcomes("give_way_to_pedestrians")[0] == "open"
    assert not found.allowed[0]
    assert "pedestrian" in {name for one in found.candidates[0].open for name in one.depends_on}
    (answer,) = rulec.verify_recording(
        made.recording_of(CANDIDATES[0], made.past), "de", rulec.RequestedDrives(("ego",))
    ).answers()
    assert [*found.candidates[0].open] == [*answer.answer.open]


def test_what_the_past_has_violated_is_anew_whatever_they_are():
    """At first nobody is on the crossing, then one who may be a reason for ego's speed."""
    made = world("unknown", at=190.0)
    found = rulec.score(CANDIDATES, made, book(), after=made.past)
    assert "without_reason" in {one.rule for one in found.violated_before}
    typed = [outcomes(kind, book(), 190.0, after=made.past)["without_reason"] for kind in KINDS]
    assert typed == [["violated", "kept", "kept"]] * 2 + [["kept"] * 3]
    assert found.outcomes("without_reason") == ["open", "kept", "kept"]
    (doubtful,) = [one for one in found.candidates[0].open if one.rule == "without_reason"]
    assert doubtful.depends_on == ("pedestrian",)


def test_many_candidates_are_judged_as_each_by_itself():
    made = world("unknown")
    times = 400 if os.environ.get("RULEC_TEST_PROFILE") == "long" else 40
    many = np.concatenate([CANDIDATES] * times)
    found = rulec.score(many, made, book(), after=made.past)
    few = rulec.score(CANDIDATES, made, book(), after=made.past)
    assert found.penalties_at_most.tolist() == few.penalties_at_most.tolist() * times
    for one, other in zip(found.candidates[-3:], few.candidates, strict=True):
        assert (one.violations, one.open, one.late) == (other.violations, other.open, other.late)
