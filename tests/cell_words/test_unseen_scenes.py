"""In scenes of roads and traffic made by chance, the first maneuver is what a driver would do."""

import random
from dataclasses import replace
from itertools import pairwise

import pytest

from rulec import compile_rulebook, find_maneuvers, navigation_graph, parse_rulebook
from rulec.planning.ranking.proven import ALIKE
from rulec.scenario import MotionBounds
from support.generators.built_scenes import KINDS, built
from support.generators.driven_motions import driven, is_free, paths_of
from support.oracles.compared_maneuvers import check

FREE = parse_rulebook("rulebook free signal p default false hard rule r { require true }")
SCENES = [4, pytest.param(120, marks=pytest.mark.long)]
"""So many scenes of each kind; each takes 0.2 to 0.9 s."""

GENTLE = MotionBounds(acceleration=1.5, braking=1.5, lateral_acceleration=0.5, lateral_speed=1.0)
PIECES = 10


@pytest.fixture(scope="module")
def german():
    return compile_rulebook("de")


def scenes(kind, number):
    for seed in range(number):
        yield built(kind, random.Random(f"{kind} {seed}"))


def every_cell(graph):
    """The graph with the cells that ego cannot reach when their layers begin, but later on."""
    return navigation_graph(
        graph.scenario,
        partition=graph.partition,
        extent=graph.extent,
        bounds="none",
        step_s=graph.step_s,
        horizon_s=graph.step_s * (len(graph.layers) - 1),
    )


@pytest.mark.parametrize("number", SCENES)
@pytest.mark.parametrize("kind", KINDS)
def test_the_first_maneuver_is_what_a_driver_would_do(german, kind, number):
    """In none of them has ego to stop, to brake by more than 2.5 m/s², or to leave its lane."""
    for scene in scenes(kind, number):
        for book in (FREE, german):
            found = find_maneuvers(scene.scenario, book, partition="fine")
            (first,) = found.cheapest(1, perhaps=True)
            states = first.trajectory.states
            assert all(after[1] >= before[1] - 1e-4 for before, after in pairwise(states))
            assert min(state[2] for state in states) > 0.5
            hardest = max(first.trajectory.greatest_acceleration, first.trajectory.greatest_braking)
            assert hardest <= 4.0
            if scene.goes_on:
                # At its speed, in its lane's middle: nothing costs less, up to the search's width
                assert first.cost <= ALIKE + 1e-3


@pytest.mark.parametrize("number", SCENES)
@pytest.mark.parametrize("kind", KINDS)
def test_what_it_drives_has_the_verdicts_of_its_maneuver(german, kind, number):
    drives = sum(check(find_maneuvers(scene.scenario, german), 2) for scene in scenes(kind, number))
    assert drives > number / 2


@pytest.mark.parametrize("number", SCENES)
@pytest.mark.parametrize("kind", KINDS)
def test_gentle_motions_where_nobody_comes_are_paths(kind, number):
    """Going on at ego's speed, if that is possible, and speeding up, braking and moving aside."""
    free = 0
    for seed, scene in enumerate(scenes(kind, number)):
        graph = find_maneuvers(scene.scenario, FREE, partition="fine").graph
        whole = every_cell(graph)
        chance, layers, ego = random.Random(seed), len(graph.layers), scene.scenario.ego
        step, count = graph.step_s / PIECES, PIECES * (layers - 1) + 1
        gentle = replace(GENTLE, speed=graph.bounds.speed)
        steady = [(ego.s + ego.speed * step * k, ego.speed, ego.d, 0.0) for k in range(count)]
        others = [driven(ego, gentle, step, count, chance, pieces=1) for _ in range(60)]
        for states in (steady, *others):
            places = enumerate((s, d) for s, _, d, _ in states)
            is_clear = all(is_free(whole, k, PIECES, s, d) for k, (s, d) in places)
            if is_clear:
                free += 1
                assert paths_of(graph, states[::PIECES]) is not None
            assert states is not steady or is_clear or not scene.goes_on
    assert free > number / 4
