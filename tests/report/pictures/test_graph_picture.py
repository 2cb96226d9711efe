"""The navigation graph: every node and step, told apart by what becomes of maneuvers there."""

from collections import Counter

import pytest

from rulec.report.pictures.graph import graph_picture
from rulec.report.pictures.marks import Area, Line, Words
from rulec.runtime.passages import passages
from rulec.runtime.product import count_paths
from rulec.trace.paths import paths
from rulec.workflow import find_maneuvers


def drawn(scenario, maneuver=None, **options):
    found = find_maneuvers(scenario, "esterle2019", **options)
    ways = passages(found.hard, found.product)
    return found, graph_picture(found.graph, ways, maneuver, judged=True)


def styles(picture, kind):
    return Counter(one.style for one in picture.marks if isinstance(one, kind))


@pytest.mark.parametrize("scenario", ["s1", "s2", "s3"])
def test_every_node_and_every_step_is_there_once(scenario):
    found, picture = drawn(scenario)
    lines, areas = styles(picture, Line), styles(picture, Area)
    # One swatch each in the legend.
    swatches = 2 + (lines["unused"] > 0)
    assert lines.total() - swatches == found.graph.edges
    assert areas.total() - (areas["violated"] > 0) == found.graph.nodes
    on_the_way = {
        (p, way[p], way[p + 1]) for way in paths(found.paths) for p in range(len(way) - 1)
    }
    assert lines["satisfying"] + lines["rejected"] - 2 == len(on_the_way)


def test_rejected_steps_of_s2():
    """R3 forbids being in front of o1 on the crossing: cell 2. So no step to it satisfies there.

    In the last layer it may be entered from the side, where no maneuver has passed o1 on the left.
    """
    found, picture = drawn("s2")
    legend = [one.text for one in picture.marks if isinstance(one, Words)]
    ways = passages(found.hard, found.product)
    accepted = sum(map(len, ways.accepted))
    possible = sum(map(len, ways.possible))
    assert f"{accepted} steps of satisfying maneuvers" in legend
    assert f"{possible - accepted} steps of rejected ones alone" in legend
    assert f"{found.graph.edges - possible} steps of no maneuver" in legend
    assert 0 < accepted < possible < found.graph.edges
    assert count_paths(found.paths) == 139


def test_a_maneuver_is_drawn_through_its_cells():
    found = find_maneuvers("s2", "esterle2019")
    maneuver = found.cheapest(4)[3]
    ways = passages(found.hard, found.product)
    picture = graph_picture(found.graph, ways, maneuver, judged=True)
    tips = [one.tip for one in picture.marks if isinstance(one, Area) and one.style == "chosen"]
    assert [tip.partition(":")[0] for tip in tips] == [
        f"{p} s, cell {node}" for p, node in enumerate(maneuver.nodes)
    ]
    assert styles(picture, Line)["way"] == 4 + 1


def test_many_cells_lose_their_labels_not_their_marks():
    found, picture = drawn("s2", step_s=0.1)
    assert found.graph.nodes == 7 * 41
    areas = styles(picture, Area)
    assert areas.total() - (areas["violated"] > 0) == 7 * 41
    assert picture.width == 900
