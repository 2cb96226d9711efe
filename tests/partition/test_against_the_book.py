"""Cells, adjacency, edges and margins of random scenarios against the definitions, by polygons."""

from functools import cache
from itertools import product

import shapely
from hypothesis import assume, example, given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.partition import navigation_graph
from rulec.scenario import load_scenario
from support.generators.random_scenarios import scenarios
from support.oracles import partition_oracle as book

partitions = st.sampled_from(["paper", "fine"])
extents = st.sampled_from(["lane", "clearance", "body"])
adjacencies = st.sampled_from(["touch", "edge", "forward"])


def graph_of(scenario, **options):
    try:
        return navigation_graph(scenario, **options)
    except RulecError as error:
        assume([d.code for d in error.diagnostics] != ["R0607"])
        raise


def layer_interval(graph, p):
    return float(graph.step * p), float(graph.step * (p + 1))


def key(cell):
    # an object that was away and is back has another name; which one it is does not matter here
    signature = tuple((name.split("_")[0], value) for name, value in cell.signature.items())
    return book.BookCell(cell.surface, signature, cell.polygon).key


@given(scenarios(), partitions, extents)
def test_cells_are_those_of_the_definition(scenario, partition, extent):
    graph = graph_of(scenario, partition=partition, extent=extent)
    for p, layer in enumerate(graph.layers):
        expected = book.cells(scenario, *layer_interval(graph, p), partition, extent)
        assert sorted(key(cell) for cell in layer.cells) == sorted(cell.key for cell in expected)


@given(scenarios(), partitions, extents)
def test_cells_are_connected_disjoint_and_cover_the_free_space(scenario, partition, extent):
    graph = graph_of(scenario, partition=partition, extent=extent)
    for p, layer in enumerate(graph.layers):
        polygons = [cell.polygon for cell in layer.cells]
        assert all(polygon.geom_type == "Polygon" and polygon.is_valid for polygon in polygons)
        free = book.free_space(scenario, *layer_interval(graph, p), partition, extent)
        together = shapely.union_all(polygons)
        assert abs(sum(x.area for x in polygons) - together.area) < 1e-6
        assert together.symmetric_difference(free).area < 1e-2


@given(scenarios(), partitions, extents, st.data())
def test_a_point_has_the_signature_of_its_cell(scenario, partition, extent, data):
    """Read off coordinates alone: no polygon, no cell but the one the point is in."""
    graph = graph_of(scenario, partition=partition, extent=extent)
    p = data.draw(st.integers(0, len(graph.layers) - 1))
    s = data.draw(st.floats(0, 40))
    d = data.draw(st.floats(scenario.road.lanes[0], scenario.road.lanes[-1]))
    layer = graph.layers[p]
    holding = [
        cell
        for cell in layer.cells
        if any(b.s_min < s < b.s_max and b.d_min < d < b.d_max for b in cell.boxes)
    ]
    by_hand = classified(scenario, layer_interval(graph, p), partition, extent, s, d)
    if by_hand == "border":
        return
    if by_hand is None:
        assert holding == []
    else:
        assert [(cell.surface, list(cell.signature.values())) for cell in holding] == [by_hand]


def classified(scenario, interval, partition, extent, s, d):
    road = scenario.road
    near = [abs(s - x) for stretch in (*road.surfaces, *road.missing) for x in stretch.s]
    near += [abs(d - x) for x in road.lanes] + [s, abs(40 - s)]
    off_the_verge = []
    for verge in (road.lanes[0], road.lanes[-1]):
        closest = min(book.width(scenario, extent), abs(scenario.ego.d - verge))
        near.append(abs(abs(d - verge) - closest))
        off_the_verge.append(abs(d - verge) > closest)
    if not all(off_the_verge):
        return None if min(near) > 1e-3 else "border"
    lane = sum(bound < d for bound in road.lanes)
    if any(gap.lane == lane and gap.s[0] < s < gap.s[1] for gap in road.missing):
        return None if min(near) > 1e-3 else "border"
    values = []
    for obstacle in scenario.obstacles:
        found = book.taken(scenario, obstacle, *interval, partition, extent)
        if found is None:
            continue
        (s0, s1, d0, d1), angle = found
        near += [abs(s - s0), abs(s - s1), abs(d - d0), abs(d - d1)]
        station = "behind" if s < s0 else "in_front_of" if s > s1 else "beside"
        lateral = "right_of" if d < d0 else "left_of" if d > d1 else "same_lane"
        if (station, lateral) == ("beside", "same_lane"):
            return None if min(near) > 1e-3 else "border"
        values.append(
            (station, lateral) if partition == "fine" else letter(station, lateral, angle)
        )
    if min(near) <= 1e-3:
        return "border"
    crossing = any(x.s[0] < s < x.s[1] for x in road.surfaces)
    return "crossing" if crossing else "carriageway", values


def letter(station, lateral, angle):
    """The obstacle's own eyes: sideways of its lane first, then along it."""
    ahead = {"behind": -1, "beside": 0, "in_front_of": 1}[station]
    left = {"right_of": -1, "same_lane": 0, "left_of": 1}[lateral]
    own = {0: (ahead, left), 180: (-ahead, -left), 90: (left, -ahead), -90: (-left, ahead)}[angle]
    if own[1]:
        return "l" if own[1] > 0 else "r"
    return "f" if own[0] > 0 else "b"


@given(scenarios(most=3), partitions, adjacencies, extents)
@example(load_scenario("s2"), "paper", "touch", "lane")
def test_adjacency_edges_and_margins_are_those_of_the_definition(
    scenario, partition, adjacency, extent
):
    graph = graph_of(scenario, partition=partition, adjacency=adjacency, extent=extent)
    polygons = [[cell.polygon for cell in layer.cells] for layer in graph.layers]

    @cache
    def near(p, i, j):
        return i == j or book.is_step(polygons[p][i], polygons[p][j], adjacency)

    for p, layer in enumerate(graph.layers):
        everyone = range(len(layer.cells))
        for i in everyone:
            assert layer.neighbours[i] == tuple(j for j in everyone if j != i and near(p, i, j))

    goes_on = []
    for p in range(len(graph.layers) - 1):
        moment = float(graph.step * (p + 1))
        instant = book.cells(scenario, moment, moment, partition, extent)
        goes_on.append(
            {
                (i, j)
                for i, now in enumerate(polygons[p])
                for j, then in enumerate(polygons[p + 1])
                if book.continues(now, then, instant)
            }
        )

    @cache
    def open_before(p, a, b):
        """For how many layers up to p the step has been open; 0 if it is not at p."""
        if a == b or not near(p, a, b):
            return 0
        origins = [] if p == 0 else product(goes_on[p - 1], repeat=2)
        return 1 + max(
            (
                open_before(p - 1, x, y)
                for (x, to_a), (y, to_b) in origins
                if (to_a, to_b) == (a, b)
            ),
            default=0,
        )

    @cache
    def open_after(p, a, b):
        if a == b or not near(p, a, b):
            return 0
        images = [] if p == len(goes_on) else product(goes_on[p], repeat=2)
        return 1 + max(
            (
                open_after(p + 1, x, y)
                for (from_a, x), (from_b, y) in images
                if (from_a, from_b) == (a, b)
            ),
            default=0,
        )

    for p, links in enumerate(goes_on):
        now, then = range(len(polygons[p])), range(len(polygons[p + 1]))
        for a in now:
            images = [j for i, j in links if i == a]
            expected = {}
            for b in then:
                origins = [i for i, j in links if j == b]
                if (a, b) in links:
                    expected[b] = None
                elif any(near(p + 1, image, b) for image in images) and any(
                    near(p, a, origin) for origin in origins
                ):
                    expected[b] = max(open_before(p, a, origin) for origin in origins) + max(
                        open_after(p + 1, image, b) for image in images
                    )
            assert graph.successors[p][a] == tuple(expected)
            assert graph.margins[p][a] == tuple(expected.values())


@given(scenarios(), partitions, extents)
def test_each_adjacency_is_part_of_the_next_wider_one(scenario, partition, extent):
    forward, edge, touch = (
        {
            (p, i, j)
            for p, layer in enumerate(
                graph_of(scenario, partition=partition, extent=extent, adjacency=a).layers
            )
            for i, row in enumerate(layer.neighbours)
            for j in row
        }
        for a in ("forward", "edge", "touch")
    )
    assert forward <= edge <= touch
    assert all((p, j, i) in touch for p, i, j in touch)
    assert all((p, j, i) in edge for p, i, j in edge)
