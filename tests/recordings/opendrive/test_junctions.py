"""Junctions, signals, stop lines and crossings of OpenDRIVE maps."""

import re
from collections import Counter
from math import pi

import numpy as np
import pytest

from rulec.extraction.tracks.at_junctions.junctions import junctions_of
from rulec.recordings.map_files import read_map
from rulec.recordings.opendrive.content.file_reader import read_file
from rulec.recordings.recording import Recording
from support.builders.opendrive_files import (
    document,
    geometry,
    lane,
    road,
    section,
    shared_map,
    signals,
    t_junction,
    two_way,
    written,
)

STOP = {"id": "s", "s": 100, "t": -4, "orientation": "+", "type": "206", "country": "DE"}
LIGHT = {"id": "l", "s": 98, "t": -4, "orientation": "+", "dynamic": "yes", "type": "1000001"}


def lanelets(folder, *parts):
    return read_map(written(folder, document(*parts)), 0.1).lanelets


def crossing(folder, **parts):
    return read_map(written(folder, t_junction(**parts)), 0.1).lanelets


def test_ways_through(tmp_path):
    there = crossing(tmp_path)
    assert there["1.0.-1"].successors == ("4.0.-1",)
    assert there["2.0.-1"].successors == ("5.0.-1",)
    assert there["3.0.1"].successors == ("6.0.1",)
    assert there["6.0.1"].successors == ("1.0.1",)
    assert set(there["3.0.-1"].predecessors) == {"4.0.-1", "5.0.-1"}
    inside = {x.id for x in there.values() if "intersection" in x.types}
    assert inside == {"4.0.-1", "5.0.-1", "6.0.1"}
    assert {there[x].junction for x in inside} == {"9"}
    assert there["4.0.-1"].first is None


def test_priorities(tmp_path):
    """Of roads in the junction; who is named as the first has nobody before it."""
    there = crossing(tmp_path, more='<priority high="4" low="5"/>')
    assert there["5.0.-1"].first == {"4.0.-1"}
    assert there["4.0.-1"].first == frozenset()
    assert there["6.0.1"].first is None
    recording = Recording("", 0.1, there, (), ())
    assert [x.regulated for x in junctions_of(recording)] == [True]


def test_priorities_of_roads_that_lead_there(tmp_path):
    there = crossing(tmp_path, more='<priority high="1" low="2"/>')
    assert (there["5.0.-1"].first, there["4.0.-1"].first) == ({"4.0.-1"}, frozenset())


def test_where_a_ramp_leaves_there_is_no_crossroads(tmp_path):
    one = section(lane(-1), lane(-2))
    ramp = '<arc curvature="-0.01"/>'
    there = lanelets(
        tmp_path,
        road(1, one, links="successor=junction:9"),
        road(2, section(lane(-1)), plan=geometry(x=120), links="predecessor=junction:9"),
        road(3, section(lane(-1)), plan=geometry(x=120, y=-5), links="predecessor=junction:9"),
        *(
            road(
                number,
                section(lane(-1, links="predecessor=-1 successor=-1")),
                plan=geometry(shape, x=100, length=20),
                length=20,
                junction=9,
                links=f"predecessor=road:1:end successor=road:{end}:start",
            )
            for number, shape, end in ((4, "<line/>", 2), (5, ramp, 3))
        ),
        '<junction id="9" name=""/>',
    )
    assert set(there["1.0.-1"].successors) == {"4.0.-1", "5.0.-1"}
    assert not any(x.junction or "intersection" in x.types for x in there.values())


def test_a_direct_junction(tmp_path):
    """Roads part without a road in between."""
    there = lanelets(
        tmp_path,
        road(1, section(lane(-1), lane(-2)), links="successor=junction:9"),
        road(2, section(lane(-1)), plan=geometry(x=100), links="predecessor=junction:9"),
        road(3, section(lane(-1)), plan=geometry(x=100, y=-3.5), links="predecessor=junction:9"),
        """<junction id="9" name="" type="direct">
          <connection id="0" incomingRoad="1" linkedRoad="2" contactPoint="start">
            <laneLink from="-1" to="-1"/></connection>
          <connection id="1" incomingRoad="1" linkedRoad="3" contactPoint="start">
            <laneLink from="-2" to="-1"/></connection></junction>""",
    )
    assert there["1.0.-1"].successors == ("2.0.-1",)
    assert there["3.0.-1"].predecessors == ("1.0.-2",)


def test_a_stop_sign(tmp_path):
    """For the lanes in its orientation, at the end of the road that it stands at."""
    there = crossing(tmp_path, west=signals(STOP))
    assert {x.id for x in there.values() if x.signs} == {"1.0.-1"}
    assert there["1.0.-1"].signs == {"STOP"}
    assert there["1.0.-1"].stop_line is None


def test_a_stop_sign_within_the_junction(tmp_path):
    """It stands where the way begins; lanes in its validity count against its orientation."""
    sign = STOP | {"s": 0.1, "orientation": "-", "lanes": (-1, -1)}
    there = crossing(tmp_path, straight=signals(sign))
    assert {x.id for x in there.values() if x.signs} == {"1.0.-1"}


def test_a_sign_for_no_lane_is_for_those_who_refer_to_it(tmp_path):
    reference = {"tag": "signalReference", "id": "s", "s": 0, "t": 0, "orientation": "+"}
    there = crossing(tmp_path, west=signals(STOP | {"lanes": (0, 0)}), straight=signals(reference))
    assert there["1.0.-1"].signs == {"STOP"}
    assert not there["1.0.1"].signs


@pytest.mark.parametrize(
    ("kind", "subtype", "country", "signs"),
    [
        ("205", "", "DEU", {"YIELD"}),
        ("301", "-1", "OpenDRIVE", {"RIGHT_OF_WAY"}),
        ("306", "", "", {"PRIORITY"}),
        ("R1-1", "", "US", {"STOP"}),
        ("R1", "1", "USA", {"STOP"}),
        ("R1-2", "", "US", {"YIELD"}),
        ("r2", "", "ES", {"STOP"}),
        ("B6", "", "NL", {"YIELD"}),
        ("3", "02", "CH", {"YIELD"}),
        ("206", "", "JP", set()),
        ("330", "", "JP", {"STOP"}),
        ("206", "", "XX", set()),
        ("-1", "-1", "", set()),
    ],
)
def test_catalogues(tmp_path, kind, subtype, country, signs):
    sign = STOP | {"type": kind, "subtype": subtype, "country": country}
    assert crossing(tmp_path, west=signals(sign))["1.0.-1"].signs == signs


def test_a_limit_on_a_sign(tmp_path):
    """From where it stands to the end of the road, or to the next one; for who comes past it."""
    signs = [
        {"id": "a", "s": 20, "orientation": "+", "type": "274", "value": 50, "unit": "km/h"},
        {"id": "b", "s": 60, "orientation": "+", "type": "274", "subtype": "53"},
        {"id": "c", "s": 80, "orientation": "+", "type": "282"},
    ]
    there = crossing(tmp_path, west=signals(*signs))
    found = [there[f"1.{piece}.-1"].limit_mps for piece in range(4)]
    assert found == [None, pytest.approx(50 / 3.6), pytest.approx(30 / 3.6), None]
    assert [x for x in there.values() if x.signs and x.id[-2:] != "-1"] == []
    assert there["1.1.-1"].signs == {"MAX_SPEED"}


def test_no_overtaking(tmp_path):
    sign = {"id": "a", "s": 70, "orientation": "-", "type": "276"}
    there = crossing(tmp_path, west=signals(sign))
    assert there["1.0.1"].signs == {"NO_OVERTAKING_START"}
    assert not there["1.1.1"].signs


def test_a_light(tmp_path):
    """What it shows is not known."""
    there = crossing(tmp_path, west=signals(LIGHT))
    (light,) = there["1.0.-1"].lights
    assert light.colour_at(0) == ""
    assert [x.id for x in there.values() if x.lights] == ["1.0.-1"]


def test_a_light_for_one_way(tmp_path):
    light = LIGHT | {"s": 0.5, "lanes": (-1, -1)}
    there = crossing(tmp_path, straight=signals(light))
    assert set(there["1.0.-1"].lights_to) == {"4.0.-1"}


@pytest.mark.parametrize("change", [{"dynamic": "no"}, {"type": "1000002"}, {"type": "274"}])
def test_what_is_no_light_for_vehicles(tmp_path, change):
    there = crossing(tmp_path, west=signals(LIGHT | change))
    assert not any(x.lights for x in there.values())


def test_a_light_on_the_open_road(tmp_path):
    """It is far from what comes next, so the road is cut at it."""
    there = crossing(tmp_path, west=signals(LIGHT | {"s": 30}))
    assert [x.id for x in there.values() if x.lights] == ["1.0.-1"]
    assert there["1.0.-1"].centre[-1] == pytest.approx((30, -1.75))


def test_a_controlled_signal_of_another_catalogue_is_a_light(tmp_path):
    light = LIGHT | {"type": "7", "country": "SE"}
    parts = road(1, two_way(), more=signals(light))
    control = '<controller id="c"><control signalId="l" type="0"/></controller>'
    assert not lanelets(tmp_path, parts)["1.0.-1"].lights
    assert lanelets(tmp_path, parts, control)["1.0.-1"].lights


def test_stop_lines(tmp_path):
    """The mark 294 by its lanes; an object by the lanes that it lies across."""
    mark = STOP | {"type": "294", "s": 97}
    thing = '<objects><object id="o" type="roadMark" name="StopLine" s="95" t="-1.75" '
    thing += 'orientation="none" length="0.5" width="3.5"/></objects>'
    for more, s in ((signals(mark), 97), (thing, 95)):
        there = crossing(tmp_path, west=more)
        assert there["1.0.-1"].stop_line == pytest.approx(np.array([(s, 0), (s, -3.5)]))
        assert there["1.0.1"].stop_line is None


def outline(lanelet):
    return {tuple(np.round(x, 6)) for x in np.concatenate((lanelet.left, lanelet.right))}


CROSSWALK = (
    '<object id="z" type="crosswalk" s="50" t="0" hdg="{}" length="{}" width="{}">{}</object>'
)


@pytest.mark.parametrize(
    "thing",
    [
        CROSSWALK.format(pi / 2, 8, 4, ""),
        CROSSWALK.format(0, 4, 8, ""),
        CROSSWALK.format(
            0,
            1,
            1,
            "<outlines><outline>"
            + "".join(f'<cornerLocal u="{u}" v="{v}"/>' for u, v in ((2, 4), (2, -4), (-2, -4)))
            + '<cornerLocal u="-2" v="4"/><cornerLocal u="2" v="4"/></outline></outlines>',
        ),
        CROSSWALK.format(
            0,
            1,
            1,
            "<outline>"
            + "".join(f'<cornerRoad s="{s}" t="{t}"/>' for s, t in ((48, -4), (52, -4), (52, 4)))
            + '<cornerRoad s="48" t="4"/></outline>',
        ),
    ],
)
def test_crosswalks(tmp_path, thing):
    """By size, or by outline: 4 m along the road and 8 m across."""
    there = lanelets(tmp_path, road(1, two_way(), more=f"<objects>{thing}</objects>"))
    found = there["1.crosswalk z"]
    assert found.types == {"crosswalk"}
    assert outline(found) == {(48, -4), (52, -4), (48, 4), (52, 4)}
    # It leads across, from one side of the road to the other
    assert np.ptp(found.centre, axis=0) == pytest.approx((0, 8))
    assert there["1.0.-1"].successors == ()


def test_a_crosswalk_as_a_mark_with_lights(tmp_path):
    mark = {"id": "0", "s": 40, "orientation": "+", "type": "1000003", "value": 3}
    light = LIGHT | {"type": "1000002", "s": 39, "lanes": (0, 0)}
    (found,) = (
        x
        for x in lanelets(tmp_path, road(1, two_way(), more=signals(mark, light))).values()
        if "crosswalk" in x.types
    )
    assert found.types == {"crosswalk", "directed"}
    assert outline(found) == {(40, -3.5), (43, -3.5), (40, 3.5), (43, 3.5)}


NEEDS_MAPS = pytest.mark.skipif(
    shared_map("multi_intersections") is None,
    reason="OpenDRIVE's maps are not here: set RULEC_RECORDINGS",
)


@NEEDS_MAPS
def test_a_town_of_five_junctions():
    """As its elements can be counted with any other tool."""
    file = shared_map("multi_intersections")
    content = read_file(file)
    assert len(content.roads) == 63
    assert sum(len(x.signals) for x in content.roads.values()) == 127
    # Of 46 elements `controller` the other half are those of junctions, which refer to these
    assert len(content.controllers) == 23
    assert sum(len(signals) for signals in content.controllers.values()) == 68
    lanes = read_map(file, 0.1).lanelets.values()
    assert {x.junction for x in lanes} - {""} == set(content.junctions)
    # One of the lines is for two lanes
    kinds = Counter(x.type for one in content.roads.values() for x in one.signals)
    assert kinds["294"] == 17
    assert sum(x.stop_line is not None for x in lanes) == 18
    assert sum("crosswalk" in x.types for x in lanes) == kinds["1000003"] == 17
    assert all(x.stop_line is not None for x in lanes if x.lights)


@NEEDS_MAPS
def test_a_junction_with_lights():
    file = shared_map("FourWaySignal")
    content = read_file(file)
    assert sum(len(x.signals) for x in content.roads.values()) == 12
    lanes = read_map(file, 0.1).lanelets.values()
    assert sum("crosswalk" in x.types for x in lanes) == 4
    assert all("urban" in x.types for x in lanes if "crosswalk" not in x.types)
    # Every lane that leads into the junction has a light
    entries = {x.id for x in lanes if not x.junction} & {
        name for x in lanes if x.junction for name in x.predecessors
    }
    driven = {x.id for x in lanes if not x.types & {"border", "sidewalk", "crosswalk"}}
    assert {x.id for x in lanes if x.lights} == entries & driven


@pytest.mark.parametrize(("within", "after", "holds"), [(6, 14, 14), (6, 6, 6), (14, 14, 14)])
def test_no_limit_holds_within_a_junction_alone(tmp_path, within, after, holds):
    """Converters write how fast a bend is driven; where the next road begins so it is its limit."""
    text = t_junction()
    for number, limit in {1: 14, 4: within, 3: after}.items():
        kind = f'<type s="0" type="town"><speed max="{limit}"/></type>'
        head = rf'(<road id="{number}".*?</planView>)'
        text = re.sub(head, rf"\g<1>{kind}", text, count=1, flags=re.DOTALL)
    found = read_map(written(tmp_path, text), 0.1)
    assert found.lanelets["4.0.-1"].limit_mps == holds
    assert any("turning speeds" in remark for remark in found.remarks) == (within != holds)


@pytest.mark.parametrize("narrows", [True, False])
def test_a_lane_of_a_way_ends_where_the_one_begins_that_it_leads_to(tmp_path, narrows):
    """Two lanes become one, but are drawn side by side to the end, as by SUMO's netconvert."""
    widths = {"mark": "solid", "width": 3.5}
    to = -1 if narrows else -2
    ahead = [lane(number, **widths) for number in ((-1,) if narrows else (-1, -2))]
    whole = document(
        road(1, section(lane(-1, **widths), lane(-2, **widths)), links="successor=junction:9"),
        road(3, section(*ahead), plan=geometry(x=120), links="predecessor=junction:9"),
        road(
            4,
            section(
                lane(-1, links="predecessor=-1 successor=-1", **widths),
                lane(-2, links=f"predecessor=-2 successor={to}", **widths),
            ),
            plan=geometry(x=100, length=20),
            length=20,
            junction=9,
            links="predecessor=road:1:end successor=road:3:start",
        ),
        """<junction id="9" name="">
          <connection id="0" incomingRoad="1" connectingRoad="4" contactPoint="start">
            <laneLink from="-1" to="-1"/><laneLink from="-2" to="-2"/></connection></junction>""",
    )
    found = read_map(written(tmp_path, whole), 0.1)
    kept, other = (found.lanelets[name] for name in ("4.0.-1", "4.0.-2"))
    assert kept.right[[0, -1]] == pytest.approx(np.array([(100, -3.5), (120, -3.5)]))
    assert other.successors == (f"3.0.{to}",)
    ends = 0.0 if narrows else -3.5
    assert other.left[[0, -1]] == pytest.approx(np.array([(100, -3.5), (120, ends)]))
    assert other.right[[0, -1]] == pytest.approx(np.array([(100, -7), (120, ends - 3.5)]))
    assert other.centre[-1] == pytest.approx((120, ends - 1.75))
    marks = {None} if narrows else {"solid"}
    assert {other.left_mark, other.right_mark} == marks
    # Who merges changes from one to the other, so they stay neighbours
    assert (kept.right_of, other.left_of) == ("4.0.-2", "4.0.-1")
    assert any("drawn anew" in remark for remark in found.remarks) == narrows


def test_a_wider_lane_begins_where_the_map_has_it(tmp_path):
    """Its other bound goes on, so nothing is drawn beside what it leads to."""
    whole = document(
        road(1, section(lane(-1, width=2.5)), links="successor=junction:9"),
        road(3, section(lane(-1, width=6)), plan=geometry(x=120), links="predecessor=junction:9"),
        road(
            4,
            section(lane(-1, links="predecessor=-1 successor=-1", width=2.5, mark="solid")),
            plan=geometry(x=100, length=20),
            length=20,
            junction=9,
            links="predecessor=road:1:end successor=road:3:start",
        ),
        """<junction id="9" name="">
          <connection id="0" incomingRoad="1" connectingRoad="4" contactPoint="start">
            <laneLink from="-1" to="-1"/></connection></junction>""",
    )
    found = read_map(written(tmp_path, whole), 0.1)
    assert found.lanelets["4.0.-1"].successors == ("3.0.-1",)
    assert found.lanelets["4.0.-1"].right[:, 1] == pytest.approx(-2.5)
    assert found.lanelets["4.0.-1"].right_mark == "solid"
    assert not any("drawn anew" in remark for remark in found.remarks)
