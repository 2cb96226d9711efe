"""Tracks on maps that are not theirs: of another place, or in another frame."""

import json
import re

import numpy as np
import pytest

import rulec
from rulec import RulecError, build_lanelet, read_recording
from rulec.recordings.doubts.long_ways import long_ways
from rulec.recordings.doubts.road_doubts import road_doubts
from rulec.recordings.format_table import FORMATS
from rulec.recordings.recording_files import read_recordings
from rulec.recordings.recording_format import RecordingSource
from rulec.recordings.track import Track
from support.builders import argoverse_files as argoverse
from support.builders.track_tables import HEAD, driving, table, written
from support.mutations.format_samples import RECORDINGS

FAR_LANES = "lane,x,y\nr,100000,0\nr,100200,0\n"


def far_lanes(folder):
    file = folder / "far.csv"
    file.write_text(FAR_LANES)
    return file


def far_archive(folder):
    """The town where x is 100 km more."""
    (folder / "far").mkdir()
    town = json.dumps(argoverse.town())
    file = folder / "far" / "log_map_archive_far.json"
    file.write_text(re.sub(r'"x": (-?[\d.]+)', lambda x: f'"x": {1e5 + float(x[1])}', town))
    return file


FAR = {
    **dict.fromkeys(("argoverse-motion", "argoverse-sensor"), far_archive),
    **dict.fromkeys(("levelx", "interaction", "ngsim", "omega-prime", "tracks", "osi"), far_lanes),
}


def test_every_format_that_takes_a_map_is_asked():
    """SUMO's data name the lanes that they are on, which no other net has."""
    assert {form.name for form in FORMATS if form.takes_map} == FAR.keys() | {"sumo"}


@pytest.mark.parametrize("name", FAR)
def test_a_map_of_another_place_is_refused(tmp_path, name):
    sample = next(RECORDINGS[name]())
    for file, packed in sample.packed().items():
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_bytes(packed.whole())
    entry = tmp_path / sample.entry
    with pytest.raises(RulecError) as refused:
        list(read_recordings(RecordingSource(entry, FAR[name](tmp_path))))
    (found,) = refused.value.diagnostics
    assert (found.code, found.place.file) == ("R0615", str(entry))
    assert found.message.startswith("nobody is near the roads: tracks are at x ")
    assert "the map at x 100000.0" in found.message
    own = tmp_path / sample.roads if sample.roads else None
    assert list(read_recordings(RecordingSource(entry, own)))


def test_columns_of_a_program_on_another_map():
    steps = range(9)
    tracks = {"track": ["a"] * 9, "t": steps, "x": steps, "y": [0] * 9}
    far = {"lane": ["r", "r"], "x": [100000, 100200], "y": [0, 0]}
    with pytest.raises(RulecError, match="nobody is near the roads"):
        rulec.recording_from_columns(tracks, far)


def cars_on_a_road(y):
    """Three cars that drive 40 m, and the road along the x axis on which they are at y = 0."""
    steps = [step for _ in "abc" for step in range(9)]
    tracks = {
        "track": [name for name in "abc" for _ in range(9)],
        "t": steps,
        "x": [5.0 * step for step in steps],
        "y": [y] * 27,
    }
    return tracks, {"lane": ["r", "r"], "x": [-50, 200], "y": [0, 0]}


def test_columns_of_a_program_have_their_doubts():
    assert not any(
        "on lanes" in one for one in rulec.recording_from_columns(*cars_on_a_road(0)).remarks
    )
    aside = rulec.recording_from_columns(*cars_on_a_road(20.0))
    assert any("only 0% of the places" in one for one in aside.remarks)


ROADS = "lane,x,y\n" + "".join(
    f"{name},{x},{y}\n"
    for name, ends in {
        "east": ((0, 0), (200, 0)),
        "west": ((200, 4), (0, 4)),
        "north": ((150, -90), (150, 90)),
    }.items()
    for x, y in ends
)
"""A street with a lane each way, and one that crosses it."""


def tracks(axes=lambda x, y: (x, y), cars=3, aside=0.0):
    """Rows of so many cars on each lane, by ``axes``, all at 10 m/s."""
    starts = {"e": ((0, 0), (10, 0)), "w": ((200, 4), (-10, 0)), "n": ((150, -90), (0, 10))}
    return [
        f"{name}{number},{k / 10:.1f},{x:.2f},{y:.2f}"
        for name, ((x0, y0), (vx, vy)) in starts.items()
        for number in range(cars)
        for k in range(30)
        for ahead in [k / 10 + number]
        for x, y in [axes(x0 + vx * ahead + aside, y0 + vy * ahead + aside)]
    ]


def remarks(tmp_path, rows):
    usual = ("all tracks are taken to be", "what is not stated is taken to be", "lanes are taken")
    said = read_recording(written(tmp_path, table(HEAD, *rows), ROADS)).remarks
    return [remark for remark in said if not remark.startswith(usual)]


def test_tracks_on_their_roads(tmp_path):
    assert remarks(tmp_path, tracks()) == []
    # Measured half a metre off they are on their lanes still
    assert remarks(tmp_path, tracks(aside=0.5)) == []


@pytest.mark.parametrize(
    ("axes", "said"),
    [
        (lambda x, y: (y, x), "x and y seem to be exchanged: then 100% of"),
        (lambda x, y: (x, -y), "y seems to point down, and wants another sign: then 100% of"),
        (lambda x, y: (x + 20, y + 20), "only 0% of the places of vehicles that move are on lanes"),
    ],
)
def test_other_axes(tmp_path, axes, said):
    (remark,) = remarks(tmp_path, tracks(axes))
    assert remark.startswith(said)


def test_two_lanes_that_are_exchanged_by_the_sign_of_y(tmp_path):
    """Everybody is on a lane, and drives against it: the two lanes lie about y = 0."""
    lanes = "lane,x,y\ne,0,-2\ne,200,-2\nw,200,2\nw,0,2\n"
    rows = [
        row
        for k in range(3)
        for row in (
            *driving(f"e{k}", start=10.0 * k, y=2),
            *driving(f"w{k}", speed=-10.0, start=90 - 10.0 * k, y=-2),
        )
    ]
    found = read_recording(written(tmp_path, table(HEAD, *rows), lanes)).remarks
    assert any("y seems to point down, and wants another sign: then 100%" in x for x in found)


def test_of_a_few_who_are_elsewhere_no_axes_are_concluded(tmp_path):
    """One car that moves on a parking lot has the right axes; that it is on no lane is said."""
    (remark,) = remarks(tmp_path, driving("a", y=20.0))
    assert remark.startswith("only 0% of the places")
    # Most are on the road, and some leave it: nothing is said of these
    assert remarks(tmp_path, [*tracks(), *driving("a", y=20.0)]) == []


def exchanged(rows):
    """Rows with the first two cells exchanged."""
    cells = [row.split(",") for row in rows]
    return [",".join((when, who, *more)) for who, when, *more in cells]


@pytest.mark.parametrize("ids", [("1", "2"), ("17", "402")])
def test_track_and_time_exchanged(tmp_path, ids):
    rows = [*driving(ids[0]), *driving(ids[1], y=3.5)]
    assert remarks(tmp_path, rows) == []
    with pytest.raises(RulecError) as refused:
        remarks(tmp_path, exchanged(rows))
    (found,) = refused.value.diagnostics
    assert "its tracks are called `0.0000` to `1.0000`" in found.message
    assert found.message.endswith("`track` and `t` seem to be exchanged")
    assert found.help == "exchange the names of these two columns"


def test_numbers_of_tracks_that_are_no_times(tmp_path):
    """Whole seconds, and ids that a spreadsheet gave a decimal, or that are versions."""
    for names in ([f"{k}.0" for k in range(1, 7)], ["1.1", "1.2", "2.1", "4.7", "9.9"]):
        rows = [row for name in names for row in driving(name, step_s=1.0, speed=3.0)]
        assert remarks(tmp_path, rows) == []


def test_no_lane_in_the_map(tmp_path):
    with pytest.raises(RulecError, match="R06"):
        read_recording(written(tmp_path, table(HEAD, *driving()), "lane,x,y\n"))


@pytest.mark.parametrize(("gap", "said"), [(0.0, None), (0.9, None), (-0.9, None), (2.5, "2.5 m")])
def test_lanes_that_do_not_begin_where_those_before_end(gap, said):
    """A lane that splits in two begins beside the middle of the one before: no gap."""
    lanes = [
        build_lanelet("a", [(0, 0), (100, 0)], successors=["b", "c"]),
        build_lanelet("b", [(100 + gap, 0), (200, 0)], predecessors=["a"]),
        build_lanelet("c", [(100, -1.7), (200, -3)], predecessors=["a"]),
    ]
    rows = np.array([[10.0 * k, 0.0, 0.0, 10.0, 0.0] for k in range(10)])
    track = Track(np.arange(10), rows, 4.5, 1.8)
    found = list(road_doubts({lane.id: lane for lane in lanes}, [long_ways(track)]))
    assert [remark for remark in found if "at 1 of 2 places" in remark and said] == found
    assert all(f"`b` {said} from that of `a`" in remark for remark in found)
    assert len(found) == (said is not None)


def test_lanes_that_are_drawn_backwards(tmp_path):
    """A road of one lane: whatever the axes are, it leads where nobody drives."""
    lanes = "lane,x,y\na,200,-2\na,0,-2\n"
    rows = [row for k in range(3) for row in driving(f"e{k}", start=10.0 * k, y=-2)]
    found = read_recording(written(tmp_path, table(HEAD, *rows), lanes)).remarks
    assert any("100% of the places" in x and "drawn backwards" in x for x in found)
