"""What is wrong with an OpenDRIVE map is said at its line; every file ends in that or a map."""

import numpy as np
import pytest

from rulec.diagnostics import RulecError
from rulec.recordings.map_files import read_map
from rulec.recordings.opendrive import opendrive_map
from support.builders.opendrive_files import (
    cubic,
    document,
    every_element,
    geometry,
    lane,
    road,
    section,
    written,
)

GOOD = every_element()


def problem_with(folder, text):
    with pytest.raises(RulecError) as caught:
        read_map(written(folder, text), 0.1)
    (found,) = caught.value.diagnostics
    assert found.code == "R0610"
    assert "\n" not in found.message
    assert found.help
    return found


def test_the_good_one(tmp_path):
    found = read_map(written(tmp_path, GOOD), 0.1)
    assert len(found.lanelets) > 8
    assert all(np.isfinite(x.centre).all() for x in found.lanelets.values())


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        ("<OpenDRIVE>", "<!DOCTYPE a><OpenDRIVE>", "it has a `DOCTYPE`"),
        ("</OpenDRIVE>", "", "it has been cut short"),
        (GOOD, "<OpenDRIVE/>", "it has no road"),
        ('revMajor="1"', 'revMajor="2"', "its version is 2.6"),
        ('id="1" length="100"', 'length="100"', "the element `road` has no `id`"),
        ('id="1" length="100"', 'id="" length="100"', "`id` of a `road` is ``"),
        ('id="1" length="100"', f'id="{"9" * 300}" length="100"', "`id` of a `road` is"),
        ('id="2" length="10"', 'id="1" length="10"', "there are two roads `1`"),
        ('id="1" length="100"', 'id="1"', "the element `road` has no `length`"),
        ('id="1" length="100"', 'id="1" length="-5"', "`length` of a `road` is -5"),
        ('id="1" length="100"', 'id="1" length="nan"', "`length` of a `road` is `nan`"),
        ('id="1" length="100"', 'id="1" length="9e6"', "a road is longer than 1,000 km"),
        ("<planView>", "<plan>", "not well-formed"),
        ('hdg="1"', 'hdg="inf"', "`hdg` of a `geometry` is `inf`"),
        ('hdg="1"', 'hdg="0_1"', "`hdg` of a `geometry` is `0_1`"),
        ('hdg="1"', 'hdg="１"', "`hdg` of a `geometry` is `１`"),
        ('curvEnd="0.02"', 'curvEnd="1e7"', "a road turns round 95,492,966 times"),
        ('curvEnd="0.02"', "", "has no `curvEnd`"),
        ('bU="30"', 'bU="thirty"', "`bU` of a `paramPoly3` is `thirty`"),
        ('<left><lane id="1"', '<left><lane id="0"', "a lane 0 is among those of `left`"),
        ('id="-2" type="sidewalk"', 'id="-1" type="sidewalk"', "there are two lanes -1"),
        ('id="-2" type="sidewalk"', 'id="-2000" type="sidewalk"', "`id` of a `lane` is `-2000`"),
        ('laneSection s="50"', 'laneSection s="500"', "begins at 500 m, beyond the road's end"),
        ('unit="km/h"', 'unit="knots"', "`unit` of a `speed` is `knots`"),
        ('max="50"', 'max="-50"', "`max` of a `speed` is -50"),
        ('junction="-1"', 'junction="-1" rule="both"', "`rule` of a `road` is `both`"),
    ],
)  # fmt: skip
def test_mistakes(tmp_path, before, after, says):
    assert before in GOOD
    found = problem_with(tmp_path, GOOD.replace(before, after, 1))
    assert "cannot be read as an OpenDRIVE map" in found.message
    assert says in found.message


def test_a_mistake_has_its_line(tmp_path):
    text = GOOD.replace('<road id="3"', '\n\n<road id="3" rule="both"')
    line = text[: text.index('rule="both"')].count("\n") + 1
    assert problem_with(tmp_path, text).place.line == line


def test_a_road_that_leads_out_of_the_world(tmp_path):
    steep = cubic("width", "sOffset", 0, 3, 9e7, 9e7, 9e7)
    found = problem_with(tmp_path, document(road(1, section(lane(-1, width=steep)))))
    assert "the road `1` cannot be laid out" in found.message
    assert found.place.line == 2


@pytest.mark.parametrize("square", [-1e29, -9e7, -10])
def test_a_width_far_below_0(tmp_path, square):
    narrow = cubic("width", "sOffset", 0, 3, 0, square)
    found = problem_with(tmp_path, document(road(1, section(lane(-1, width=narrow)))))
    assert "its lane -1 has a width of -" in found.message
    assert found.place.line == 2


def test_a_lane_that_ends_may_have_a_width_a_little_below_0(tmp_path):
    ends = cubic("width", "sOffset", 0, 3, -0.05)
    good = document(road(1, section(lane(-1), lane(-2, width=ends))))
    assert len(read_map(written(tmp_path, good), 0.1).lanelets) == 2


def test_lanes_that_are_too_wide(tmp_path):
    found = problem_with(tmp_path, document(road(1, section(lane(-1, width=90_000)))))
    assert "longer than 20 km" in found.message


def test_lanes_that_wind_without_end(tmp_path):
    """Hundreds of lanes of a road that turns at every millimetre would take all memory."""
    waves = "".join(cubic("width", "sOffset", s / 10, 3, (-1) ** s * 40) for s in range(20_000))
    lanes = section(*(lane(-n, width=waves if n == 1 else 3) for n in range(1, 400)))
    found = problem_with(
        tmp_path, document(road(1, lanes, plan=geometry(length=2000), length=2000))
    )
    assert "wind so much" in found.message


def test_lanes_of_all_roads_together_that_wind_without_end(tmp_path, monkeypatch):
    monkeypatch.setattr(opendrive_map, "MOST_PLACES", 100)
    found = problem_with(tmp_path, GOOD)
    assert "over 100 points" in found.message
    assert found.place.line > 1
