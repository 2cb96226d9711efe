"""Motion forecasting scenarios, written here and thought out by hand."""

from dataclasses import replace

import numpy as np
import pytest

from rulec import compile_rulebook, read_recording
from rulec.diagnostics import RulecError
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.extraction.tracks.source_tolerances import tolerances_of
from rulec.recordings.recording import Participant, Recording, StatedError, TrackState
from support.builders.argoverse_files import SCENARIO_ID, rows_of, town, write_map, write_motion
from support.builders.recordings import lanelet, rectangle, straight

STEPS = range(50)
DRIVER = {step: (10 + step, -1.75) for step in STEPS}
"""At 10 m/s along the left lane of two, over the crossing at 38 m and 3 s."""
WALKER = {step: (40, -9 + 0.15 * step) for step in STEPS}
"""On the crossing at 1.5 m/s from 0.7 s on."""
LEAVER = {step: (5 + step, -1.75 + min(3.5, max(0.0, 0.1 * (step - 10)))) for step in STEPS}
"""5 m behind the driver, and over the double yellow line to its left."""


def rows():
    return [
        *rows_of("AV", "vehicle", DRIVER),
        *rows_of("77", "pedestrian", WALKER, heading=float(np.pi / 2), velocity_x=0.0),
        *rows_of("78", "vehicle", LEAVER),
    ]


@pytest.fixture
def scene(tmp_path):
    return read_recording(write_motion(tmp_path, rows()))


def test_a_scenario_is_recognised_by_its_name_or_its_folder(tmp_path, scene):
    assert scene.name == read_recording(tmp_path).name == SCENARIO_ID
    assert (scene.form, scene.step_s) == ("Argoverse 2 motion forecasting", 0.1)
    assert (scene.ego, scene.side, scene.country) == ("AV", "right", "USA")
    assert "usual" in scene.remarks[0]


def test_a_track_is_as_it_is_in_the_table(scene):
    ego, walker, _ = scene.participants
    assert list(ego.states) == list(STEPS)
    assert ego.states[7] == TrackState(17.0, -1.75, 0.0, 10.0, 0.0)
    assert (walker.id, walker.type, list(walker.states)) == ("77", "pedestrian", list(STEPS))
    assert ego.lamps == {}
    assert ego.shows == frozenset()


def test_speeds_are_signed_along_the_heading(tmp_path):
    backwards = rows_of("9", "vehicle", {0: (0, 0), 1: (-1, 0)}, velocity_x=-10.0)
    (only,) = read_recording(write_motion(tmp_path, backwards)).participants
    assert [state.speed for state in only.states.values()] == [-10.0, -10.0]


def test_the_type_of_most_states_counts(tmp_path):
    rows = rows_of("9", "vehicle", {k: (k, 0) for k in range(5)})
    for row, kind in zip(rows, ("cyclist", "bus", "bus", "cyclist", "bus"), strict=True):
        row["object_type"] = kind
    (only,) = read_recording(write_motion(tmp_path, rows)).participants
    assert only.type == "bus"


def test_accelerations_are_changes_of_speed(tmp_path):
    places = {0: (0, 0), 1: (1, 0), 3: (3, 0)}
    faster = rows_of("9", "vehicle", places)
    for row, speed in zip(faster, (10.0, 11.0, 13.0), strict=True):
        row["velocity_x"] = speed
    (only,) = read_recording(write_motion(tmp_path, faster)).participants
    assert [state.acceleration for state in only.states.values()] == pytest.approx([10.0] * 3)


def test_sizes_are_usual_ones_but_egos_is_known(scene):
    ego, walker, other = scene.participants
    assert np.ptp(ego.outlines[0], axis=0) == pytest.approx([4.877, 2.0])
    assert np.ptp(other.outlines[0], axis=0) == pytest.approx([4.6, 1.9])
    assert np.ptp(walker.outlines[0], axis=0) == pytest.approx([0.7, 0.7])
    assert ego.stated_error is None
    assert walker.stated_error == other.stated_error == StatedError(0.3, 0.0)
    # Two bodies may be off
    assert tolerances_of(scene).place_m == pytest.approx(0.6)


@pytest.mark.parametrize(
    ("kind", "type_"),
    [
        ("vehicle", ("vehicle", "road_user", "obstacle")),
        ("bus", ("bus", "vehicle", "road_user", "obstacle")),
        ("motorcyclist", ("motorcycle", "vehicle", "road_user", "obstacle")),
        ("cyclist", ("cyclist", "light_rider", "vulnerable_user", "road_user", "obstacle")),
        ("pedestrian", ("pedestrian", "vulnerable_user", "road_user", "obstacle")),
        ("riderless_bicycle", ("obstacle",)),
        ("static", ("obstacle",)),
        ("background", ("obstacle",)),
        ("construction", ("obstacle",)),
        ("unknown", ("road_user", "obstacle")),
    ],
)
def test_types_of_objects(tmp_path, kind, type_):
    (only,) = read_recording(write_motion(tmp_path, rows_of("9", kind, {0: (0, 0)}))).participants
    assert only.object_types == type_


def test_without_its_car_there_is_no_ego(tmp_path):
    found = read_recording(write_motion(tmp_path, rows_of("9", "vehicle", {0: (0, 0)})))
    assert found.ego == ""


def test_rows_may_be_in_any_order(tmp_path, scene):
    found = read_recording(write_motion(tmp_path, rows()[::-1]))
    tracks = {x.id: list(x.states.items()) for x in found.participants}
    assert tracks == {x.id: list(x.states.items()) for x in scene.participants}


def test_the_map_may_lie_elsewhere(tmp_path, scene):
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    path = write_motion(tmp_path, rows())
    for file in tmp_path.glob("*.json"):
        file.unlink()
    content = town()
    del content["lane_segments"]["11"]
    found = read_recording(path, write_map(elsewhere, content))
    assert set(scene.lanelets) - set(found.lanelets) == {"11"}


def by_hand(places, kind, size, heading=0.0):
    """States and outlines as they would be written by hand."""
    speed = 10.0 if heading == 0.0 else 10.0 * float(np.sin(heading))
    states = {step: TrackState(x, y, heading, speed, 0.0) for step, (x, y) in places.items()}
    bodies = {step: rectangle(x, y, *size, heading) for step, (x, y) in places.items()}
    return {"type": kind, "standing": False, "states": states, "outlines": bodies}


def the_same_by_hand():
    assumed = StatedError(0.3, 0.0)
    walker = by_hand(WALKER, "pedestrian", (0.7, 0.7), float(np.pi / 2))
    lanelets = (
        straight(
            *(10, 0, 60, -1.75, 3.5),
            left_mark="double_solid",
            right_mark="broken",
            successors=(12,),
            right_of=11,
        ),
        straight(11, 0, 60, -5.25, 3.5, left_mark="broken", right_mark="solid", left_of=10),
        straight(
            *(12, 60, 120, -1.75, 3.5),
            left_mark="none",
            right_mark="none",
            predecessors=(10,),
            types=frozenset({"intersection"}),
        ),
        straight(20, 60, 0, 1.75, 3.5, left_mark="double_solid", right_mark="none"),
        lanelet(30, [(40, -8), (40, 5)], 4.0, types=frozenset({"crosswalk"})),
    )
    return Recording(
        name=SCENARIO_ID,
        step_s=0.1,
        lanelets={x.id: x for x in lanelets},
        participants=(
            Participant("AV", **by_hand(DRIVER, "car", (4.877, 2.0))),
            Participant("77", **walker, stated_error=assumed),
            Participant("78", **by_hand(LEAVER, "vehicle", (4.6, 1.9)), stated_error=assumed),
        ),
        problems=(),
        form="Argoverse 2 motion forecasting",
        side="right",
    )


@pytest.fixture(scope="module")
def california():
    """The rules that this scene is about, as few take less time."""
    book = compile_rulebook("us-ca")
    rules = tuple(x for x in book.rules if x.name in ("give_way_to_pedestrians", "solid_line"))
    return replace(book, rules=rules)


def verdicts(found, book):
    judged = RecordingVerdicts(found, book, RequestedDrives(), "some.parquet")
    answers = {}
    for one in judged.answers():
        assert not isinstance(one, NoDrive), one.why
        answers[one.drive.ego] = one
    return answers


def test_the_same_scene_by_hand_has_the_same_verdicts(scene, california):
    said, same = (verdicts(x, california) for x in (scene, the_same_by_hand()))
    assert set(said) == set(same) == {"AV", "78"}
    for ego in said:
        assert said[ego].answer == same[ego].answer
        assert said[ego].drive.trace.states == same[ego].drive.trace.states
    violated = {ego: {x.rule for x in said[ego].answer.violations} for ego in said}
    # 40 m ahead somebody walks on the crossing; ego drives on through the walker
    assert "give_way_to_pedestrians" in violated["AV"]
    # A car 1.9 m wide that has gone 3.5 m to the left has crossed the line, perhaps to turn into a
    # driveway after the recording's end; ego has not
    unsure = {ego: {x.rule: x.depends_on for x in said[ego].answer.open} for ego in said}
    assert "needs_access" in unsure["78"]["solid_line"]
    assert "solid_line" not in violated["AV"] | unsure["AV"].keys()


BAD = {
    "twice": ([*rows(), rows()[3]], "`AV` is twice in time step 3"),
    "kind": (rows_of("9", "dragon", {0: (0, 0)}), "`object_type` is `dragon`"),
    "before": (rows_of("9", "vehicle", {-1: (0, 0)}), "`timestep` is -1"),
    "long after": (rows_of("9", "vehicle", {10**9: (0, 0)}), "`timestep` is 1000000000"),
    "nowhere": (rows_of("9", "vehicle", {0: (np.nan, 0)}), "`position_x` is nan"),
    "far away": (rows_of("9", "vehicle", {0: (1e30, 0)}), "`position_x` is 1e+30"),
    "no place": (rows_of("9", "vehicle", {0: (0, 0)}), "`heading` has no value"),
    "no time": (rows_of("9", "vehicle", {0: (0, 0)}, timestep=0.5), "`timestep` is of type double"),
    "long name": (rows_of("9" * 201, "vehicle", {0: (0, 0)}), "longer than 200"),
}


@pytest.mark.parametrize("name", BAD)
def test_what_cannot_be_is_refused(tmp_path, name):
    content, why = BAD[name]
    if name == "no place":
        content = [{**row, "heading": None} for row in rows_of("9", "vehicle", {0: (0, 0)})]
        content += rows_of("10", "vehicle", {0: (0, 0)})
    path = write_motion(tmp_path, content)
    with pytest.raises(RulecError) as caught:
        read_recording(path)
    (found,) = caught.value.diagnostics
    assert found.code == "R0610"
    assert found.place.file == str(path)
    assert why in found.message


def test_without_a_map_it_says_which(tmp_path):
    path = write_motion(tmp_path, rows())
    for file in tmp_path.glob("*.json"):
        file.unlink()
    with pytest.raises(RulecError) as caught:
        read_recording(path)
    (found,) = caught.value.diagnostics
    assert "log_map_archive_*.json" in found.message
    assert "`map_path`" in found.help
