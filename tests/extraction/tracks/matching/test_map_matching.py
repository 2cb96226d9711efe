"""The likeliest lanelets of a track: single states, whole drives, and where a drive breaks."""

from dataclasses import replace
from itertools import groupby, pairwise
from math import atan2, pi, radians, sqrt

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from rulec.extraction.tracks.matching.lanelet_graph import LaneletGraph
from rulec.extraction.tracks.matching.map_matching import (
    BETA_M,
    BREAK_COST,
    CHANGE_COST,
    NEAR_M,
    SIGMA_M,
    MapMatching,
    candidates,
)
from rulec.extraction.tracks.tracks import tracks_of
from rulec.extraction.traffic_thresholds import USUAL
from rulec.recordings.recording import Participant, TrackState
from support.builders.recordings import lanelet, recording, rectangle, straight, vehicle
from support.generators.lanelet_grids import lanelet_grid, street


def found_for(lanes, *participants):
    found = recording(lanes, participants)
    return candidates(LaneletGraph(found), tracks_of(found, USUAL))


def costs(x=50.0, y=0.0, heading=0.0):
    """The costs of the lanelets 1, from y = -2 to 2, and 2, that leads the other way beside it."""
    lanes = [straight(1, 0, 100), straight(2, 100, 0, y=4)]
    found = found_for(lanes, vehicle(7, {0: (x, y)}, heading=heading))
    return dict(zip((found.names[k] for k in found.lanes), found.costs.tolist(), strict=True))


def matched(lanes, body):
    """The chain of each stretch, and the lanelets of its states."""
    found = recording(lanes, [body])
    matching = MapMatching(found, tracks_of(found, USUAL), LaneletGraph(found))
    return [(one.chain, [one.chain[k] for k in one.places]) for one in matching.of(0)]


def along(*places, **more):
    return vehicle(7, dict(enumerate(places)), **more)


def test_in_the_middle_and_along_it_costs_nothing():
    assert costs() == {"1": 0.0}


def test_a_standard_deviation_costs_half():
    assert costs(y=SIGMA_M) == {"1": pytest.approx(0.5)}
    assert costs(heading=radians(-20)) == {"1": pytest.approx(0.5)}
    assert costs(y=2 * SIGMA_M, heading=radians(20)) == {"1": pytest.approx(2.5)}


def test_who_is_beside_all_lanes_is_on_none():
    assert costs(y=-2 - NEAR_M + 0.01) != {}
    assert costs(y=-2 - NEAR_M - 0.01) == {}


def test_a_lane_that_leads_the_other_way_does_not_match():
    assert costs(y=4, heading=pi) == {"2": pytest.approx(0.0)}
    assert set(costs(y=4)) == {"1"}


def test_standing_participants_and_other_surfaces_have_no_match():
    standing = found_for([straight(1, 0, 100)], vehicle(7, {0: (50, 0)}, standing=True))
    assert len(standing.rows) == 0
    pavement = straight(1, 0, 100, types=frozenset({"sidewalk"}))
    assert len(found_for([pavement], vehicle(7, {0: (50, 0)})).rows) == 0


def test_columns_come_in_order_and_without_gaps_filled():
    body = vehicle(7, {0: (50, 0), 1: (50, 90), 2: (60, 0), 5: (70, 0)})
    assert found_for([straight(1, 0, 100)], body).columns.tolist() == [0, 2, 5]


def test_a_change_of_lanes_counts_once_and_where_it_is():
    lanes = [straight(1, 0, 200, left_of=2), straight(2, 0, 200, y=4, right_of=1)]
    places = [(10, 0), (20, 0), (30, 0.9), (40, 1.2), (50, 0.8), (60, 2.4), (70, 4), (80, 4)]
    ((chain, lanelets),) = matched(lanes, along(*places))
    assert chain == ("1", "2")
    assert lanelets == ["1"] * 5 + ["2"] * 3


def test_who_stands_on_the_mark_does_not_flip():
    lanes = [straight(1, 0, 200, left_of=2), straight(2, 0, 200, y=4, right_of=1)]
    wavering = [(50 + 0.01 * k, 2 + 0.2 * (-1) ** k) for k in range(60)]
    ((chain, _),) = matched(lanes, along((10, 0), (20, 0), (30, 1), *wavering, (60, 4), (80, 4)))
    assert chain == ("1", "2")


def test_a_lanelet_that_is_left_sideways_was_never_driven():
    # 2 leads straight on, 3 bends away, and 4, across, begins nowhere near
    lanes = [
        straight(1, 0, 100, successors=("2", "3")),
        straight(2, 100, 200, predecessors=("1",)),
        lanelet(3, [(100, 0), (120, 1), (130, 5), (134, 15), (134, 60)], predecessors=("1",)),
        lanelet(4, [(130, -60), (130, 60)]),
    ]
    places = [(80, 0), (95, 0), (105, 0.1), (112, 0.3), (120, 1), (130, 5), (134, 15), (134, 30)]
    turns = [0, 0, 0, 0.1, 0.4, 1.1, pi / 2, pi / 2]
    states = {k: TrackState(*place, turns[k], 5, 0) for k, place in enumerate(places)}
    outlines = {k: rectangle(*place, 4, 2, turns[k]) for k, place in enumerate(places)}
    ((chain, _),) = matched(lanes, Participant("7", "car", False, states, outlines))
    assert chain == ("1", "3")


@given(st.lists(st.tuples(st.integers(0, 5), st.floats(1, 99), st.floats(-1.9, 1.9)), min_size=1))
def test_on_disjoint_lanes_the_lane_is_found(places):
    lanes = [straight(k, 0, 100, y=100 * k) for k in range(6)]
    body = vehicle(7, {step: (x, 100 * lane + y) for step, (lane, x, y) in enumerate(places)})
    found = [name for _, lanelets in matched(lanes, body) for name in lanelets]
    assert found == [str(lane) for lane, _, _ in places]


GRID = lanelet_grid(4)
BY_ID = {one.id: one for one in GRID}


@st.composite
def noisy_drives(draw):
    """A chain of lanelets through the grid, and a car along it, now fast, now slow or standing."""
    starts = [own for own in BY_ID if "-" not in own]
    chain = [draw(st.sampled_from(starts))]
    for _ in range(2 * draw(st.integers(0, 4))):
        # At the corners of the grid a lane may lead nowhere
        if after := BY_ID[chain[-1]].successors:
            chain.append(draw(st.sampled_from(after)))
    line = shapely.LineString(np.concatenate([BY_ID[name].centre for name in chain]))
    steps = draw(st.lists(st.sampled_from([0.0, 0.2, 1.0, 1.4, 3.0]), min_size=5, max_size=20))
    seed = np.random.default_rng(draw(st.integers(0, 2**32)))
    s, k, states, outlines = 5.0, 0, {}, {}
    while s < line.length - 5:
        here, ahead = (line.interpolate(x) for x in (s, s + 0.5))
        x, y = np.array([here.x, here.y]) + seed.uniform(-0.3, 0.3, 2)
        heading = atan2(ahead.y - here.y, ahead.x - here.x) + seed.uniform(-0.1, 0.1)
        states[k] = TrackState(x, y, heading, 0.0, 0.0)
        outlines[k] = rectangle(x, y, 4, 2, heading)
        # Nobody stands for ever
        s, k = s + max(steps[k % len(steps)], 0.02), k + 1
    return tuple(chain), Participant("7", "car", False, states, outlines)


@settings(max_examples=settings().max_examples // 3)  # each goes through a whole grid
@given(noisy_drives())
def test_a_noisy_drive_through_a_grid_is_matched_to_its_chain(drive):
    chain, body = drive
    ((found, lanelets),) = matched(GRID, body)
    assert found == chain
    # Each lanelet once and in its order: no state flips back
    assert [name for name, _ in groupby(lanelets)] == [name for name in chain if name in lanelets]


def cheapest_by_hand(found, tracks, graph, row):
    """The lanelets of a participant by column, every candidate tried after each one before."""
    paths, before = {}, None
    for state in np.flatnonzero(found.rows == row):
        column, own = found.columns[state], slice(found.first[state], found.first[state + 1])
        options = [
            (found.names[lane], cost, s)
            for lane, cost, s in zip(found.lanes[own], found.costs[own], found.along[own])  # noqa: B905
        ]
        if before is None or not tracks.present[row, before:column].all():
            yield from least(paths)
            paths = {name: (cost, [name], s) for name, cost, s in options}
        else:
            # To the last digit, since equal costs are decided by name
            dx, dy = (getattr(tracks, k)[row, [before, column]] @ [-1, 1] for k in "xy")
            moved = sqrt(dx * dx + dy * dy)
            weight = min(1.0, moved / (2 * SIGMA_M))
            paths = {
                name: (*further(paths, graph, name, s, moved, weight * cost), s)
                for name, cost, s in options
            }
        before = column
    yield from least(paths)


def further(paths, graph, name, s, moved, cost):
    ways = []
    for start, (so_far, path, since) in paths.items():
        through, way = np.inf, graph.ways(start).get(name)
        if way is not None:
            off = abs(way.length + s - since - moved) - way.sideways
            through = max(0.0, off) / BETA_M + CHANGE_COST * way.changes
        ways.append((so_far + min(through, BREAK_COST) + cost, [*path, name]))
    return min(ways, key=lambda one: one[0])


def least(paths):
    return min(paths.values(), key=lambda one: (one[0], one[1][-1]))[1] if paths else []


@settings(max_examples=settings().max_examples // 5)
@given(noisy_drives(), noisy_drives(), st.sets(st.integers(0, 60)), st.integers(0, 2**32 - 1))
def test_many_drives_at_once_take_the_cheapest_paths_of_each(one, other, gaps, seed):
    """Drives of any length with gaps, one of them far off its lanes, on a grid with crossings."""
    random, bodies = np.random.default_rng(seed), []
    for number, (_, body) in enumerate((one, other)):
        kept = {k: state for k, state in body.states.items() if k not in gaps or number}
        off = random.normal(size=(len(kept), 2)) * 1.5 * number
        states = {
            k: replace(state, x=state.x + dx, y=state.y + dy)
            for (k, state), (dx, dy) in zip(kept.items(), off.tolist(), strict=True)
        }
        outlines = {k: rectangle(own.x, own.y, 4, 2, own.heading) for k, own in states.items()}
        bodies.append(replace(body, id=str(number), states=states, outlines=outlines))
    bodies = [body for body in bodies if body.states]
    found = recording(GRID, bodies)
    tracks, graph = tracks_of(found, USUAL), LaneletGraph(found)
    own = candidates(graph, tracks)
    by_hand = [list(cheapest_by_hand(own, tracks, graph, row)) for row in range(len(bodies))]
    matching = MapMatching(found, tracks, graph)
    for row, expected in enumerate(by_hand):
        lanelets = [part.chain[k] for part in matching.of(row) for k in part.places]
        assert lanelets == expected


def test_the_grid_is_consistent():
    for own in GRID:
        for name in own.successors:
            assert BY_ID[name].centre[0] == pytest.approx(own.centre[-1])
    assert street((0, 0), 0, 0) in BY_ID
    assert all(
        np.hypot(*(after - before)) > 0 for own in GRID for before, after in pairwise(own.centre)
    )
