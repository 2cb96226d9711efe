"""A SUMO net becomes lanelets: how they go on, what lies beside them, what they are for."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rulec import RulecError
from rulec.recordings.polylines import parallel_line
from rulec.recordings.recording import Light
from rulec.recordings.sumo.lanelets import net_lanelets
from rulec.recordings.sumo.net import read_net
from rulec.scenario.recorded.reference_line import without_repeats
from support.builders.sumo_files import ROAD_NET

THROUGH = "mainCarriageWay"
BUSES = ("busLane", "busesOnly")


def lanelets(tmp_path, text=ROAD_NET, step_s=0.5):
    file = tmp_path / "road.net.xml"
    file.write_text(text, encoding="utf-8")
    return net_lanelets(read_net(file), step_s)


def lane(**attributes):
    """A net of one lane with these attributes."""
    edge = {name: attributes.pop(name) for name in ("type", "function") if name in attributes}
    attributes = {"speed": 13.89} | attributes
    written = " ".join(f'{name}="{value}"' for name, value in attributes.items())
    of_edge = " ".join(f'{name}="{value}"' for name, value in edge.items())
    return (
        f'<net><edge id="e" {of_edge}><lane id="e_0" index="0" shape="0,0 9,0" '
        f"{written}/></edge></net>"
    )


def test_lanes_lead_on_through_the_junction(tmp_path):
    found = lanelets(tmp_path)
    assert found["in_1"].successors == (":x_0_0",)
    assert found[":x_0_0"].predecessors == ("in_1",)
    assert found[":x_0_0"].successors == ("out_1",)
    assert found["out_2"].successors == ("back_0",)
    assert found["out_1"].successors == ()


def test_neighbours_by_index_from_the_kerb_on(tmp_path):
    def beside_in_1(text):
        one = lanelets(tmp_path, text)["in_1"]
        return one.left_of, one.right_of

    assert beside_in_1(ROAD_NET) == ("in_2", "in_0")
    for word in ("true", "1", "yes", "On", "x", "t"):
        left = ROAD_NET.replace("<net ", f'<net lefthand="{word}" ')
        assert beside_in_1(left) == ("in_0", "in_2")
    assert beside_in_1(ROAD_NET.replace("<net ", '<net lefthand="no" ')) == ("in_2", "in_0")
    found = lanelets(tmp_path)
    assert (found[":x_0_0"].left_of, found["in_2"].left_of) == (":x_0_1", None)


@pytest.mark.parametrize(("word", "solid"), [("changeLeft", "left"), ("changeRight", "right")])
@pytest.mark.parametrize("side", ["right", "left"])
def test_who_may_not_change_lanes_to_a_side_has_a_solid_line_there(tmp_path, side, word, solid):
    """In a left-hand net, too, where lanes are counted from the left, left is left."""
    text = ROAD_NET.replace('<lane id="in_1" ', f'<lane id="in_1" {word}="authority" ')
    text = text.replace("<net ", f'<net lefthand="{str(side == "left").lower()}" ')
    marks = lanelets(tmp_path, text)["in_1"]
    told = {"left": marks.left_mark, "right": marks.right_mark}
    assert told == {"left": "broken", "right": "broken"} | {solid: "solid"}


def test_borders_lie_half_a_width_beside_the_middle(tmp_path):
    found = lanelets(tmp_path)
    assert found["in_1"].left.tolist() == [[0, pytest.approx(-3.2)], [200, pytest.approx(-3.2)]]
    assert found["in_0"].right.tolist() == [[0, pytest.approx(-8.4)], [200, pytest.approx(-8.4)]]
    # The middle of `back` leads towards smaller x, so its left is at smaller y
    assert found["back_0"].left[:, 1].tolist() == pytest.approx([0, 0])


def test_a_walking_area_is_an_outline(tmp_path):
    area = lanelets(tmp_path)[":x_w0_0"]
    corners = np.concatenate((area.right, area.left[::-1]))
    assert corners.tolist() == [[200, -6.4], [204, -6.4], [204, -8.4], [200, -8.4]]


@pytest.mark.parametrize(
    ("attributes", "types"),
    [
        ({}, {THROUGH}),
        ({"disallow": "pedestrian"}, {THROUGH}),
        ({"allow": "all"}, {THROUGH}),
        ({"allow": "pedestrian"}, {"sidewalk"}),
        ({"allow": "pedestrian bicycle"}, {"sidewalk"}),
        ({"allow": "bicycle"}, {"bicycleLane"}),
        ({"allow": "bus taxi bicycle"}, {*BUSES, "cyclesAllowed", "taxisAllowed", THROUGH}),
        ({"allow": "bus taxi"}, {*BUSES, "taxisAllowed", THROUGH}),
        ({"allow": "bus"}, {*BUSES, THROUGH}),
        ({"allow": "emergency authority"}, {"shoulder", THROUGH}),
        ({"allow": "emergency passenger"}, {THROUGH}),
        ({"allow": "bus passenger"}, {THROUGH}),
        ({"allow": "tram"}, {"restricted_area", "rail"}),
        ({"type": "highway.residential"}, {"urban", "ordinary", THROUGH}),
        ({"type": "highway.secondary"}, {"ordinary", THROUGH}),
        ({"type": "highway.trunk"}, {THROUGH}),
        ({"speed": "27.78"}, {"rural", THROUGH}),
        ({"disallow": "all"}, {"restricted_area"}),
        ({"type": "highway.motorway"}, {"highway", THROUGH}),
        ({"type": "highway.motorway_link"}, {"highway"}),
        ({"function": "crossing", "allow": "pedestrian"}, {"crosswalk"}),
        ({"function": "walkingarea", "allow": "pedestrian"}, {"sidewalk"}),
    ],
)
def test_what_lanes_are_for(tmp_path, attributes, types):
    assert lanelets(tmp_path, lane(**attributes))["e_0"].types == types


@pytest.mark.parametrize(
    ("state", "light", "types"),
    [("M", "", {"crosswalk"}), ("m", "", {"sidewalk"}), ("m", 'tl="x"', {"crosswalk", "directed"})],
)
def test_a_crossing_gives_priority_or_has_a_light(tmp_path, state, light, types):
    """Where walkers have to wait for a gap there is a way across, and no crossing by law."""
    before = 'from=":x_w0" to=":x_c0" fromLane="0" toLane="0" dir="s" state="M"'
    assert before in ROAD_NET
    text = ROAD_NET.replace(before, f'{before[:-2]}{state}" {light}')
    assert lanelets(tmp_path, text)[":x_c0_0"].types == types


def test_a_crossing_has_priority_if_walkers_have_it_from_one_side(tmp_path):
    other = (
        '<connection from=":x_w1" to=":x_c0" fromLane="0" toLane="0" dir="s" state="m"/>\n</net>'
    )
    text = ROAD_NET.replace("</net>", other)
    assert lanelets(tmp_path, text)[":x_c0_0"].types == {"crosswalk"}


@pytest.mark.parametrize(
    ("speed", "kmh"), [(13.89, 50), (8.33, 30), (27.78, 100), (13.41, 48.276), (12.0, 43.2)]
)
def test_limits_are_whole_where_they_can_be(tmp_path, speed, kmh):
    found = lanelets(tmp_path, lane().replace("13.89", str(speed)))["e_0"]
    assert found.limit_mps * 3.6 == pytest.approx(kmh, abs=1e-9)


def test_the_limit_goes_on_through_a_junction(tmp_path):
    """How fast one gets around the bend is no limit; pavements have none."""
    text = ROAD_NET.replace('speed="13.89" length="4.00"', 'speed="3.65" length="4.00"')
    found = lanelets(tmp_path, text)
    assert found[":x_0_0"].limit_mps * 3.6 == pytest.approx(50)
    assert found["in_0"].limit_mps is None
    assert found[":x_w0_0"].limit_mps is None


@pytest.mark.parametrize(("state", "signs"), [("s", {"STOP"}), ("w", {"STOP"}), ("m", set())])
def test_stop_signs(tmp_path, state, signs):
    text = ROAD_NET.replace(
        'via=":x_0_0" dir="s" state="m"', f'via=":x_0_0" dir="s" state="{state}"'
    )
    assert lanelets(tmp_path, text)["in_1"].signs == signs


@pytest.mark.parametrize("number", ["1_0", "１０"])
def test_a_number_is_one_as_formats_write_it(tmp_path, number):
    """Python reads these as 10."""
    with pytest.raises(RulecError, match=f"`speed` of a `lane` is `{number}`"):
        lanelets(tmp_path, lane(speed=number))


def test_a_lane_without_length_is_passed_over(tmp_path):
    text = ROAD_NET.replace('shape="200.00,-4.80 204.00,-4.80"', 'shape="200,-4.8 200,-4.8"')
    found = lanelets(tmp_path, text)
    assert ":x_0_0" not in found
    assert found["in_1"].successors == ("out_1",)
    assert found["out_1"].predecessors == ("in_1",)


def test_only_where_roads_meet_is_a_junction(tmp_path):
    """At x a road goes on; with a third road it is a junction."""
    assert lanelets(tmp_path)[":x_0_0"].types == {THROUGH}
    third = '<edge id="side" from="c" to="x"><lane id="side_0" index="0" speed="9"'
    text = ROAD_NET.replace("</net>", f'{third} shape="202,90 202,4"/></edge></net>')
    assert "intersection" in lanelets(tmp_path, text)[":x_0_0"].types


@pytest.mark.parametrize("letter", ["s", "l"])
def test_a_way_that_a_net_calls_straight_on(tmp_path, letter):
    """In a junction; of a way in parts the first one's letter counts, all others being straight."""
    third = '<edge id="side" from="c" to="x"><lane id="side_0" index="0" speed="9"'
    text = ROAD_NET.replace("</net>", f'{third} shape="202,90 202,4"/></edge></net>')
    own = 'via=":x_0_0" dir="s"'
    assert own in text
    inner = '<connection from=":x_1" to="out" fromLane="0" toLane="0" via=":x_0_0" dir="s"/></net>'
    text = text.replace(own, own[:-2] + f'{letter}"').replace("</net>", inner)
    assert ("straightOn" in lanelets(tmp_path, text)[":x_0_0"].types) == (letter == "s")
    assert "straightOn" not in lanelets(tmp_path)[":x_0_0"].types


@pytest.mark.parametrize(
    ("side_way", "foes", "meets"),
    [
        # Nobody is in anybody's way where a road parts
        ("in", ("000", "000", "000"), False),
        # Lanes of one road become one; all go over a crossing
        ("in", ("0010", "0001", "0000", "0000"), False),
        ("in", ("1000", "1000", "1000", "0111"), False),
        # Another road joins the first way
        ("side", ("100", "000", "001"), True),
    ],
)
def test_a_node_whose_ways_do_not_meet_is_no_junction(tmp_path, side_way, foes, meets):
    """Nets part roads anywhere; there nobody turns off, and no rule of junctions holds."""
    ways = [":x_0_0", ":x_0_1", ":x_2_0", ":x_c0_0"][: len(foes[0])]
    rows = "".join(f'<request index="{k}" response="" foes="{x}"/>' for k, x in enumerate(foes))
    text = ROAD_NET.replace(
        "</net>",
        '<edge id=":x_2" function="internal"><lane id=":x_2_0" index="0" speed="9" '
        'shape="200,-4.8 202,-9"/></edge><edge id="side" from="x" to="c"><lane id="side_0" '
        f'index="0" speed="9" shape="202,-9 202,-90"/></edge><junction id="x" type="priority" '
        f'intLanes="{" ".join(ways)}">{rows}</junction><connection from="{side_way}" '
        f'to="side" fromLane="{0 if side_way == "side" else 1}" toLane="0" via=":x_2_0"/></net>',
    )
    found = lanelets(tmp_path, text)
    assert ("intersection" in found[":x_0_0"].types) == meets
    assert bool(found[":x_0_0"].junction) == meets


def test_where_more_is_allowed_within_a_junction_that_holds(tmp_path):
    """As before a road on which one may go faster: who speeds up there does what the net says."""
    text = ROAD_NET.replace('speed="13.89" length="4.00"', 'speed="19.44" length="4.00"')
    found = lanelets(tmp_path, text)
    assert found[":x_0_0"].limit_mps * 3.6 == pytest.approx(70)
    assert found["in_1"].limit_mps * 3.6 == pytest.approx(50)


@pytest.mark.parametrize(("behind", "kept"), [("bus", True), ("bus passenger", False)])
def test_a_way_from_a_lane_for_buses_is_kept_for_them_if_the_lane_behind_it_is(
    tmp_path, behind, kept
):
    text = ROAD_NET.replace(
        '"in_1" index="1" disallow="pedestrian"', '"in_1" index="1" allow="bus"'
    )
    text = text.replace(
        '":x_0_0" index="0" disallow="pedestrian"', '":x_0_0" index="0" allow="bus"'
    )
    text = text.replace(
        '"out_1" index="1" disallow="pedestrian"', f'"out_1" index="1" allow="{behind}"'
    )
    found = lanelets(tmp_path, text)
    assert "busLane" in found["in_1"].types
    assert ("busLane" in found[":x_0_0"].types) == kept


LIGHT = """\
<tlLogic id="x" type="static" programID="0" offset="5">
  <phase duration="30" state="Gr"/><phase duration="3" state="yr"/><phase duration="7" state="rG"/>
</tlLogic>
</net>"""


def with_light(link=0, light=LIGHT):
    text = ROAD_NET.replace('via=":x_0_0"', f'via=":x_0_0" tl="x" linkIndex="{link}"')
    return text.replace("</net>", light)


@pytest.mark.parametrize(
    ("link", "phases"),
    [(0, (("green", 60), ("yellow", 6), ("red", 14))), (1, (("red", 66), ("green", 14)))],
)
def test_lights(tmp_path, link, phases):
    """Phases that look alike are one; steps are half seconds; the programme begins at 5 s."""
    (light,) = lanelets(tmp_path, with_light(link))["in_1"].lights
    assert light == Light(10, phases)
    assert light.colour_at(10) == phases[0][0]
    assert light.colour_at(9) == phases[-1][0]


def test_lights_that_show_the_same_are_one(tmp_path):
    """Two ways lead on from a lane: over links 0 and 2, which are alike, or 0 and 1."""
    light = LIGHT.replace('"Gr"', '"GrG"').replace('"yr"', '"yry"').replace('"rG"', '"rGr"')
    for link, count in ((2, 1), (1, 2)):
        way = (
            '<connection from="in" to="out" fromLane="1" toLane="2" dir="s" state="m" tl="x" '
            f'linkIndex="{link}"/>'
        )
        text = with_light(light=way + light)
        assert len(lanelets(tmp_path, text)["in_1"].lights) == count


@pytest.mark.parametrize(
    "light",
    [
        LIGHT.replace("static", "actuated"),
        LIGHT.replace("</net>", "") + LIGHT.replace('programID="0"', 'programID="1"'),
    ],
)
def test_lights_that_a_net_cannot_tell(tmp_path, light):
    assert lanelets(tmp_path, with_light(light=light))["in_1"].lights == ()
    assert read_net(tmp_path / "road.net.xml").unknown_lights() == ["x"]


def test_a_light_without_this_link_is_none(tmp_path):
    assert lanelets(tmp_path, with_light(link=7))["in_1"].lights == ()


@given(
    st.lists(st.tuples(st.floats(1, 20), st.floats(-1.0, 1.0)), min_size=1, max_size=6),
    st.floats(0.5, 3.0),
)
def test_a_border_is_parallel(pieces, offset):
    """Each piece of it runs as its piece of the line does, at that distance to the left."""
    points = [np.zeros(2)]
    heading = 0.0
    for length, turn in pieces:
        heading += turn
        points.append(points[-1] + length * np.array([np.cos(heading), np.sin(heading)]))
    points = np.array(points)
    line = parallel_line(points, offset)
    ahead = np.diff(points, axis=0)
    ahead /= np.hypot(*ahead.T)[:, None]
    across = np.stack((-ahead[:, 1], ahead[:, 0]), axis=1)
    for start, end, one, other in zip(points, points[1:], line, line[1:], strict=False):
        piece = np.flatnonzero((points == start).all(axis=1))[0]
        assert (one - start) @ across[piece] == pytest.approx(offset)
        assert (other - end) @ across[piece] == pytest.approx(offset)


@given(st.lists(st.sampled_from([(0.0, 0.0), (0.001, 0.0), (5.0, 0.0), (5.0, 4.0)]), min_size=1))
def test_points_without_repeats_are_apart(points):
    kept = without_repeats(np.array(points), 0.01)
    assert (np.hypot(*np.diff(kept, axis=0).T) > 0.01).all()
    assert kept[0].tolist() == list(points[0])
    assume(len(kept) > 1)
    assert np.isfinite(parallel_line(kept, 1.0)).all()
