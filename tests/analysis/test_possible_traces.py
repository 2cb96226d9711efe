"""Witnesses that could happen: few changes, and numbers that a road has."""

from itertools import pairwise

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec import Session
from rulec.analysis.believable_states import MOST_KMH
from rulec.analysis.possible_traces import steadied
from rulec.monitoring.state_view import value_in
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace

VOCABULARY = parse_rulebook("""
rulebook street
type car
signal dark, wet default false
signal brakes(c: car) default false
lane is one of left, middle, right default middle
hard rule r { require never dark }
""").vocabulary
LANES = ("left", "middle", "right")


def traces(n_states):
    states = st.fixed_dictionaries(
        {},
        optional={
            "dark": st.booleans(),
            "lane": st.sampled_from(LANES),
            "brakes": st.fixed_dictionaries({"a": st.booleans(), "b": st.booleans()}),
        },
    )
    objects = {"a": "car", "b": "car"}
    return st.builds(
        lambda own: Trace("t", 1.0, objects, tuple(own)),
        st.lists(states, min_size=1, max_size=n_states),
    )


def said(trace, name, items=()):
    declaration = VOCABULARY.declarations[name]
    return [value_in(state, name, items, declaration) for state in trace.states]


def changes(trace):
    subjects = [("dark", ()), ("lane", ()), ("brakes", ("a",)), ("brakes", ("b",))]
    values = [said(trace, *subject) for subject in subjects]
    return sum(a != b for own in values for a, b in pairwise(own))


@given(traces(5), st.data())
def test_values_change_less_and_what_is_to_be_shown_stays(trace, data):
    place = data.draw(st.integers(0, len(trace.states) - 1))
    name = data.draw(st.sampled_from(["dark", "lane"]))

    def is_right(other):
        return all(said(other, name)[at] == said(trace, name)[at] for at in (0, place))

    calmer = steadied(trace, VOCABULARY, is_right)
    assert is_right(calmer)
    assert changes(calmer) <= changes(trace)
    assert len(calmer.states) == len(trace.states)
    # All that need not change is the same throughout, and what must change changes once
    for other in {"dark", "lane"} - {name}:
        assert len(set(said(calmer, other))) == 1
    if len(trace.states) <= 3 or said(trace, name)[0] == said(trace, name)[place]:
        assert changes(calmer) == (said(trace, name)[0] != said(trace, name)[place])


def test_a_value_of_one_object_changes_by_itself():
    states = ({"brakes": {"a": True}}, {"brakes": {"b": True}}, {"brakes": {"a": True}})
    trace = Trace("t", 1.0, {"a": "car", "b": "car"}, states)
    calmer = steadied(trace, VOCABULARY, lambda other: said(other, "brakes", ("b",))[1])
    assert said(calmer, "brakes", ("a",)) == [True, True, True]
    assert said(calmer, "brakes", ("b",)) == [True, True, True]


SLOW = {"road_class", "built_up", "lane_kind", "marked_lanes", "two_wheeled", "light"}


@pytest.mark.parametrize("rule", ["near_side_passing", "lateral_gap", "give_way_to_pedestrians"])
@pytest.mark.parametrize("second", ["fr", "gb"])
def test_roads_and_speeds_of_witnesses(rule, second):
    diff = Session(()).diff("de", second, patterns=[rule])
    tables = [table for pair in diff.pairs for *_, table in diff.tables(pair)]
    assert tables
    for table in tables:
        for row in table.rows:
            if row.title in SLOW:
                assert len(set(row.values)) == 1, row
            if row.unit == "km/h" and not row.is_default:
                assert all(0 <= value <= MOST_KMH for value in row.values)


@pytest.mark.parametrize(
    ("books", "rule", "relation"),
    [
        # A count of the counted object itself tests its type; a constant of an object has one value
        (("vienna", "se"), "near_side_passing", "stricter"),
        (("fr", "se"), "overtaking_without_sight", "stricter"),
        # Whoever is not counted is not looked at
        (("us", "us-fl"), "junction_overtaking_past_cycles", "stricter"),
    ],
)
def test_rules_that_were_too_much_at_once_are_decided(books, rule, relation):
    (pair,) = Session(()).diff(*books, patterns=[rule]).pairs
    assert (pair.relation, pair.comparison.undecided) == (relation, "")
