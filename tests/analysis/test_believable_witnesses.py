"""Witnesses that a lawyer believes: a car can drive each, on a road that there can be."""

from itertools import combinations

import pytest

from rulec import Session
from rulec.analysis.believable_states import declarations_read
from rulec.analysis.shared_vocabulary import shared_vocabulary
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from rulec.rulebook.rules.rule_topics import on_topic
from rulec.trace import Trace
from support.oracles.drivable_traces import doubts

TOPICS = {
    "overtaking": ("de", "fr", "gb"),
    "distance": ("fr", "jp", "us-ca"),
    "speed": ("de", "vienna", "us-ca"),
    "lanes": ("de", "gb", "jp"),
    "turning": ("fr", "us-ca", "vienna"),
    "priority": ("de", "fr", "gb"),
    "signals": ("jp", "us-ca", "de"),
    "pedestrians": ("gb", "us-ca", "fr"),
    "motorways": ("vienna", "fr", "jp"),
    "emergencies": ("de", "us-ca", "gb"),
}
COMPARISONS = [(topic, *pair) for topic, books in TOPICS.items() for pair in combinations(books, 2)]
QUICK = [
    ("distance", "jp", "us-ca"),
    ("turning", "us-ca", "vienna"),
    ("signals", "jp", "de"),
    ("pedestrians", "us-ca", "fr"),
]

DOUBTFUL = {
    # The two differ only where one is driven into at the same time as the other: some maps show a
    # roundabout as a junction.
    "indicator_when_turning: vienna forbids, fr allows": [
        "0: drives into a junction and a roundabout"
    ],
}


def check(topic, first, second):
    books = on_topic([load_rulebook(first), load_rulebook(second)], topic)
    shared = {rule.name for rule in books[0].rules} & {rule.name for rule in books[1].rules}
    if not shared:
        return
    diff = Session(()).diff(first, second, patterns=sorted(shared), witnesses=3)
    words = shared_vocabulary(diff.first.vocabulary, diff.second.vocabulary).vocabulary
    for pair in diff.pairs:
        comparison = pair.comparison
        assert not comparison.undecided
        names = frozenset[str]().union(*map(declarations_read, pair.machines))
        for trace in (*comparison.first_forbids, *comparison.second_forbids):
            found = doubts(trace, names, words)
            assert found == DOUBTFUL.get(trace.id, []), trace.states


@pytest.mark.parametrize("comparison", QUICK, ids="-".join)
def test_some_witnesses_can_be_driven(comparison):
    check(*comparison)


@pytest.mark.long
@pytest.mark.parametrize("comparison", COMPARISONS, ids="-".join)
def test_all_witnesses_of_ten_topics_can_be_driven(comparison):
    check(*comparison)


ROAD = parse_rulebook("rulebook r use road soft rule r { require true }").vocabulary


@pytest.mark.parametrize(
    ("states", "doubt"),
    [
        ([{"surface": "crossing"}], "at a crossing that is 1000.0 m away"),
        ([{"speed": 0.0, "crosses_light_line": True}], "crosses_light_line while it stands"),
        ([{"speed": 90.0}, {"speed": 20.0}], "from 90.0 to 20.0 km/h"),
        (
            [{"speed": 36.0, "distance_to_crossing": d} for d in (30.0, 30.0)],
            "distance_to_crossing from 30.0 to 30.0 m",
        ),
        (
            [{"speed": 36.0, "time_to_stop_line": t} for t in (3.0, 3.0)],
            "the line 3.0 s away, then 3.0 s",
        ),
        ([{"lanes": "two_lanes"}, {}], "lanes from two_lanes to one_lane"),
        ([{"station": {"v": s}} for s in ("behind", "in_front_of")], "past another one"),
        ([{"safe_gap": {"v": False}, "speed": 20.0}], "too near at 1000.0 m"),
        ([{"lane": "far_lane"}], "on the far_lane of one lane"),
        ([{"speed_difference": {"v": 30.0}, "speed": 20.0}], "goes ego's way at -10.0 km/h"),
    ],
)
def test_what_cannot_be_driven_is_doubted(states, doubt):
    usual = {"speed": 36.0, "can_stop_at_once": False, "light": "green_light"}
    own = {"station": {"v": "behind"}, "lateral": {"v": "right_of"}}
    trace = Trace("t", 1.0, {"v": "vehicle"}, tuple({**usual, **own, **state} for state in states))
    names = {*own, *(name for state in states for name in state)} | {"oncoming", "speed", "gap"}
    names |= {"distance_to_crossing", "lanes"}
    assert any(doubt in found for found in doubts(trace, names, ROAD))


def test_what_can_be_driven_is_not_doubted():
    way = [(30.0, 3.0), (20.0, 2.0), (10.0, 1.0)]
    states = tuple(
        {
            "speed": 36.0,
            "distance_to_crossing": metres,
            "time_to_stop_line": seconds,
            "light": light,
            "station": {"v": station},
            "lateral": {"v": "left_of"},
            "lanes": "two_lanes",
        }
        for (metres, seconds), light, station in zip(
            way,
            ("green_light", "green_light", "amber_light"),
            ("behind", "beside", "in_front_of"),
            strict=True,
        )
    )
    trace = Trace("t", 1.0, {"v": "vehicle"}, states)
    assert doubts(trace, {*states[0], "oncoming", "driving_side", "on_shoulder"}, ROAD) == []
