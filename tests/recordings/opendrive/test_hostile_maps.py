"""What is wrong with an OpenDRIVE map is said at its line; every file ends in that or a map."""

import random

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.recordings.map_files import read_map
from support.builders.opendrive_files import (
    cubic,
    document,
    geometry,
    lane,
    road,
    section,
    signals,
    two_way,
    written,
)
from support.generators.mutated_files import mutated

LIGHT = {"id": "l", "s": 98, "t": -4, "orientation": "+", "dynamic": "yes", "type": "1000001"}
SIGN = {"id": "g", "s": 40, "t": -4, "orientation": "+", "type": "274", "value": "50"}
CROSSWALK = '<object id="z" type="crosswalk" s="50" t="0" hdg="1.5" length="8" width="4"/>'
PLAN = geometry('<spiral curvStart="0" curvEnd="0.02"/>', length=60) + geometry(
    '<paramPoly3 pRange="normalized" aU="0" bU="30" cU="5" dU="5" aV="0" bV="0" cV="3" dV="1"/>',
    s=60,
    x=59,
    y=12,
    hdg=0.6,
    length=40,
)
GOOD = document(
    road(
        1,
        section(
            lane(1, mark="broken", links="successor=1"),
            lane(-1, width=cubic("width", "sOffset", 0, 3, 0.01), links="successor=-1"),
        ),
        section(lane(1), lane(-1), lane(-2, kind="sidewalk"), start=50),
        plan=PLAN,
        links="successor=junction:9",
        offsets=cubic("laneOffset", "s", 0, 0.5),
        more='<type s="0" type="town"><speed max="50" unit="km/h"/></type>'
        f"<objects>{CROSSWALK}</objects>" + signals(LIGHT, SIGN),
    ),
    road(
        2,
        section(lane(-1, links="predecessor=-1 successor=-1")),
        plan=geometry('<arc curvature="0.1"/>', x=97, y=30, hdg=1, length=10),
        length=10,
        junction=9,
        links="predecessor=road:1:end successor=road:3:start",
        more=signals({"tag": "signalReference", "id": "l", "s": 0, "orientation": "+"}),
    ),
    road(
        3,
        two_way(),
        plan=geometry(cubic("poly3", "x", 0, 0, 0, 0.001), x=100, y=40, hdg=2, length=50),
        length=50,
        links="predecessor=junction:9",
    ),
    '<junction id="9" name=""><connection id="0" incomingRoad="1" connectingRoad="2" '
    'contactPoint="start"><laneLink from="-1" to="-1"/></connection>'
    '<priority high="2" low="2"/></junction>',
    '<controller id="c"><control signalId="l"/></controller>',
)


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
        ('id="1" length="100"', 'id="1" length="nan"', "`length` is `nan`"),
        ('id="1" length="100"', 'id="1" length="9e6"', "a road is longer than 1,000 km"),
        ("<planView>", "<plan>", "not well-formed"),
        ('hdg="1"', 'hdg="inf"', "`hdg` is `inf`"),
        ('curvEnd="0.02"', 'curvEnd="1e7"', "a road turns round 95,492,966 times"),
        ('curvEnd="0.02"', "", "has no `curvEnd`"),
        ('bU="30"', 'bU="thirty"', "`bU` is `thirty`"),
        ('<left><lane id="1"', '<left><lane id="-1"', "a lane -1 is among those of `left`"),
        ('id="-2" type="sidewalk"', 'id="-1" type="sidewalk"', "there are two lanes -1"),
        ('id="-2" type="sidewalk"', 'id="-2000" type="sidewalk"', "`id` of a `lane` is `-2000`"),
        ('laneSection s="50"', 'laneSection s="500"', "begins at 500 m, behind the road's end"),
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


def assert_read_or_refused(folder, seed):
    pick = random.Random(seed)
    file = folder / "mutated.xodr"
    data = mutated(GOOD, pick)
    file.write_bytes(data)
    try:
        found = read_map(file, 0.1)
    except RulecError as refused:
        (problem,) = refused.diagnostics
        assert problem.code in ("R0610", "R0615")
        assert problem.place.file == str(file)
        assert (problem.place.line or 1) <= data.count(b"\n") + data.count(b"\r") + 2
        assert "\n" not in problem.message
        assert len(problem.message) < 300
        return
    for lanelet in found.lanelets.values():
        assert len(lanelet.left) == len(lanelet.right) == len(lanelet.centre) >= 2
        assert np.isfinite(lanelet.left).all()
        assert np.isfinite(lanelet.right).all()
        for other in (*lanelet.successors, *lanelet.predecessors, *lanelet.lights_to):
            assert other in found.lanelets
        assert {lanelet.left_of, lanelet.right_of} - {None} <= found.lanelets.keys()


@given(seed=st.integers(0, 2**32))
def test_a_mistake_is_read_or_refused(tmp_path_factory, seed):
    assert_read_or_refused(tmp_path_factory.mktemp("mutated"), seed)


@pytest.mark.long
def test_twenty_thousand_mistakes(tmp_path):
    for seed in range(20_000):
        assert_read_or_refused(tmp_path, seed)
