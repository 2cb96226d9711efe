"""Vehicles of public recordings that were looked up from raw positions, and what is true of them.

The files are CommonRoad's; the folder `commonroad_more` beside that of RULEC_RECORDINGS has them.
"""

from functools import cache

import pytest

from rulec import read_recording
from rulec.api.rulebook_compilation import machines
from rulec.extraction.recording_verdicts import RecordingVerdicts
from rulec.extraction.selection import RequestedDrives
from rulec.extraction.traces.recorded_drive import NoDrive
from support.builders.recorded_data import RECORDINGS

FOLDER = RECORDINGS.parent / "commonroad_more"
if not FOLDER.exists():
    pytest.skip("the looked-up recordings are not here: RULEC_RECORDINGS", allow_module_level=True)

pytestmark = pytest.mark.long
LAWFUL = [
    # They stand; the one that was ahead turned off
    ("USA_Lanker-2_23_T-1", "pulling_out", {"21116", "21128", "21136", "21137", "21183"}),
    # In town
    ("USA_Lanker-2_23_T-1", "emergency_corridor", set()),
    # They stop for red, some 10 m beyond the lanelet's end
    ("USA_Lanker-2_23_T-1", "red_light", {"21238", "21263"}),
    ("USA_Peach-4_8_T-1", "red_light", {"564", "566", "569"}),
    # Queues begin 0.1 s after the recording
    ("USA_Peach-4_8_T-1", "keep_near_side", {"512"}),
    # They stand, and a cyclist filters past
    ("DEU_Reutlingen-5_1_T-1", "lateral_gap", set()),
    ("USA_US101-10_1_T-1", "emergency_corridor", set()),
    # Nobody gets past them
    ("USA_US101-5_1_T-1", "being_overtaken", set()),
]


@cache
def violators(name):
    """Rule -> those who violate it for sure under `de`."""
    file = FOLDER / f"{name}.xml"
    judged = RecordingVerdicts(read_recording(file), machines("de"), RequestedDrives(), file.name)
    found = {}
    for each in judged.answers():
        if not isinstance(each, NoDrive):
            for violation in each.answer.violations:
                found.setdefault(violation.rule, set()).add(each.drive.ego)
    return found


@pytest.mark.parametrize(("name", "rule", "egos"), LAWFUL)
def test_who_kept_the_rule_is_not_accused(name, rule, egos):
    accused = violators(name).get(rule, set())
    assert not (accused & egos if egos else accused)


def test_who_runs_a_red_light_is_found():
    accused = violators("DEU_TrafficLightTest-1")["red_light"]
    assert accused == {"30", "31", "32", "33", "34"}


@pytest.mark.parametrize("name", ["DEU_A9-1_1_T-1", "DEU_Muc-2_1_T-1"])
def test_lanelets_side_by_side_are_neighbours(name):
    """Their borders are less than half a metre apart; the file does not name them all."""
    file = FOLDER / f"{name}.xml"
    beside = [x.left_of for x in read_recording(file).lanelets.values() if x.left_of is not None]
    assert len(beside) > file.read_text(encoding="utf-8").count("<adjacentLeft")
