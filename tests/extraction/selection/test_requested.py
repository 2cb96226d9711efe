"""The drives that a user requests, mirrored where the rulebook's side is the other one."""

from dataclasses import replace

import pytest

from rulec.diagnostics import RulecError
from rulec.extraction.selection import RequestedDrives, selected_drives
from rulec.extraction.traces.recorded_drive import NoDrive
from rulec.extraction.traffic_thresholds import USUAL
from rulec.recordings.recording import TrackState
from rulec.rulebook.loader import load_vocabulary
from support.builders.drive_contexts import steady
from support.builders.recordings import recording, rectangle, vehicle
from support.generators.random_recordings import lanes

RIGHT = replace(
    recording(lanes(1), [steady(k, 20 * k, 0) for k in (7, 8)], step_s=0.5), side="right"
)


@pytest.mark.parametrize(
    ("side", "traffic", "as_recorded", "mirrored"),
    [
        ("right", "left", False, True),
        ("right", "left", True, False),
        ("right", "right", False, False),
        ("right", "", False, False),
        (None, "left", False, False),
        ("left", "right", False, True),
    ],
)
def test_recordings_of_the_other_side_are_mirrored(side, traffic, as_recorded, mirrored):
    found = replace(RIGHT, side=side)
    wanted = RequestedDrives(as_recorded=as_recorded)
    drives = selected_drives(found, wanted, "file", traffic)
    assert drives.mirrored is mirrored
    # A mirror turns y round, and so a body's second corner, at y = -1
    assert drives.recording.participants[0].outlines[0][1, 1] == (1 if mirrored else -1)


def test_egos_come_in_the_order_of_the_file():
    assert selected_drives(RIGHT, RequestedDrives(), "file").egos == ("7", "8")
    assert selected_drives(RIGHT, RequestedDrives(("8", "7")), "file").egos == ("7", "8")
    assert selected_drives(RIGHT, RequestedDrives(("8",)), "file").egos == ("8",)


def test_an_unknown_vehicle_is_refused_with_those_there_are():
    with pytest.raises(RulecError) as caught:
        selected_drives(RIGHT, RequestedDrives(("lorry",)), "road.xml")
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "R0612"
    assert diagnostic.help == "choose `7`, `8`"
    nobody = replace(RIGHT, participants=())
    with pytest.raises(RulecError) as caught:
        selected_drives(nobody, RequestedDrives(("7",)), "road.xml")
    assert caught.value.diagnostics[0].help == "nobody in this file does"
    crowd = replace(RIGHT, participants=tuple(steady(k, 9 * k, 0) for k in range(100, 115)))
    with pytest.raises(RulecError) as caught:
        selected_drives(crowd, RequestedDrives(("lorry",)), "road.xml")
    assert caught.value.diagnostics[0].help.startswith("choose `100`, `101`, `102`, ")


def test_thresholds_and_assumptions_reach_the_drives():
    wanted = RequestedDrives(thresholds=replace(USUAL, near_m=5.0), assumed={"built_up": True})
    (drive,) = selected_drives(RIGHT, wanted, "file").of("7")
    # The other vehicle is 16 m away
    assert drive.trace.objects == {}
    assert [state["built_up"] for state in drive.trace.states] == [True] * 4


def test_where_nobody_drives_the_reason_is_said():
    walker = steady(9, 0, -1, speed=1, kind="pedestrian")
    stands = vehicle(8, {0: (20, 0)}, "parkedVehicle", standing=True)
    with pytest.raises(RulecError) as raised:
        selected_drives(recording(lanes(1), [walker, stands]), RequestedDrives(), "file")
    (found,) = raised.value.diagnostics
    assert found.message == (
        "no vehicle drives in it: of its participants, 1 never move and 1 are on foot or of "
        "unknown type"
    )
    with pytest.raises(RulecError, match="it contains a road but no participants"):
        selected_drives(recording(lanes(1)), RequestedDrives(), "file")


def test_who_has_sets_for_places_has_no_track():
    # A prediction says where it may be: an outline in each step, and a state in the first
    predicted = replace(steady(7, 0, 0), states={0: TrackState(0, 0, 0, 5, 0)})
    spread = {k: rectangle(20 * k, 0, 4 + 8 * k, 60) for k in range(4)}
    found = recording(lanes(1), [replace(predicted, outlines=spread), steady(8, 20, 0)])
    drives = selected_drives(found, RequestedDrives(), "file")
    assert all(
        isinstance(one, NoDrive) and one.why.startswith("it has no track") for one in drives.of("7")
    )


@pytest.mark.parametrize(
    ("assumed", "code", "says", "way_out"),
    [
        ({"bulit_up": True}, "R0502", "`assumed` speaks of `bulit_up`", "did you mean `built_up`?"),
        (
            {"built_up": "true"},
            "R0503",
            'says `built_up` is `"true"`; it is true or',
            "write `true`",
        ),
        (
            {"road_class": "freeway"},
            "R0503",
            "is one of `ordinary_road`, `expressway`",
            "did you mean `motorway` (the road is a motorway)?",
        ),
        ({"gap": 5.0}, "R0503", "`gap`, which is about objects", "assume only what is about none"),
    ],
)
def test_what_no_drive_can_have_is_refused_at_once(assumed, code, says, way_out):
    words = load_vocabulary("road")
    with pytest.raises(RulecError) as caught:
        selected_drives(RIGHT, RequestedDrives(assumed=assumed), "road.xml", vocabulary=words)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == code
    assert says in diagnostic.message
    assert diagnostic.help == way_out
