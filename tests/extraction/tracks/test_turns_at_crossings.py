"""Turns where no map marks junctions: what crosses other lanes is only the middle of the turn.

Ego comes along y = 0 from the west and turns left onto x = 115, northwards, by an arc of a radius
of 15 m around (100, 15) in three parts of 30 degrees; traffic comes along y = 4 from the east,
which the middle part crosses.
"""

from dataclasses import replace

import numpy as np
import pytest

from rulec.extraction.signals.map import junction_signals
from rulec.extraction.signals.map.junction_signals import turn_at
from rulec.extraction.signals.map.lanes_ahead import Leads, junctions_ahead
from rulec.extraction.tracks.at_junctions.junctions import junctions_of
from support.builders.drive_contexts import context_of
from support.builders.recordings import lanelet, recording, straight, vehicle
from support.signal_arrays import values_of
from support.words import words_of

RADIUS = 15.0
ROUTE = ("1", "2", "3", "4", "5")


def arc(number, first, last, mirror=1, **more):
    """A part of the turn from an angle to another (degrees)."""
    angles = np.radians(np.linspace(first, last, 7))
    xs, ys = RADIUS * np.sin(angles), RADIUS * (1 - np.cos(angles))
    return lanelet(number, [(100 + x, mirror * y) for x, y in zip(xs, ys, strict=True)], **more)


def lanes(mirror=1):
    end = 15.0 * mirror
    return [
        straight(1, 0, 100, successors=("2",)),
        arc(2, 0, 30, mirror, predecessors=("1",), successors=("3",)),
        arc(3, 30, 60, mirror, predecessors=("2",), successors=("4",)),
        arc(4, 60, 90, mirror, predecessors=("3",), successors=("5",)),
        lanelet(5, [(115, end), (115, mirror * 100.0)], predecessors=("4",)),
        lanelet(6, [(200, mirror * 4.0), (0, mirror * 4.0)]),
    ]


def turning(found_lanes):
    ego = vehicle(7, {k: (61 + 14 * k, 0) for k in range(4)})
    return context_of(recording(found_lanes, [ego]), ROUTE)


@pytest.mark.parametrize(("mirror", "turn"), [(1, "turn_far"), (-1, "turn_near")])
def test_a_turn_of_which_only_the_middle_crosses_another_lane(mirror, turn):
    context = turning(lanes(mirror))
    ((start, end),) = context.road.junctions
    # By an arc the middle part begins 7.9 m behind the straight lanelet's end and is as long
    assert (start, end) == (pytest.approx(107.9, abs=0.3), pytest.approx(115.7, abs=0.3))
    assert turn_at(context, start, end) == turn
    assert values_of(words_of(junction_signals)(context), "turn")[-1] == turn


def test_a_way_turns_as_the_road_does():
    context = turning(lanes())
    (junction,) = junctions_of(context.recording)
    (way,) = [way for way in junction.ways if "3" in way.names]
    ((start, end),) = context.road.junctions
    # 30 degrees in the middle part, and as many in the 7.9 m before and behind it
    assert np.degrees(way.turned) == pytest.approx(85, abs=6)
    assert context.road.turned(start, end) == pytest.approx(way.turned, abs=0.1)
    (ahead,) = [x for x in junctions_ahead(context) if x.high > x.low]
    assert ahead.leads[0] is Leads.ALONG


def test_where_a_map_marks_its_junctions_they_turn_from_their_begin_to_their_end():
    marked = lanes()
    marked[2] = replace(marked[2], types=frozenset({"intersection"}), junction="x")
    context = turning(marked)
    ((start, end),) = context.road.junctions
    assert np.degrees(context.road.turned(start, end)) == pytest.approx(30, abs=6)
    (junction,) = junctions_of(context.recording)
    assert np.degrees(junction.ways[0].turned) == pytest.approx(25, abs=6)


def test_a_bend_beyond_the_next_lanelet_is_no_turn():
    """Straight over a crossing, and 6 m behind it by a short lanelet into a bend."""
    found = [
        straight(1, 0, 100, successors=("2",)),
        straight(2, 100, 110, predecessors=("1",), successors=("3",)),
        straight(3, 110, 116, predecessors=("2",), successors=("4",)),
        lanelet(4, [(116, 0), (118, 6), (118, 60)], predecessors=("3",), successors=("5",)),
        lanelet(5, [(118, 60), (118, 90)], predecessors=("4",)),
        lanelet(6, [(105, -40), (105, 40)]),
    ]
    context = turning(found)
    ((start, end),) = context.road.junctions
    assert (start, end) == (pytest.approx(100, abs=0.1), pytest.approx(110, abs=0.1))
    assert turn_at(context, start, end) == "straight_on"
