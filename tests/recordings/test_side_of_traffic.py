"""The side on which traffic keeps, by lanes that border on others that lead the other way."""

from dataclasses import replace
from pathlib import Path

import pytest

from rulec import read_recording
from rulec.recordings.adjacency import side_by_lanes, with_side
from support.builders.recordings import lanelet, recording, straight


def reversed_straight(number, start, end, y, **more):
    """A lane that leads from its end to its start."""
    return lanelet(number, [(end, y), (start, y)], **more)


@pytest.mark.parametrize(
    ("y", "side"),
    [
        (4.0, "right"),  # those who come are on the left
        (-4.0, "left"),
        (4.6, None),  # 0.6 m apart
        (0.0, None),  # in the same lane, as on a track
    ],
)
def test_two_lanes(y, side):
    lanes = [straight(1, 0, 100), reversed_straight(2, 0, 100, y)]
    assert side_by_lanes(lanes) == side


def test_a_cycle_lane_against_the_traffic_tells_nothing():
    lanes = [
        straight(1, 0, 100),
        reversed_straight(2, 0, 100, -4.0, types=frozenset({"bicycleLane"})),
    ]
    assert side_by_lanes(lanes) is None


def test_short_stretches_in_a_junction_tell_nothing_nor_do_both_kinds():
    short = [straight(1, 0, 9), reversed_straight(2, 0, 9, 4.0)]
    assert side_by_lanes(short) is None
    both = [
        straight(1, 0, 100),
        reversed_straight(2, 0, 100, 4.0),
        reversed_straight(3, 0, 100, -4.0),
    ]
    assert side_by_lanes(both) is None


def test_what_is_told_stays():
    lanes = [straight(1, 0, 100), reversed_straight(2, 0, 100, 4.0)]
    untold = replace(recording(lanes, []), side=None)
    assert with_side(untold).side == "right"
    assert with_side(replace(untold, side="left")).side == "left"
    assert with_side(replace(untold, lanelets={})).side is None


WORLDS = Path(__file__).parents[1] / "worlds" / "stored"


@pytest.mark.parametrize("net", sorted(WORLDS.glob("*.net.xml")), ids=lambda net: net.name)
def test_the_lanes_of_a_town_tell_what_its_net_does(net):
    drives = net.with_name(net.name.replace(".net.xml", ".fcd.xml.gz"))
    found = read_recording(drives, net)
    told = "left" if "lefthand" in net.read_text(encoding="utf-8") else "right"
    assert found.side == told
    assert side_by_lanes(found.lanelets.values()) in (
        told,
        None if "motorway" in net.name else told,
    )
