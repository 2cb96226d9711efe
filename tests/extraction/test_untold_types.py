"""Types of objects that no format tells: rules about them cannot be judged where one may be."""

import numpy as np
import pytest

import rulec
from rulec.analysis.audit.source_audit import audit_source
from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.extraction.traces.tellable_types import told_types

T = np.arange(40) / 10


def verdict(kind, book):
    """The verdict on a car that comes up to another vehicle, which stands with hazard lights on."""
    road = rulec.build_lanelet("road", [(0, 0), (400, 0)], limit_mps=14.0)
    lamps = {"hazard_lights": [True] * len(T)}
    stands = rulec.build_participant(
        "other", kind, T, [200.0] * len(T), [0.0] * len(T), step_s=0.1, heading=T * 0, lamps=lamps
    )
    ego = rulec.build_participant("ego", "car", T, 50 + 10 * T, T * 0, step_s=0.1)
    found = rulec.build_recording([road], [ego, stands], step_s=0.1, side="right")
    wanted = rulec.RequestedDrives(("ego",))
    (answer,) = rulec.verify_recording(found, book, wanted).answers()
    return answer.answer


@pytest.mark.parametrize(
    ("kind", "lacking"),
    [("bus", ["school_bus"]), ("vehicle", ["school_bus"]), ("car", ["school_bus"])],
)
def test_no_recording_tells_school_buses(kind, lacking):
    untold = [one.untold for one in verdict(kind, "us-ca").not_judged if one.rule == "school_bus"]
    assert [name for names in untold for name in names if name == "school_bus"] == lacking


def test_where_a_law_speaks_of_all_buses_it_makes_no_difference():
    untold = [name for one in verdict("bus", "de").not_judged for name in one.untold]
    assert "school_bus" not in untold


MOOSE = """\
rulebook wild
use road
type moose is road_user
type pickup is truck
hard rule brake (o: OF) { require never (gap(o) < 20 m and speed > 30 km/h and behind(o)) }
"""


@pytest.mark.parametrize(
    ("of", "lacking"),
    [
        *(("moose", ["moose"]), ("horse_rider", ["horse_rider"]), ("pickup", ["pickup"])),
        *(("truck", []), ("vehicle", []), ("vulnerable_user", []), ("road_user", [])),
    ],
)
def test_a_rule_about_what_recordings_never_tell_is_not_kept(of, lacking):
    book = rulec.compile(rulec.parse_rulebook(MOOSE.replace("OF", of)))
    untold = [name for one in verdict("car", book).not_judged for name in one.untold]
    assert untold == lacking
    words = TELLABLE_WORDS["commonroad"] | told_types("commonroad", book.vocabulary)
    (audited,) = audit_source(book, "commonroad", words).rules
    assert (list(audited.lacking), audited.basis == "nothing") == (lacking, bool(lacking))


@pytest.mark.parametrize(
    ("source", "told", "untold"),
    [
        ("Waymo scenario", {"vehicle", "cyclist", "light_rider"}, {"truck", "car", "train"}),
        ("highD tracks", {"car", "truck", "road_user"}, {"pedestrian", "vulnerable_user", "bus"}),
        ("SUMO data", {"bus", "emergency_vehicle", "rail_vehicle"}, {"tram", "moped"}),
        ("tracks as a table", {"cyclist", "motorcycle"}, {"scooter_rider", "school_bus"}),
    ],
)
def test_formats_tell_apart_some_types(source, told, untold):
    words = rulec.parse_rulebook(MOOSE.replace("OF", "vehicle")).vocabulary
    found = told_types(source, words)
    assert told <= found
    assert not untold & found
