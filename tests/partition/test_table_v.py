"""The paper's Table V: nodes, edges and traces of its three scenarios at both steps."""

import pytest

from rulec.partition import NavigationGraph, navigation_graph
from rulec.scenario import load_scenario

TABLE_V = {
    ("s1", 1.0): (20, 32, 16),
    ("s1", 0.5): (36, 70, 672),
    ("s2", 1.0): (35, 124, 139),
    ("s2", 0.5): (63, 248, 75441),
    ("s3", 1.0): (20, 40, 76),
    ("s3", 0.5): (36, 80, 4240),
}


def adjacent_pairs(layer):
    """The pairs of cells between which there is a step."""
    return {(min(i, j), max(i, j)) for i, row in enumerate(layer.neighbours) for j in row}


def count_paths(graph: NavigationGraph) -> int:
    ways = [int(i == graph.start) for i in range(len(graph.layers[0].cells))]
    for p, rows in enumerate(graph.successors):
        after = [0] * len(graph.layers[p + 1].cells)
        for i, followers in enumerate(rows):
            for j in followers:
                after[j] += ways[i]
        ways = after
    return sum(ways[i] for i in graph.goals)


@pytest.mark.parametrize(("name", "step"), TABLE_V)
def test_table_v(name, step):
    graph = navigation_graph(load_scenario(name), step_s=step)
    assert (graph.nodes, graph.edges, count_paths(graph)) == TABLE_V[name, step]


def test_s2_has_twelve_adjacent_pairs_and_four_of_them_are_corners():
    touch = navigation_graph(load_scenario("s2"), adjacency="touch")
    edge = navigation_graph(load_scenario("s2"), adjacency="edge")
    for by_touch, by_edge in zip(touch.layers, edge.layers, strict=True):
        assert len(adjacent_pairs(by_touch)) == 12
        corners = adjacent_pairs(by_touch) - adjacent_pairs(by_edge)
        assert len(corners) == 4


def test_s1_keeps_the_gap_open_for_four_layers_of_half_a_second():
    """19 m, shrinking by 5 m/s; a layer of 0.5 s takes 10 m of it: 9 - 5 t >= 0 up to 1.8 s."""
    graph = navigation_graph(load_scenario("s1"), step_s=0.5)
    opened = []
    for layer in graph.layers:
        signatures = ["".join(cell.signature.values()) for cell in layer.cells]
        pair = tuple(sorted((signatures.index("fl"), signatures.index("rb"))))
        opened.append(pair in adjacent_pairs(layer))
    assert opened == [True] * 4 + [False] * 5


def test_counting_needs_no_heavy_library(tmp_path):
    """Shapely, NetworkX and numpy together take a quarter of a second to import."""
    import subprocess
    import sys

    program = (
        "import sys\n"
        "from rulec.partition import navigation_graph\n"
        "from rulec.scenario import load_scenario\n"
        "navigation_graph(load_scenario('s2')).trace_graph()\n"
        "assert not {'shapely', 'networkx', 'numpy'} & set(sys.modules)\n"
    )
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
