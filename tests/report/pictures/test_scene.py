"""The scene: every cell with its own area, words that can be read."""

from itertools import combinations, pairwise

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rulec import find_maneuvers
from rulec.diagnostics import RulecError
from rulec.partition import navigation_graph
from rulec.report.pictures.drawing.canvas import Area, LabelText, Polyline
from rulec.report.pictures.picture_captions import in_letters
from rulec.report.pictures.scene_picture import scene_legend, scene_pictures
from rulec.scenario import Ego, MissingLane, Road, Scenario, load_scenario
from support.generators.random_scenarios import scenarios

CELLS = ("cell", "crossing", "chosen")


def size(rings):
    """The area inside the first ring and outside the others."""

    def whole(ring):
        closed = pairwise([*ring, ring[0]])
        return abs(sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in closed)) / 2

    return whole(rings[0]) - sum(map(whole, rings[1:]))


def cells_of(picture):
    return [one for one in picture.marks if isinstance(one, Area) and one.style in CELLS]


def words_of(picture):
    return [one for one in picture.marks if isinstance(one, LabelText)]


def apart(one, other):
    a, b = one.bounds, other.bounds
    return a[2] <= b[0] or b[2] <= a[0] or a[3] <= b[1] or b[3] <= a[1]


@given(scenarios(), st.sampled_from(["paper", "fine"]))
def test_every_cell_has_its_size_and_no_words_meet(scenario, partition):
    try:
        graph = navigation_graph(scenario, partition=partition)
    except RulecError:
        assume(False)
    road = scenario.road
    lanes = len(road.lanes) - 1
    scale = (900 - 2 * 14) / (road.s[1] - road.s[0]) * 46 * lanes / (road.lanes[-1] - road.lanes[0])
    for layer, picture in zip(
        graph.layers, scene_pictures(graph, range(len(graph.layers)), None), strict=True
    ):
        drawn = cells_of(picture)
        expected = [
            sum((box.s_max - box.s_min) * (box.d_max - box.d_min) for box in cell.boxes) * scale
            for cell in layer.cells
        ]
        assert [size(area.rings) for area in drawn] == pytest.approx(expected, rel=1e-6, abs=1e-6)
        assert all(apart(*pair) for pair in combinations(words_of(picture), 2))
        told = [one.text for one in words_of(picture)]
        key = [entry for text in told for entry in text.split("   ")]
        for number, cell in enumerate(layer.cells):
            letters = in_letters(cell)
            if letters:
                assert letters in told or f"{number} {letters}".replace(" ", "\xa0") in key


def test_the_labels_of_s2():
    """Behind and in front of o1 in its lane, the crossing between; left of it all of the other."""
    graph = navigation_graph(load_scenario("s2"))
    first = scene_pictures(graph, [0], None)[0]
    labels = [one.text for one in words_of(first) if one.style == "ink"]
    assert sorted(labels) == ["b", "f", "f", "f", "l", "l", "l", "o1"]
    assert sorted(one.style for one in cells_of(first)) == ["cell"] * 5 + ["crossing"] * 2
    assert cells_of(first)[0].tip == "cell 0: carriageway, b(o1)"


def test_words_stand_in_their_cells():
    """Ego's lane is to the right of o1's, and o2's own; the left lane is the other way round."""
    graph = navigation_graph(load_scenario("s1"), partition="fine")
    picture = scene_pictures(graph, [0], None)[0]
    told = {}
    for words in words_of(picture):
        for area in cells_of(picture):
            left, top, right, bottom = _around(area)
            if (
                left <= words.bounds[0]
                and words.bounds[2] <= right
                and top <= words.bounds[1]
                and words.bounds[3] <= bottom
            ):
                told[words.text] = area.tip.partition("carriageway, ")[2]
    assert {text: tip for text, tip in told.items() if text != "ego"} == {
        "br bs": "behind right_of(o1), behind same_lane(o2)",
        "nr bs": "beside right_of(o1), behind same_lane(o2)",
        "fr fs": "in_front_of right_of(o1), in_front_of same_lane(o2)",
        "bs bl": "behind same_lane(o1), behind left_of(o2)",
        "fs nl": "in_front_of same_lane(o1), beside left_of(o2)",
        "fs fl": "in_front_of same_lane(o1), in_front_of left_of(o2)",
    }


def _around(area):
    xs, ys = zip(*area.rings[0], strict=True)
    return min(xs), min(ys), max(xs), max(ys)


def test_a_maneuver_is_shown_by_its_cell_and_its_bounds():
    """Staying behind o1, which starts with its rear at 22.5 m and stands still from 4 s on."""
    found = find_maneuvers("s2", "esterle2019")
    (cheapest,) = found.cheapest(1)
    pictures = scene_pictures(found.graph, range(5), cheapest)
    chosen = [[one.tip for one in cells_of(p) if one.style == "chosen"] for p in pictures]
    assert chosen == [["cell 0: carriageway, b(o1)"]] * 5
    told = [next(one.text for one in words_of(p) if one.anchor == "end") for p in pictures]
    # 25 + 8 t - t^2 is its centre, 2.5 m its half length.
    rears = (22.5, 29.5, 34.5, 37.5, 38.5)
    assert told == [f"cell 0: s -60 … {rear:g} m, d -1.75 … 1.75 m" for rear in rears]
    assert "the maneuver's cell" in [
        one.text for one in words_of(scene_legend(found.graph, None))
    ] + [one.text for one in words_of(scene_legend(found.graph, cheapest))]


def test_obstacles_sweep_ahead_of_where_they_are():
    graph = navigation_graph(load_scenario("s2"))
    picture = scene_pictures(graph, [0], None)[0]
    body, swept = (
        next(_around(one) for one in picture.marks if isinstance(one, Area) and one.style == style)
        for style in ("body", "swept")
    )
    metre = (900 - 2 * 14) / 200
    # In the first second it moves 7 m, its rear from 22.5 m on.
    assert body[0] == pytest.approx(14 + 82.5 * metre)
    assert body[2] - body[0] == pytest.approx(5 * metre)
    assert (swept[0], swept[2] - swept[0]) == pytest.approx((body[0], 12 * metre))


def test_lanes_are_drawn():
    graph = navigation_graph(load_scenario("s3"))
    picture = scene_pictures(graph, [0], None)[0]
    lanes = [one for one in picture.marks if isinstance(one, Polyline) and one.style == "lane"]
    # Six lanes have five lines between them.
    assert len(lanes) == 5


def test_no_line_is_drawn_between_lanes_that_have_ended():
    """Of three lanes the two on the left end at 60 and 80 m, so that from there no line is left."""
    road = Road(
        (0.0, 100.0),
        (0.0, 3.0, 6.0, 9.0),
        missing=(MissingLane(3, (60.0, 100.0)), MissingLane(2, (80.0, 100.0))),
    )
    graph = navigation_graph(Scenario("ending", road, Ego(1.0, 1.0)))
    picture = scene_pictures(graph, [0], None)[0]
    ends: dict[float, float] = {}
    for one in picture.marks:
        if isinstance(one, Polyline) and one.style == "lane":
            (_, y), (x, _) = one.points
            ends[y] = max(ends.get(y, 0.0), x)
    upper, lower = (ends[y] for y in sorted(ends))
    metre = (900 - 2 * 14) / 100
    assert lower == pytest.approx(14 + 100 * metre), "the right lane goes on"
    assert upper == pytest.approx(14 + 80 * metre)
