"""What books say of a pass that was under way when a recording began."""

import pytest

import rulec

SIDES = {"beside": 0.0, "behind": 1.0, "in_front_of": 0.0}


def state(station, *, headway_s=None, lateral="right_of", **words):
    seconds = SIDES[station] if headway_s is None else headway_s
    about = {"station": station, "lateral": lateral, "time_headway": seconds, "turning_far": False}
    return {**{name: {"v": value} for name, value in about.items()}, "speed": 60.0, **words}


PASSED = state("beside"), state("in_front_of")


@pytest.mark.parametrize("book", ["kr", "cn"])
@pytest.mark.parametrize(
    ("first", "outcome"),
    [
        # Who is on the right of another one at first may have left its lane for that just before
        ((state("beside"),), "open"),
        ((state("behind"),), "open"),
        # Too far behind to pull out because of it
        ((state("behind", headway_s=9.0), state("behind", headway_s=2.0)), "kept"),
        ((state("behind", lateral="same_lane"), state("behind", lane_change=True)), "violated"),
    ],
    ids=["beside", "behind", "far behind", "leaves its lane"],
)
def test_who_is_at_the_side_of_another_at_first_may_have_left_its_lane(book, first, outcome):
    trace = rulec.Trace("t", 1.0, {"v": "car"}, (*first, *PASSED), ends="cut")
    verdict = rulec.verify(trace, book)
    named = {
        "violated": {one.rule for one in verdict.violations},
        "open": {one.rule for one in verdict.open},
    }
    found = [name for name, rules in named.items() if "near_side_passing" in rules]
    assert found == ([] if outcome == "kept" else [outcome])
