"""Tables of centre lines become lanelets: borders, what follows, and what is wrong in them."""

import numpy as np
import pytest

from rulec import RulecError, read_map, read_recording
from rulec.recordings.recording_files import is_recording
from support.builders.track_tables import EVERY_COLUMN_OF_LANES, table


def lanes(folder, head, *rows):
    file = folder / "lanes.csv"
    file.write_text(table(head, *rows), encoding="utf-8")
    return read_map(file, 0.1)


def message(folder, head, *rows):
    with pytest.raises(RulecError) as refused:
        lanes(folder, head, *rows)
    (found,) = refused.value.diagnostics
    assert found.code == "R0610"
    return found


def test_a_centre_line_is_enough(tmp_path):
    roads = lanes(tmp_path, "lane,x,y", "a,0,0", "a,50,0", "a,50,50")
    lane = roads.lanelets["a"]
    assert lane.centre.tolist() == [[0, 0], [50, 0], [50, 50]]
    assert lane.left.tolist() == [[0, 1.75], [48.25, 1.75], [48.25, 50]]
    assert lane.right.tolist() == [[0, -1.75], [51.75, -1.75], [51.75, 50]]
    assert (lane.limit_mps, lane.left_mark, lane.stop_line, lane.foes) == (None, None, None, None)
    assert "lanes are taken to be 3.5 m wide" in roads.remarks


def test_a_width_between_two_others_is_by_the_distance(tmp_path):
    rows = ("a,0,0,3", "a,10,0,", "a,100,0,5", "a,100,0,9", "a,104,3,")
    lane = lanes(tmp_path, "lane,x,y,width", *rows).lanelets["a"]
    assert np.hypot(*(lane.left - lane.right).T)[:2] == pytest.approx([3, 3.2])


def test_a_limit_may_be_in_any_row_and_again_in_others(tmp_path):
    rows = ("a,0,0,", "a,9,0,36", "a,19,0,36")
    assert lanes(tmp_path, "lane,x,y,limit_kmh", *rows).lanelets["a"].limit_mps == 10


def test_all_that_can_be_said(tmp_path):
    file = tmp_path / "lanes.csv"
    file.write_text(EVERY_COLUMN_OF_LANES)
    roads = read_map(file, 0.1)
    a, b, d = (roads.lanelets[name] for name in "abd")
    assert np.hypot(*(a.left - a.right).T) == pytest.approx([3, 5])
    assert (a.limit_mps, a.left_mark, a.right_mark) == (pytest.approx(50 / 3.6), "broken", "solid")
    assert (a.types, a.signs) == ({"urban", "busLane"}, {"STOP"})
    assert (a.successors, b.predecessors, a.left_of, d.right_of) == (("b", "c"), ("a",), "d", "a")
    assert a.stop_line.tolist() == [[50, 2.5], [50, -2.5]]
    assert (b.types, b.junction, b.foes, b.first) == ({"intersection"}, "j", {"c"}, {"c"})
    assert roads.side == "left"


def test_a_junction_none_of_whose_ways_names_any_other_is_not_known_to_have_no_conflicts(tmp_path):
    rows = ("a,0,0,i,,", "a,9,0,i,,", "b,0,5,i,,", "b,9,5,i,,", "c,20,0,j,d,", "c,29,0,j,d,")
    more = ("d,20,5,j,c,c", "d,29,5,j,c,c", "e,20,9,j,,", "e,29,9,j,,")
    roads = lanes(tmp_path, "lane,x,y,junction,foes,first", *rows, *more)
    told = {name: (lane.foes, lane.first) for name, lane in roads.lanelets.items()}
    assert told == {
        "a": (None, None),
        "b": (None, None),
        "c": ({"d"}, frozenset()),
        "d": ({"c"}, {"c"}),
        "e": (frozenset(), frozenset()),
    }


def test_lanes_whose_ends_meet_follow_each_other(tmp_path):
    """``c`` begins at the end of ``a``, but leads back."""
    points = ("a,0,0", "a,50,0", "b,50.2,0", "b,90,5", "c,50,0.2", "c,0,3")
    roads = lanes(tmp_path, "lane,x,y", *points)
    assert roads.lanelets["a"].successors == ("b",)
    assert roads.lanelets["b"].predecessors == ("a",)
    assert "lanes whose ends meet are assumed to be connected" in roads.remarks


@pytest.mark.parametrize(
    ("head", "rows", "line", "said"),
    [
        ("lane,x,y", ["a,0,0"], 2, "lane `a` has one place only"),
        ("lane,x,y", ["a,0,0", "a,30000,0"], 2, "lane `a` is 30,000 m long"),
        ("lane,x,y,width", ["a,0,0,-1", "a,9,0,3"], 2, "its `width` is -1"),
        ("lane,x,y,type", ["a,0,0,urbn", "a,9,0,"], 2, "is of type `urbn`"),
        ("lane,x,y,left_mark", ["a,0,0,", "a,9,0,dashed"], 3, "its `left_mark` is `dashed`"),
        ("lane,x,y,type", ["a,0,0,urban", "a,9,0,rural"], 3, "its `type` is another"),
        ("lane,x,y,limit_kmh", ["a,0,0,50", "a,9,0,70"], 3, "its `limit_kmh` is another"),
        ("lane,x,y,successors", ["a,0,0,b", "a,9,0,"], 2, "has `b`, which is no lane"),
    ],
)
def test_what_is_wrong_has_its_row(tmp_path, head, rows, line, said):
    found = message(tmp_path, head, *rows)
    assert found.place.line == line
    assert said in found.message


def test_ways_out(tmp_path):
    assert (
        message(tmp_path, "lane,x,y,type", "a,0,0,urbn", "a,9,0,").help == "did you mean `urban`?"
    )
    two = message(tmp_path, "lane,x,y,limit_kmh", "a,0,0,50", "a,5,0,", "a,9,0,70")
    assert two.message.endswith("than in the rows above of lane `a`: `50` and `70`")
    assert two.help == "where something changes, begin another lane"


def test_numbers_out_of_range_are_said_as_given(tmp_path):
    found = message(tmp_path, "lane,x,y,Limit_kmh", "a,0,0,5000", "a,9,0,")
    assert found.message.endswith("its `Limit_kmh` is 5000")
    # 200 m/s
    assert found.expected == "expected a number between 0 and 720"
    wide = message(tmp_path, "lane,x,y,width", "a,0,0,350", "a,9,0,350")
    assert (wide.message[-18:], wide.help) == ("its `width` is 350", "widths are in metres")


def test_a_map_is_no_recording(tmp_path):
    """It is not read as traces, either, which have other columns."""
    file = tmp_path / "lanes.csv"
    file.write_text(table("lane,x,y", "a,0,0", "a,9,0"), encoding="utf-8")
    assert is_recording(str(file))
    with pytest.raises(RulecError, match="it is a map \\(lanes as a table\\)"):
        read_recording(file)
