"""From the signals of a drive to its trace."""

import pytest

from rulec.extraction.traces.to_trace import TraceWriter, to_traces
from rulec.vocabulary import Enumeration, ObjectType, Quantity, Signal, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.drive_contexts import context_of, steady
from support.builders.recordings import recording, straight, vehicle
from support.generators.random_recordings import lanes


def vocabulary(*declarations, types=None):
    known = types or {"road_user": None, "vehicle": "road_user", "car": "vehicle"}
    return Vocabulary(
        "small",
        {name: ObjectType(name, broader) for name, broader in known.items()},
        {declaration.name: declaration for declaration in declarations},
    )


def drive(*others, writer=None, ego=None):
    found = recording(lanes(2), [ego or steady(7, 0, 0, first=2), *others])
    (one,) = to_traces(context_of(found), ["7"], ["7#2"], writer or TraceWriter())
    return one


def test_a_drive_begins_when_ego_is_there():
    found = drive()
    assert (found.ego, found.trace.id, found.start_s) == ("7", "7#2", 1.0)
    assert (found.trace.step_s, len(found.trace.states)) == (0.5, 4)
    assert found.time_s(0) == 1.0
    assert found.time_s(3) == found.time_s(None) == 2.5


def test_without_a_vocabulary_objects_have_their_most_specific_types():
    found = drive(steady(8, 20, 0, steps=6), steady(9, 30, 4, kind="bicycle", steps=6))
    assert found.trace.objects == {"8": "car", "9": "cyclist"}
    assert found.trace.present == {}
    assert set(found.trace.states[0]["gap"]) == {"8", "9"}


def test_presence_is_counted_in_states_of_the_drive():
    found = drive(steady(8, 20, 0, first=3, steps=2))
    assert found.trace.present == {"8": (1, 2)}
    assert ["8" in state.get("gap", {}) for state in found.trace.states] == [
        False,
        True,
        True,
        False,
    ]


def test_the_types_and_names_are_those_of_the_vocabulary():
    words = vocabulary(
        Quantity("gap", ("vehicle",), "m"),
        Signal("stopped", ("vehicle",)),
        Quantity("speed", (), "km/h"),
    )
    others = [steady(8, 20, 0, steps=6, kind="truck"), steady(9, 30, 4, kind="bicycle", steps=6)]
    found = drive(*others, writer=TraceWriter(words))
    # Ego sets out after a second, when the truck is at 30 m. A truck is a vehicle; a cyclist is
    # no more than a road user, of whom `gap` says nothing
    assert found.trace.objects == {"8": "vehicle", "9": "road_user"}
    # Speeds are known to 0.1 m/s, over half a second to twice as much, and places to 0.05 m
    assert found.trace.states[0] == {
        "speed": Interval(35.28, 36.72),
        "gap": {"8": Interval(25.95, 26.05)},
        "stopped": {"8": False},
    }
    assert found.words == {"gap", "stopped", "speed"}
    assert found.kinds == {"gap": float, "stopped": bool, "speed": float}


@pytest.mark.parametrize(
    "declaration",
    [
        Quantity("speed", (), "m/s"),
        Signal("speed", ()),
        Quantity("speed", ("vehicle",), "km/h"),
        Enumeration("speed", (), ("slow", "fast")),
    ],
)
def test_a_name_that_means_something_else_is_left_out(declaration):
    assert drive(writer=TraceWriter(vocabulary(declaration))).trace.states[0] == {}


def test_surfaces_are_spelled_as_the_vocabulary_does():
    own = vocabulary(Enumeration("surface", (), ("carriageway", "crossing", "junction")))
    assert drive(writer=TraceWriter(own)).trace.states[0] == {"surface": "carriageway"}
    paper = vocabulary(Enumeration("surface", (), ("R_cw", "R_pc")))
    assert drive(writer=TraceWriter(paper)).trace.states[0] == {"surface": "R_cw"}


def test_only_the_names_asked_for_are_written():
    words = vocabulary(Quantity("speed", (), "km/h"), Signal("braking_hard", ()))
    found = drive(writer=TraceWriter(words, frozenset({"speed", "gap"})))
    assert found.trace.states[1] == {"speed": Interval(35.64, 36.36)}


def test_with_defaults_numbers_are_as_measured():
    words = vocabulary(Quantity("speed", (), "km/h"))
    found = drive(writer=TraceWriter(words, defaults=True))
    assert [dict(state) for state in found.trace.states] == [{"speed": 36.0}] * 4


def test_what_is_known_exactly_is_a_number():
    words = vocabulary(Quantity("speed", (), "km/h"))
    states = drive(writer=TraceWriter(words), ego=steady(7, 0, 0, speed=0.1)).trace.states
    assert [dict(state) for state in states] == [{"speed": 0.0}] * 4


def test_assumptions_hold_in_every_state_whatever_was_recorded():
    assumed = {"speed": 5.0, "built_up": True}
    words = vocabulary(Quantity("speed", (), "km/h"), Signal("built_up", ()))
    found = drive(writer=TraceWriter(words, assumed=assumed))
    assert [dict(state) for state in found.trace.states] == [assumed] * 4
    assert found.kinds == {"speed": float, "built_up": bool}


def test_what_is_not_known_in_a_state_is_unknown_there():
    highway = straight(1, 0, 10, successors=(2,), types=frozenset({"highway"}))
    body = vehicle(7, {0: (5, 0), 1: (15, 0)})
    found = recording([highway, straight(2, 10, 90, predecessors=(1,))], [body])
    (one,) = to_traces(context_of(found, ("1", "2")), ["7"], ["7"], TraceWriter())
    states = one.trace.states
    assert [state["road_class"] for state in states] == ["motorway", UNKNOWN]
