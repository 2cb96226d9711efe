"""Types of objects that no format tells: rules about them cannot be judged where one may be."""

import numpy as np
import pytest

import rulec

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
    ("kind", "lacking"), [("bus", ["school_bus"]), ("vehicle", ["school_bus"]), ("car", [])]
)
def test_a_bus_may_be_a_school_bus(kind, lacking):
    untold = [one.untold for one in verdict(kind, "us-ca").not_judged if one.rule == "school_bus"]
    assert [name for names in untold for name in names if name == "school_bus"] == lacking


def test_where_a_law_speaks_of_all_buses_it_makes_no_difference():
    untold = [name for one in verdict("bus", "de").not_judged for name in one.untold]
    assert "school_bus" not in untold
