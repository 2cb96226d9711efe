"""The navigation graph: every node and step, told apart by what becomes of maneuvers there."""

from collections import Counter

import pytest

from rulec import find_maneuvers
from rulec.planning.product.graph_product import accepted_edges
from rulec.report.pictures.drawing.canvas import Area, LabelText, Polyline
from rulec.report.pictures.graph_picture import graph_picture
from rulec.trace.trace_model import paths


def drawn(scenario, maneuver=None, **options):
    found = find_maneuvers(scenario, "esterle2019", **options)
    ways = accepted_edges(found.hard, found.product)
    return found, graph_picture(found.graph, ways, maneuver, judged=True)


def styles(picture, kind):
    return Counter(one.style for one in picture.marks if isinstance(one, kind))


@pytest.mark.parametrize("scenario", ["s1", "s2", "s3"])
def test_every_node_and_every_step_is_there_once(scenario):
    found, picture = drawn(scenario)
    lines, areas = styles(picture, Polyline), styles(picture, Area)
    # One swatch each in the legend.
    swatches = 2 + (lines["unused"] > 0)
    assert lines.total() - swatches == found.graph.edges
    assert areas.total() - (areas["violated"] > 0) == found.graph.nodes
    on_the_way = {
        (p, way[p], way[p + 1]) for way in paths(found.paths) for p in range(len(way) - 1)
    }
    assert lines["satisfying"] + lines["rejected"] - 2 == len(on_the_way)


def test_rejected_steps_of_s2():
    """R2 forbids passing o1 on the left into the cell on the crossing in front of it, number 2.

    With the third layer no other way has led there, so that none of its steps is satisfying.
    """
    found, picture = drawn("s2")
    tips = [one.tip for one in picture.marks if isinstance(one, Area) and one.style == "violated"]
    assert [tip for tip in tips if tip] == ["2 s, cell 2: crossing, f(o1)"]
    ways = accepted_edges(found.hard, found.product)
    here = {edge for edge in ways.possible[2] if edge[0] == 2}
    assert here
    assert not here & ways.accepted[2]
    accepted, possible = (sum(map(len, edges)) for edges in (ways.accepted, ways.possible))
    assert {one.text for one in picture.marks if isinstance(one, LabelText)} >= {
        f"{accepted} steps of satisfying maneuvers",
        f"{possible - accepted} steps of rejected ones alone",
        f"{found.graph.edges - possible} steps of no maneuver",
    }


def test_a_maneuver_is_drawn_through_its_cells():
    found = find_maneuvers("s2", "esterle2019")
    maneuver = found.cheapest(4)[3]
    ways = accepted_edges(found.hard, found.product)
    picture = graph_picture(found.graph, ways, maneuver, judged=True)
    tips = [one.tip for one in picture.marks if isinstance(one, Area) and one.style == "chosen"]
    assert [tip.partition(":")[0] for tip in tips] == [
        f"{p} s, cell {node}" for p, node in enumerate(maneuver.nodes)
    ]
    # Its four steps, and a swatch in the legend.
    assert styles(picture, Polyline)["way"] == 4 + 1
    steps = [one for one in picture.marks if isinstance(one, Polyline) and one.style != "axis"]
    assert len({one.points for one in steps}) == len(steps), "every step is drawn once"


def test_many_cells_lose_their_labels_not_their_marks():
    found, picture = drawn("s2", step_s=0.1)
    assert found.graph.nodes == 7 * 41
    areas = styles(picture, Area)
    assert areas.total() - (areas["violated"] > 0) == 7 * 41
    assert picture.width == 900
