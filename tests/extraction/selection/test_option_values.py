"""Assumptions and thresholds from texts."""

import re
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.extraction.traces.assumed_values import assumption_options
from rulec.extraction.traffic_thresholds import USUAL, Thresholds, threshold_options
from rulec.vocabulary import Enumeration, ObjectType, Quantity, Signal, Vocabulary

WORDS = Vocabulary(
    "road",
    {"vehicle": ObjectType("vehicle")},
    {
        "built_up": Signal("built_up", ()),
        "light": Enumeration("light", (), ("red_light", "green_light")),
        "limit": Quantity("limit", (), "km/h"),
        "gap": Quantity("gap", ("vehicle",), "m"),
    },
)


@pytest.mark.parametrize(
    ("text", "name", "value"),
    [
        ("built_up=true", "built_up", True),
        (" built_up = false ", "built_up", False),
        ("light=red_light", "light", "red_light"),
        ("limit=0", "limit", 0.0),
        ("limit=50 km/h", "limit", 50.0),
        ("limit=10 m/s", "limit", 36.0),
        ("limit=30 mph", "limit", float(30 * Fraction("1.609344"))),
        ("limit=-2.5 km/h", "limit", -2.5),
    ],
)
def test_values_in_their_unit_or_another(text, name, value):
    assert assumption_options([text], WORDS) == {name: value}


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("built_up", "`built_up` is not written as in `built_up=true`"),
        ("=true", "`=true` is not written as in `built_up=true`"),
        ("built_up=", "`built_up=` is not written as in `built_up=true`"),
        ("built_up=yes", "`built_up` is `true` or `false`, not `yes`"),
        ("light=blue", "`light` is one of `red_light`, `green_light`, not `blue`"),
        ("limit=fast", "`limit` is a number such as `50 km/h`, not `fast`"),
        ("limit=50", "`limit` is in km/h: write the unit, such as `limit=50 km/h`"),
        ("limit=50 m", "`limit` is a number such as `50 km/h`, not `50 m`"),
        ("gap=5 m", "`gap` is about objects; assume only words that are not"),
        ("buildup=true", "`road` does not know `buildup`; did you mean `built_up`?"),
    ],
)
def test_what_is_wrong_with_an_assumption(text, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        assumption_options([text], WORDS)


def test_the_last_of_several_texts_counts():
    assert assumption_options(["limit=30 km/h", "limit=50 km/h"], WORDS) == {"limit": 50.0}


def test_thresholds_change_what_is_named_and_nothing_else():
    found = threshold_options(["near_m=200", "fewest=4"])
    assert (found.near_m, found.fewest) == (200.0, 4)
    assert isinstance(found.fewest, int)
    assert found == Thresholds(near_m=200.0, fewest=4)
    assert threshold_options([]) == USUAL


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("near_m", "`near_m` is not written as in `near_m=200`"),
        ("nearm=2", "there is no threshold `nearm`"),
        ("near_m=-1", "`near_m` is a number from 0 to 1,000,000 without a unit, in m, not `-1`"),
        ("near_m=inf", "from 0 to 1,000,000 without a unit, in m, not `inf`"),
        ("near_m=200m", "from 0 to 1,000,000 without a unit, in m, not `200m`"),
        ("smoothing_s=1e308", "from 0 to 1,000,000 without a unit, in s, not `1e308`"),
        ("standing_kmh=slow", "from 0 to 1,000,000 without a unit, in km/h, not `slow`"),
        ("fewest=2.5", "`fewest` is a whole number, not `2.5`"),
    ],
)
def test_what_is_wrong_with_a_threshold(text, message):
    with pytest.raises(ValueError, match=re.escape(message)):
        threshold_options([text])


@given(st.floats(0, 1e6))
def test_numbers_come_back_as_written(number):
    assert threshold_options([f"zone_m={number!r}"]).zone_m == number
