"""Supplied values in the words of a vocabulary."""

from fractions import Fraction

from hypothesis import given
from hypothesis import strategies as st

from rulec.trace import TraceGraph
from rulec.trace.vocabulary_projection import fits, is_about, known_types, project_graph
from rulec.vocabulary import Enumeration, ObjectType, Quantity, Signal, Vocabulary

TYPES = {"road_user": None, "vehicle": "road_user", "car": "vehicle", "pedestrian": "road_user"}
STATION = Enumeration("station", ("vehicle",), ("behind", "beside"))


def vocabulary(*declarations, types=TYPES):
    return Vocabulary(
        "small",
        {name: ObjectType(name, broader) for name, broader in types.items()},
        {declaration.name: declaration for declaration in declarations},
    )


def graph(*states, objects):
    return TraceGraph(
        1.0, objects, {"p": (0, 1)}, (states,), ((),), ((),), ((),), Fraction(1), 0, (0,)
    )


def projected(state, words, objects, recorded=None):
    return project_graph(graph(state, objects=objects), words, {"station", "surface"}, recorded)


OBJECTS = {"c": "car", "p": "pedestrian"}
RECORDED = {"c": ("car", "vehicle", "road_user"), "p": ("pedestrian",), "x": ("tank", "obstacle")}


def test_the_most_specific_known_type_counts():
    assert known_types(RECORDED, vocabulary()) == {"c": "car", "p": "pedestrian"}
    small = vocabulary(types={"road_user": None})
    assert known_types(RECORDED, small) == {"c": "road_user"}


def test_a_relation_is_about_subtypes_of_its_parameter():
    words = vocabulary(STATION)
    assert is_about(STATION, "car", words)
    assert not is_about(STATION, "pedestrian", words)
    assert not is_about(STATION, "tank", words)
    assert not is_about(STATION, None, words)
    assert is_about(Signal("wet", ()), "pedestrian", words)


def test_values_fit_a_declaration_of_their_kind_and_unit():
    assert fits("limit", [50, 30.0], Quantity("limit", (), "km/h"))
    assert not fits("limit", [50], Quantity("limit", (), "m/s"))
    assert not fits("limit", [True], Quantity("limit", (), "km/h"))
    assert not fits("mass", [50], Quantity("mass", (), "km/h"))
    assert fits("wet", [True, False], Signal("wet", ()))
    assert not fits("wet", [1], Signal("wet", ()))
    assert fits("station", ["behind"], STATION)
    assert not fits("station", ["behind", "above"], STATION)


def test_of_a_written_scene_only_what_the_partition_supplies_is_left_out():
    state = {"station": {"c": "behind", "p": "beside"}, "surface": "R_cw", "written": 3.0}
    found = projected(state, vocabulary(STATION), OBJECTS)
    # `written` is the author's: validation reports it
    assert found.states == (({"station": {"c": "behind"}, "written": 3.0},),)
    assert found.objects == OBJECTS
    assert found.present == {"p": (0, 1)}


def test_a_written_type_that_the_vocabulary_lacks_stays_for_validation():
    state = {"station": {"c": "behind", "t": "beside"}}
    found = projected(state, vocabulary(STATION), {"c": "car", "t": "tank"})
    assert found.states == ((state,),)
    assert found.objects == {"c": "car", "t": "tank"}


def test_a_vocabulary_without_types_has_no_objects():
    found = projected({"surface": "R_cw"}, vocabulary(types={}), OBJECTS)
    assert (found.objects, found.present) == ({}, {})


def test_of_a_recorded_scene_all_that_is_not_declared_so_is_left_out():
    words = vocabulary(STATION, Signal("parked", ("vehicle",)), Quantity("limit", (), "m/s"))
    state = {
        "station": {"c": "behind", "p": "beside", "x": "beside"},
        "parked": {"c": True, "x": False},
        "limit": 50.0,
        "unheard_of": True,
    }
    found = projected(state, words, {"c": "?", "p": "?", "x": "?"}, RECORDED)
    assert found.states == (({"station": {"c": "behind"}, "parked": {"c": True}},),)
    assert found.objects == {"c": "car", "p": "pedestrian"}
    assert found.present == {"p": (0, 1)}


def test_a_recorded_object_that_is_not_known_is_not_present():
    small = vocabulary(types={"car": None})
    assert projected({}, small, {"c": "?", "p": "?"}, RECORDED).present == {}


def test_a_shape_other_than_the_declared_one_does_not_fit():
    words = vocabulary(Signal("parked", ()), Signal("wet", ("vehicle",)))
    state = {"parked": {"c": True}, "wet": True}
    assert projected(state, words, {"c": "?"}, RECORDED).states == (({},),)


@given(st.dictionaries(st.sampled_from("cp"), st.sampled_from(["behind", "beside"])))
def test_values_that_states_share_stay_shared_and_projecting_again_changes_nothing(relation):
    words = vocabulary(STATION)
    traces = graph({"station": relation}, {"station": relation}, objects=OBJECTS)
    once = project_graph(traces, words, {"station"})
    first, second = once.states[0]
    assert first["station"] is second["station"]
    assert project_graph(once, words, {"station"}).states == once.states
