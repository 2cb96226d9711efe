"""What lanes of a SUMO net are for, by where they lead."""

import pytest

from rulec.recordings.sumo.lanelets import net_lanelets
from rulec.recordings.sumo.net import read_net

KINDS = "mainCarriageWay", "exitRamp", "accessRamp"
MOTORWAY, LINK = "highway.motorway", "highway.motorway_link"


def edge(name, start, end, lanes, kind=MOTORWAY, length=500):
    rows = "".join(
        f'<lane id="{name}_{k}" index="{k}" speed="30" shape="0,{3 * k} {length},{3 * k}"/>'
        for k in range(lanes)
    )
    return f'<edge id="{name}" from="{start}" to="{end}" type="{kind}">{rows}</edge>'


def lead(start, end, *pairs):
    return "".join(
        f'<connection from="{start}" to="{end}" fromLane="{a}" toLane="{b}" state="M"/>'
        for a, b in pairs
    )


def kinds(tmp_path, *parts):
    """Lane -> what it is for, of those of which it is known."""
    file = tmp_path / "road.net.xml"
    file.write_text(f"<net>{''.join(parts)}</net>", encoding="utf-8")
    found = net_lanelets(read_net(file), 0.1)
    return {key: kind for key, lane in found.items() for kind in KINDS if kind in lane.types}


def test_the_lanes_of_a_road_go_on_to_the_end_of_the_net(tmp_path):
    found = kinds(
        tmp_path, edge("a", "x", "y", 2), edge("b", "y", "z", 2), lead("a", "b", (0, 0), (1, 1))
    )
    assert found == dict.fromkeys(("a_0", "a_1", "b_0", "b_1"), "mainCarriageWay")


def test_to_turn_round_is_no_way_on(tmp_path):
    """Most nets let everybody turn round at the end of every road."""
    found = kinds(tmp_path, edge("a", "x", "y", 2), edge("b", "y", "x", 2), lead("a", "b", (1, 1)))
    assert set(found.values()) == {"mainCarriageWay"}
    assert len(found) == 4


def test_before_lanes_part_arrows_may_be(tmp_path):
    """Of two lanes, one to each of two roads, nobody knows the signs; of a single lane one does."""
    found = kinds(
        tmp_path,
        *(edge("a", "x", "y", 2), edge("b", "y", "z", 1), edge("c", "y", "w", 1)),
        *(lead("a", "b", (0, 0)), lead("a", "c", (1, 0))),
    )
    assert found == {"b_0": "mainCarriageWay", "c_0": "mainCarriageWay"}


@pytest.mark.parametrize(("length", "known"), [(400, False), (1200, True)])
def test_a_kilometre_before_there_are_none(tmp_path, length, known):
    found = kinds(
        tmp_path,
        *(edge("a", "u", "x", 2), edge("b", "x", "y", 2, length=length)),
        *(edge("c", "y", "z", 1), edge("d", "y", "w", 1)),
        *(lead("a", "b", (0, 0), (1, 1)), lead("b", "c", (0, 0)), lead("b", "d", (1, 0))),
    )
    assert ("a_0" in found) == known
    assert "b_0" not in found


def test_a_lane_that_ends_beside_others_is_none_of_those_that_go_on(tmp_path):
    found = kinds(tmp_path, edge("a", "x", "y", 2), edge("b", "y", "z", 1), lead("a", "b", (1, 0)))
    assert found == dict.fromkeys(("a_1", "b_0"), "mainCarriageWay")


def test_before_a_lane_of_a_motorway_ends_the_others_go_on(tmp_path):
    """Three lanes, four beside a ramp, then two: nobody leaves, whichever lane ends."""
    found = kinds(
        tmp_path,
        *(
            edge("a", "x", "y", 3),
            edge("on", "o", "y", 1, LINK),
            edge("b", "y", "z", 4, length=300),
        ),
        *(edge("c", "z", "w", 3, length=300), edge("d", "w", "v", 2), lead("on", "b", (0, 0))),
        lead("a", "b", (0, 1), (1, 2), (2, 3)),
        *(lead("b", "c", (1, 0), (2, 1), (3, 2)), lead("c", "d", (0, 0), (1, 1))),
    )
    through = {f"{name}_{k}" for name, ks in (("a", "01"), ("b", "12"), ("c", "01")) for k in ks}
    assert {key for key, kind in found.items() if kind == "mainCarriageWay"} == {
        *through,
        *("d_0", "d_1"),
    }
    assert found["b_0"] == "accessRamp"


def test_lanes_that_join_and_leave(tmp_path):
    found = kinds(
        tmp_path,
        *(edge("a", "x", "y", 2), edge("on", "o", "y", 1, LINK), edge("b", "y", "z", 3)),
        *(edge("c", "z", "w", 2), edge("d", "w", "v", 3), edge("e", "v", "t", 2)),
        *(edge("off", "v", "s", 1, LINK), lead("on", "b", (0, 0)), lead("a", "b", (0, 1), (1, 2))),
        *(lead("b", "c", (1, 0), (2, 1)), lead("c", "d", (0, 0), (0, 1), (1, 2))),
        *(lead("d", "off", (0, 0)), lead("d", "e", (1, 0), (2, 1))),
    )
    assert found["b_0"] == "accessRamp"
    assert found["d_0"] == "exitRamp"
    assert "on_0" not in found
    goes_on = {
        *(("a", k) for k in (0, 1)),
        *(("b", k) for k in (1, 2)),
        *(("c", k) for k in (0, 1)),
    }
    goes_on |= {*(("d", k) for k in (1, 2)), *(("e", k) for k in (0, 1))}
    assert {found[f"{name}_{k}"] for name, k in goes_on} == {"mainCarriageWay"}


def test_beside_joining_lanes_of_other_roads_nobody_knows_the_arrows(tmp_path):
    found = kinds(
        tmp_path,
        *(edge("a", "x", "y", 2, ""), edge("b", "y", "z", 3, "")),
        *(edge("c", "z", "w", 2, ""), edge("off", "z", "s", 1, "")),
        *(lead("a", "b", (0, 0), (0, 1), (1, 2)), lead("b", "off", (0, 0))),
        lead("b", "c", (1, 0), (2, 1)),
    )
    assert {found.get(f"{name}_{k}") for name, k in (("a", 0), ("a", 1), ("b", 1))} == {None}


def test_where_a_motorway_parts_its_lanes_are_for_several_roads(tmp_path):
    """Its near lane leads to one of two, its far lane to the other, the one between to both."""
    found = kinds(
        tmp_path,
        *(edge("a", "x", "y", 3), edge("b", "y", "z", 2), edge("c", "y", "w", 2)),
        *(lead("a", "b", (0, 0), (1, 1)), lead("a", "c", (1, 0), (2, 1))),
    )
    assert not any(name.startswith("a_") for name in found)


@pytest.mark.parametrize("pieces", [1, 2])
def test_a_lane_that_joins_and_ends_needs_no_type(tmp_path, pieces):
    """From another road than those beside it, over one edge or two, and then on to none."""
    found = kinds(
        tmp_path,
        *(edge("a", "x", "y", 2, ""), edge("on", "o", "y", 1, ""), edge("b", "y", "z", 3, "")),
        *(edge("c", "z", "w", 3 if pieces == 2 else 2, ""), edge("d", "w", "v", 2, "")),
        *(lead("a", "b", (0, 1), (1, 2)), lead("on", "b", (0, 0))),
        lead("b", "c", *([(0, 0), (1, 1), (2, 2)] if pieces == 2 else [(1, 0), (2, 1)])),
        lead("c", "d", *([(1, 0), (2, 1)] if pieces == 2 else [(0, 0), (1, 1)])),
    )
    joining = {key for key, kind in found.items() if kind == "accessRamp"}
    assert joining == ({"b_0", "c_0"} if pieces == 2 else {"b_0"})


def test_a_lane_of_the_road_itself_that_ends_is_none_to_join(tmp_path):
    """Three lanes of one road become two: there they take turns."""
    found = kinds(
        tmp_path,
        *(edge("a", "x", "y", 3, ""), edge("b", "y", "z", 3, ""), edge("c", "z", "w", 2, "")),
        *(lead("a", "b", (0, 0), (1, 1), (2, 2)), lead("b", "c", (1, 0), (2, 1))),
    )
    assert "accessRamp" not in found.values()
