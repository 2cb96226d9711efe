"""Tracks with columns of one's own become recordings: names, units, sizes, times, ego."""

import gzip
from math import pi

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet

from rulec import RulecError, read_recording
from rulec.recordings.encodings.table_files import LARGEST_NUMBER
from rulec.recordings.recording_files import is_recording
from support.builders.track_tables import HEAD, LANES, driving, table, written


def read(folder, head, *rows, lanes=LANES):
    return read_recording(written(folder, table(head, *rows), lanes))


def only(recording):
    (one,) = recording.participants
    return one


def message(folder, head, *rows, lanes=LANES):
    with pytest.raises(RulecError) as refused:
        read(folder, head, *rows, lanes=lanes)
    (found,) = refused.value.diagnostics
    return found


def test_four_columns_are_enough(tmp_path):
    """A car at 10 m/s along x: its heading and speed follow from its places, its size is usual."""
    recording = read(tmp_path, HEAD, *driving())
    car = only(recording)
    assert (recording.step_s, list(car.states)) == (0.1, list(range(11)))
    state = car.states[5]
    assert (state.x, state.y, state.heading) == pytest.approx((25.0, 0.0, 0.0))
    assert (state.speed, state.acceleration) == pytest.approx((10.0, 0.0), abs=1e-6)
    assert np.ptp(car.outlines[5], axis=0) == pytest.approx((4.5, 1.8))
    said = " ".join(recording.remarks)
    assert "type `car`" in said
    assert "length of a car 4.5 m" in said
    assert "neighbours" in said


@pytest.mark.parametrize(
    ("column", "value", "heading"),
    [("heading", pi / 6, pi / 6), ("heading_deg", 30, pi / 6), ("yaw", -0.5, -0.5)],
)
def test_angles(tmp_path, column, value, heading):
    car = only(read(tmp_path, f"{HEAD},{column}", *driving(steps=3, more=f",{value}")))
    assert car.states[1].heading == pytest.approx(heading)


@pytest.mark.parametrize(
    ("column", "value", "speed"),
    [("speed", 9, 9), ("speed_kmh", 36, 10), ("speed_mph", 10, 4.4704)],
)
def test_speeds(tmp_path, column, value, speed):
    car = only(read(tmp_path, f"{HEAD},{column}", *driving(steps=3, more=f",{value}")))
    assert car.states[1].speed == pytest.approx(speed)


def test_velocities_are_speeds_along_the_heading(tmp_path):
    """It slides 3 m/s to the side at 4 m/s ahead: its speed is 4 m/s."""
    car = only(read(tmp_path, f"{HEAD},heading,vx,vy", *driving(steps=3, more=",0,4,3")))
    assert car.states[1].speed == pytest.approx(4.0)


def test_backing_up(tmp_path):
    """Its front shows along x, its places go back by 2 m/s: a speed without a sign gets one."""
    rows = driving(speed=-2.0, more=",0,2")
    assert only(read(tmp_path, f"{HEAD},heading,speed", *rows)).states[4].speed == -2.0


def test_places_of_the_front(tmp_path):
    car = only(read(tmp_path, "track,t,front_x,front_y,length", *driving(more=",6")))
    assert car.states[0].x == pytest.approx(17.0)


def test_who_stands_is_turned_as_the_lane(tmp_path):
    """It flickers by 0.2 m; the only lane leads up."""
    rows = [f"a,{k / 10},5,{20 + 0.1 * (k % 3)}" for k in range(9)]
    lanes = table("lane,x,y", "u,5,0", "u,5,90")
    recording = read(tmp_path, HEAD, *rows, lanes=lanes)
    assert only(recording).states[3].heading == pytest.approx(pi / 2)
    assert "that does not move" in " ".join(recording.remarks)


@pytest.mark.parametrize(
    ("word", "kind"),
    [("Car", "car"), ("truck_bus", "truck"), ("motorbike", "motorcycle"), ("Cyclist", "bicycle"),
     ("person", "pedestrian"), ("Emergency Vehicle", "priorityVehicle"), ("other", "unknown"),
     ("parkedVehicle", "parkedVehicle")],
)  # fmt: skip
def test_types(tmp_path, word, kind):
    assert only(read(tmp_path, f"{HEAD},type", *driving(more=f",{word}"))).type == kind


def test_the_type_that_most_rows_state_counts(tmp_path):
    kinds = ["car", "", "truck", "truck", "", "", "", "car", "truck"]
    rows = [f"a,{k / 10},{20 + k},0,{kind}" for k, kind in enumerate(kinds)]
    (body,) = read_recording(written(tmp_path, table("track,t,x,y,type", *rows))).participants
    assert body.type == "truck"


def test_a_size_of_nothing_is_the_usual_one(tmp_path):
    rows = driving(more=",pedestrian,0,")
    person = only(read(tmp_path, f"{HEAD},type,length,width", *rows))
    assert np.ptp(person.outlines[0], axis=0) == pytest.approx((0.5, 0.5))


def test_lamps_ego_and_who_stands(tmp_path):
    """Where a lamp's cell is empty nothing is known of it."""
    head = f"{HEAD},brake_light,left_indicator,ego,standing"
    rows = ["a,0,20,0,1,0,1,", "a,0.1,21,0,1,1,1,", "a,0.2,22,0,,1,1,", "p,0,50,-2,,,0,1",
            "p,0.1,50,-2,,,0,1"]  # fmt: skip
    recording = read(tmp_path, head, *rows)
    car, parked = recording.participants
    assert car.lamps == {
        0: frozenset({"brake_light"}),
        1: frozenset({"brake_light", "left_indicator"}),
    }
    assert car.shows == {"brake_light", "left_indicator"}
    assert (recording.ego, parked.standing, list(parked.states)) == ("a", True, [0])


def test_a_lamp_that_no_row_of_a_track_tells_leaves_its_others_known(tmp_path):
    """What is not told of one track is of another, and is never off."""
    head = f"{HEAD},brake_light,left_indicator,horn"
    rows = ["a,0,20,0,1,0,", "a,0.1,21,0,1,1,", "b,0,40,0,1,,", "b,0.1,41,0,0,,"]
    rows += ["c,0,60,0,,,", "c,0.1,61,0,,,", "d,0,80,0,,1,", "d,0.1,81,0,0,1,"]
    a, b, c, d = read(tmp_path, head, *rows).participants
    assert a.shows == {"brake_light", "left_indicator"}
    assert (b.shows, b.lamps) == ({"brake_light"}, {0: {"brake_light"}, 1: frozenset()})
    assert (c.shows, c.lamps) == (frozenset(), {})
    assert (d.shows, d.lamps) == ({"brake_light", "left_indicator"}, {1: {"left_indicator"}})


@pytest.mark.parametrize(
    ("times", "step_s", "steps"),
    [
        ((0, 0.1, 0.2, 0.3), 0.1, [0, 1, 2, 3]),
        ((12.0, 12.04, 12.08), 0.04, [300, 301, 302]),
        ((0, 0.033, 0.067, 0.1, 0.133), 1 / 30, [0, 1, 2, 3, 4]),
        ((0, 0.03, 0.07, 0.10, 0.13, 0.17, 0.20), 1 / 30, [0, 1, 2, 3, 4, 5, 6]),
        ((0.0, 0.2, 0.4), 0.2, [0, 1, 2]),
        ((5, 6, 7), 1.0, [5, 6, 7]),
    ],
)
def test_steps(tmp_path, times, step_s, steps):
    rows = [f"a,{t},{20 + 10 * t},0" for t in times]
    recording = read(tmp_path, HEAD, *rows)
    assert recording.step_s == pytest.approx(step_s, rel=1e-12)
    assert list(only(recording).states) == steps


@pytest.mark.parametrize("off_s", [0.001, 0.0045])
def test_clocks_may_jitter_row_by_row_or_from_track_to_track(tmp_path, off_s):
    """By up to 2 % of a step, half a second, from the first one; each row by itself."""
    chance = np.random.default_rng(3)
    rows = [
        f"{track},{0.5 * k + chance.uniform(-off_s, off_s):.6f},{5 * k},{y}"
        for track, y in (("a", 0), ("b", 3.5))
        for k in range(12)
    ]
    found = read(tmp_path, HEAD, *rows)
    assert found.step_s == 0.5
    assert [list(body.states) for body in found.participants] == [list(range(12))] * 2
    later = [
        f"{track},{0.5 * k + late:.3f},{5 * k},{y}"
        for track, y, late in (("a", 0, 0), ("b", 3.5, off_s))
        for k in range(12)
    ]
    again = read(tmp_path, HEAD, *later)
    assert [list(body.states) for body in again.participants] == [list(range(12))] * 2


def test_who_is_seen_less_often_than_others_makes_no_moments_one(tmp_path):
    """Nine in ten rows are of tracks every 0.5 s; one is seen every 0.1 s."""
    often = [f"a,{0.1 * k:.1f},{k},0" for k in range(31)]
    told = message(
        tmp_path, HEAD, *often, *(f"{n},{0.5 * k},{5 * k},3.5" for n in "bcdefg" for k in range(7))
    )
    assert "has a row every 0.5 s, while times of the table are 0.1 s apart" in told.message


def test_the_rate_of_video(tmp_path):
    """A minute at 30,000 frames in 1001 s, written with milliseconds, is not 30 a second."""
    times = [round(k * 1001 / 30000, 3) for k in range(1800)]
    recording = read(tmp_path, HEAD, *[f"a,{t},{20 + t / 10},0" for t in times])
    assert recording.step_s == pytest.approx(1001 / 30000, rel=1e-12)
    assert len(only(recording).states) == 1800


def test_a_unit_of_time(tmp_path):
    rows = [f"a,{k * 100_000_000},{20 + k},0" for k in range(3)]
    assert read(tmp_path, "track,t_ns,x,y", *rows).step_s == 0.1


def test_times_since_1970_count_from_the_first(tmp_path):
    rows = [f"a,{1_700_000_000 + k / 10:.1f},{20 + k},0" for k in range(3)]
    recording = read(tmp_path, HEAD, *rows)
    assert (recording.step_s, list(only(recording).states)) == (0.1, [0, 1, 2])
    assert "times count from the first one, 1700000000 s" in recording.remarks


def test_who_comes_back_after_a_second_is_another_one(tmp_path):
    rows = [f"7,{t / 10},{20 + t},0" for t in (0, 1, 2, 13, 14, 15)]
    recording = read(tmp_path, HEAD, *rows)
    first, second = recording.participants
    assert (first.id, list(first.states), first.resumes) == ("7", [0, 1, 2], None)
    assert (second.id, list(second.states), second.resumes) == ("7_2", [13, 14, 15], 2)
    (remark,) = (remark for remark in recording.remarks if "cut" in remark)
    assert remark == (
        "1 track is cut at holes of more than 1 s, in which nothing is judged, and what follows is "
        "another road user: `7`"
    )


def test_who_comes_back_soon_is_the_same(tmp_path):
    rows = [f"7,{t / 10},{20 + t},0" for t in (0, 1, 2, 12, 13)]
    recording = read(tmp_path, HEAD, *rows)
    body = only(recording)
    assert list(body.states) == [0, 1, 2, 12, 13]
    assert [body.states[step].speed for step in body.states] == pytest.approx([10] * 5)
    assert not any("cut" in remark for remark in recording.remarks)


def test_rows_in_any_order(tmp_path):
    rows = driving("a") + driving("b", y=3.5)
    sorted_, mixed = read(tmp_path, HEAD, *rows), read(tmp_path, HEAD, *rows[::-1])
    assert [one.id for one in mixed.participants] == ["a", "b"]
    for one, other in zip(sorted_.participants, mixed.participants, strict=True):
        assert dict(one.states) == dict(other.states)


@pytest.mark.parametrize("mark", [";", "\t"])
def test_other_separators(tmp_path, mark):
    text = table(HEAD, *driving()).replace(",", mark)
    assert only(read_recording(written(tmp_path, text))).states[0].x == 20.0


def test_packed_and_from_elsewhere(tmp_path):
    text = "\ufeff" + table('"Track",T,X,Y', *driving()).replace("\n", "\r\n") + "\r\n\r\n"
    file = written(tmp_path, text)
    packed = tmp_path / "cars.csv.gz"
    packed.write_bytes(gzip.compress(file.read_bytes()))
    assert dict(only(read_recording(file)).states) == dict(only(read_recording(packed)).states)
    assert is_recording(str(packed))


def test_parquet_says_the_same(tmp_path):
    text = written(tmp_path, table(HEAD, *driving("7"), *driving("8", y=3.5)))
    cells = [row.split(",") for row in (*driving("7"), *driving("8", y=3.5))]
    columns = {"track": [int(row[0]) for row in cells]}
    columns |= {
        name: [float(row[at]) for row in cells] for at, name in ((1, "t"), (2, "x"), (3, "y"))
    }
    file = tmp_path / "cars.parquet"
    parquet.write_table(pa.table(columns), file)
    assert is_recording(str(file))
    for one, other in zip(
        read_recording(text).participants, read_recording(file).participants, strict=True
    ):
        assert (one.id, dict(one.states)) == (other.id, dict(other.states))


def test_a_file_of_traces_is_none(tmp_path):
    file = tmp_path / "traces.csv"
    file.write_text("trace,step,object,type,other,position,x,y,t\n")
    assert not is_recording(str(file))


@pytest.mark.parametrize(
    ("head", "row", "line", "said"),
    [
        ("trak,t,x,y", "a,0,20,0", None, "it has no column `track`, but `trak`"),
        ("track,t,x,speed", "a,0,20,0", None, "it has no column `y`"),
        ("track,t,x,y [m]", "a,0,20,0", None, "it has no column `y`, but `y [m]`"),
        (HEAD, "a,0.3,2O,0", 5, "column `x` holds `2O`"),
        (HEAD, "a,0.3,inf,0", 5, "column `x` holds `inf`"),
        (HEAD, "a,0.3,,0", 5, "column `x` is empty here"),
        (HEAD, ",0.3,20,0", 5, "column `track` is empty here"),
        (HEAD, "a,0.3,nan,0", 5, "or says that it is none, as `nan` does"),
        (HEAD, "a,0.3,20", 5, "cut short: its last row has 3 cells, its head 4 names"),
        (HEAD, "a,0.2,20,0", 5, "track `a` is twice at 0.2 s"),
        (HEAD, "a,0.3,1e12,0", 5, "its `x` is 1e+12"),
        (HEAD, "a,0.345,20,0", 5, "its times are uneven: 0.345 s"),
        (HEAD, "a,3000000,20,0", None, "spread over 3,000,000 s"),
        (f"{HEAD},type", "a,0.3,20,0,spaceship", 5, "nobody is of type `spaceship`"),
        (
            f"{HEAD},heading",
            "a,0.3,20,0,271",
            5,
            "its heading is 271, which is no angle in radians",
        ),
        (f"{HEAD},ego", "a,0.3,20,0,2", 5, "its `ego` is 2"),
        (f"{HEAD},length", "a,0.3,20,0,-4", 5, "its `length` is -4"),
        (f"{HEAD},heading,heading_deg", "a,0.3,20,0,1,1", None, "are both `heading`"),
        (f"{HEAD},vx", "a,0.3,20,0,1", None, "a column `vx`, but none `vy`"),
    ],
)
def test_what_is_wrong_has_its_row_and_column(tmp_path, head, row, line, said):
    rest = "," * (row.count(",") - 3)
    before = [f"{one}{rest}" if head.startswith(HEAD) else row for one in driving(steps=3)]
    found = message(tmp_path, head, *before, row)
    assert (found.code, found.place.line) == ("R0610", line)
    assert said in found.message


def test_ways_out(tmp_path):
    misspelt = message(tmp_path, "trak,t,x,y", "a,0,20,0")
    assert misspelt.help == "if `trak` is meant, rename it to `track`"
    degrees = message(tmp_path, f"{HEAD},heading", *driving(more=",90"))
    assert "heading_deg" in degrees.help
    wrong = message(tmp_path, f"{HEAD},type", *driving(more=",pedestrain"))
    assert wrong.help == "did you mean `pedestrian`?"


def test_a_short_row_in_the_middle_is_no_end(tmp_path):
    found = message(tmp_path, HEAD, "a,0,20,0", "a,0.1", "a,0.2,22,0")
    assert "its row has 2 cells" in found.message
    assert "cut short" not in found.message


def milliseconds(column, step=100, speed=14.0):
    """Rows of somebody with times in milliseconds."""
    rows = [f"a,{k * step},{20 + speed * k * step / 1000},0" for k in range(9)]
    return f"track,{column},x,y", *rows


def test_milliseconds_are_no_seconds(tmp_path):
    # 1.4 m in what would be 100 s
    found = message(tmp_path, *milliseconds("time"))
    assert found.code == "R0610"
    assert "100 s apart, in which nobody moves faster than 0.014 m/s" in found.message
    assert found.help == "call the column `t_ms`; or `t_s`, if these are seconds"
    assert (
        "`t` seems to hold microseconds"
        in message(tmp_path, *milliseconds("t", step=10_000, speed=0.14)).message
    )
    assert read(tmp_path, *milliseconds("t_ms")).step_s == 0.1
    assert read(tmp_path, *milliseconds("time_s")).step_s == 100


def test_tracks_that_are_seen_seldom_are_read(tmp_path):
    # By satellite: 14 m/s, every 30 s
    rows = [f"a,{30 * k},{20 + 14 * 30 * k},0" for k in range(9)]
    assert read(tmp_path, "track,time,x,y", *rows).step_s == 30


@pytest.mark.parametrize(
    ("stated", "said"),
    [
        (
            36.0,
            "speeds are 3.6 times what places and times say, by which it is judged: call",
        ),
        (36.0, "call the column `speed_kmh` if it holds km/h"),
        (22.4, "call the column `speed_mph`"),
        (1.0, "speeds are 0.1 times what places and times say, by which it is judged: look at the"),
        (10.5, ""),
    ],
)
def test_speeds_that_places_contradict(tmp_path, stated, said):
    recording = read(tmp_path, f"{HEAD},speed", *driving(steps=40, more=f",{stated}"))
    found = [remark for remark in recording.remarks if remark.startswith("speeds are ")]
    assert (len(found), said in "".join(found)) == (bool(said), True)


def test_a_file_that_is_not_what_it_is_called(tmp_path):
    (tmp_path / "lanes.csv").write_text(LANES)
    file = tmp_path / "cars.parquet"
    file.write_text(table(HEAD, *driving()))
    with pytest.raises(RulecError, match="it is not Parquet but text") as refused:
        read_recording(file)
    assert refused.value.diagnostics[0].help == "if it is CSV, call it `.csv`"
    with pytest.raises(RulecError, match="no such file") as refused:
        read_recording(tmp_path / "nothing.csv")
    assert refused.value.diagnostics[0].code == "R0701"


def test_a_table_that_is_not_called_what_it_is(tmp_path):
    """Parquet is read whatever its name; of other containers the way out is said."""
    as_csv = written(tmp_path, table(HEAD, *driving()))
    columns = {name: [float(k) for k in range(3)] for name in ("t", "x", "y")}
    parquet.write_table(pa.table({"track": ["a"] * 3, **columns}), as_csv)
    assert is_recording(str(as_csv))
    assert list(only(read_recording(as_csv)).states) == [0, 1, 2]
    as_csv.write_bytes(b"PK\x03\x04\xff" + as_csv.read_bytes())
    with pytest.raises(RulecError, match="it is a ZIP archive") as refused:
        read_recording(as_csv, form="tracks")
    assert "save its sheet as CSV" in refused.value.diagnostics[0].help


def test_truths_as_pandas_writes_them(tmp_path):
    rows = [*driving(steps=3, more=",True"), "a,0.3,23,0,False", "a,0.4,24,0,"]
    car = only(read(tmp_path, f"{HEAD},horn", *rows))
    assert {step: set(lit) for step, lit in car.lamps.items()} == {
        0: {"horn"},
        1: {"horn"},
        2: {"horn"},
        3: set(),
    }
    mixed = message(tmp_path, f"{HEAD},horn", *driving(steps=3, more=",True"), "a,0.3,23,0,1")
    assert mixed.help.endswith("or `true` and `false` in all of the column")


def test_ids_that_a_gap_made_decimals(tmp_path):
    recording = read(tmp_path, HEAD, *driving("7.0"), *driving("8.0", y=3.5))
    assert [one.id for one in recording.participants] == ["7", "8"]
    recording = read(tmp_path, HEAD, *driving("7.0"), *driving("7", y=3.5))
    assert [one.id for one in recording.participants] == ["7", "7.0"]


def test_a_track_of_several_types_is_of_its_most_frequent_one(tmp_path):
    types = ["", "car", "truck", "truck", "lorry"]
    rows = [f"a,{k / 10},{20 + k},0,{kind}" for k, kind in enumerate(types)]
    recording = read(tmp_path, f"{HEAD},type", *rows, *driving("b", y=3.5, more=","))
    assert [one.type for one in recording.participants] == ["truck", "car"]
    (said,) = (one for one in recording.remarks if "of several types" in one)
    assert said.endswith("the most frequent one: `a` (truck, car)")


@pytest.mark.parametrize(
    ("lanes", "why"),
    [
        (b"\xff\xfe" + LANES.encode("utf-16-le"), "it is text in UTF-16"),
        (LANES.replace("lane,x,y", "lane,x,x").encode(), "it has two columns `x`"),
        (LANES.replace("lane,x,y", "lane,lon,lat").encode(), "it has no column `x`"),
        (b"", "it is empty"),
    ],
)
def test_a_table_beside_that_is_no_map_is_taken_for_one_of_lanes(tmp_path, lanes, why):
    cars = written(tmp_path, table(HEAD, *driving()))
    (tmp_path / "lanes.csv").write_bytes(lanes)
    with pytest.raises(RulecError, match="lanes as a table: ") as refused:
        read_recording(cars)
    assert why in refused.value.diagnostics[0].message
    assert refused.value.diagnostics[0].help


def test_tracks_are_no_map(tmp_path):
    cars = written(tmp_path, table(HEAD, *driving()))
    with pytest.raises(RulecError, match="it has tracks, and no lanes") as refused:
        read_recording(cars, cars)
    assert "its map with `map_path`" in refused.value.diagnostics[0].help


def test_lanes_beside_in_parquet(tmp_path):
    cars = written(tmp_path, table(HEAD, *driving()), lanes="")
    lanes = pa.table({"lane": ["r", "r"], "x": [0.0, 200.0], "y": [0.0, 0.0]})
    parquet.write_table(lanes, tmp_path / "lanes.parquet")
    assert [*read_recording(cars).lanelets] == ["r"]


def test_headings_of_a_compass(tmp_path):
    """90° is east on a compass: in radians all of those who drive east are turned by 90°."""
    found = message(tmp_path, f"{HEAD},heading_deg", *driving(steps=40, more=",90"))
    assert "headings do not fit the motion" in found.message
    assert "90° in the median" in found.message


def test_all_back(tmp_path):
    """Headings against the motion are those of who backs, where speeds are below 0."""
    backing = driving(steps=40, more=",180,-10")
    (car,) = read(tmp_path, f"{HEAD},heading_deg,speed", *backing).participants
    assert abs(car.states[3].heading) == pytest.approx(pi)
    assert car.states[3].speed == -10.0
    found = message(tmp_path, f"{HEAD},heading_deg,speed", *driving(steps=40, more=",180,10"))
    assert "180° in the median" in found.message


def test_units_behind_the_names_of_columns(tmp_path):
    found = message(tmp_path, "track,t [s],x [m],y (m)", *driving(steps=4))
    assert found.message.endswith("it has no column `t`, but `t [s]`")
    assert found.help == "if `t [s]` is meant, rename it to `t`"


def test_speeds_with_a_sign_that_headings_deny(tmp_path):
    """Who drives where it heads drives forwards: nothing is wrong with its headings."""
    found = message(tmp_path, f"{HEAD},heading_deg,speed", *driving(steps=40, more=",0,-10"))
    assert "negative speed" in found.message
    assert found.help.startswith("leave out the sign")


@pytest.mark.parametrize(
    ("row", "way_out"),
    [
        ("a,0,1,0,yes", "write 1 for true, 0 for false"),
        ("a,0 days 00:00:00.100000,1,0,1", "write seconds, such as 0.1, as pandas' `t.dt."),
        ("a,2024-01-01T00:00:00,1,0,1", "write seconds, such as 0.1, from any moment on"),
        ("a,12:30:01.5,1,0,1", "write seconds, such as 0.1, from any moment on"),
        ("a,0,1e400,0,1", "leave the row out, or write the number that is meant"),
        ("a,0,inf,0,1", "leave the row out, or write the number that is meant"),
        ("a,0,one,0,1", "it has a row for each time of each track"),
        ("a,0,1_0,0,1", "it has a row for each time of each track"),
        ("a,0,１０,0,1", "it has a row for each time of each track"),
    ],
)
def test_what_stands_in_the_place_of_a_number(tmp_path, row, way_out):
    found = message(tmp_path, f"{HEAD},ego", row)
    assert found.help.startswith(way_out)
    most = f" below {LARGEST_NUMBER:.0e}" if "e400" in row or "inf" in row else ""
    assert found.expected == f"expected a number{most}"


def test_a_slip_in_a_name_is_said(tmp_path):
    recording = read(tmp_path, f"{HEAD},lenght,note", *driving(more=",5,x"))
    assert "columns that are not read: `lenght` (is it `length`?)" in recording.remarks


@pytest.mark.parametrize(
    ("name", "near"),
    [("extra", ""), ("recordings_of", ""), ("wdith", "width"), ("brakelight", "brake_light")],
)
def test_only_a_name_that_is_close_is_asked_about(tmp_path, name, near):
    rows = driving(more=",1")
    remarks = read(tmp_path, f"{HEAD},{name}", *rows).remarks
    asked = [remark for remark in remarks if "not read" in remark]
    assert asked == ([f"columns that are not read: `{name}` (is it `{near}`?)"] if near else [])


@pytest.mark.parametrize("encoding", ["utf-16", "utf-16-le", "utf-16-be"])
def test_text_in_utf_16_is_told_how_to_save_it(tmp_path, encoding):
    """As Excel's Unicode text, with a mark at its beginning or without."""
    file = written(tmp_path, "")
    file.write_bytes(table(HEAD, *driving()).encode(encoding))
    assert is_recording(str(file))
    with pytest.raises(RulecError) as caught:
        read_recording(file)
    (found,) = caught.value.diagnostics
    assert found.message.endswith("cannot be read as a table of tracks: it is text in UTF-16")
    assert found.help == "save it in UTF-8"


def test_a_track_of_another_rate(tmp_path):
    slow = [f"b,{k / 5},{20 + k},0" for k in range(5)]
    found = message(tmp_path, HEAD, *driving(), *slow)
    assert "track `b` has a row every 0.2 s" in found.message


def test_two_egos(tmp_path):
    rows = [*driving("a", more=",1"), *driving("b", more=",1")]
    assert "`a` and `b` are both ego" in message(tmp_path, f"{HEAD},ego", *rows).message


def test_without_a_map(tmp_path):
    found = message(tmp_path, HEAD, *driving(), lanes="")
    assert (found.code, found.message) == ("R0614", "`cars.csv` has tracks, but no roads")
    assert "`map_path`" in found.help
    assert "`cars.lanes.csv` or `lanes.csv` beside it would be found" in found.help


def test_far_from_the_roads(tmp_path):
    found = message(tmp_path, HEAD, *driving(start=5000.0))
    assert found.code == "R0615"
    assert "x 5000.0 to 5010.0" in found.message
