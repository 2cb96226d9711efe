"""What a file says of how bodies move, against how their places move."""

import re
from functools import partial

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec import RulecError, read_recording, recording_from_columns

LANE = """
<lanelet id="1">
  <leftBound><point><x>-9</x><y>2</y></point><point><x>99</x><y>2</y></point></leftBound>
  <rightBound><point><x>-9</x><y>-2</y></point><point><x>99</x><y>-2</y></point></rightBound>
</lanelet>"""


def told(tmp_path, cars=4, size=(4.5, 1.8), step=0.1, limit="", rate=None, **changed):
    """The remarks on cars that go east and north in turns, at 10 m/s."""
    said = f"<speedLimit>{limit}</speedLimit>" if limit else ""
    lane = LANE.replace("</lanelet>", f"{said}</lanelet>")
    bodies = "".join(_car(number, size, changed) for number in range(cars))
    file = tmp_path / "DEU_Some-1_1_T-1.xml"
    head = f'commonRoadVersion="2020a" benchmarkID="DEU_Some-1_1_T-1" timeStepSize="{step}"'
    file.write_text(f"<commonRoad {head}>{lane}{bodies}</commonRoad>")
    return read_recording(file, frame_rate=rate).remarks


def _car(number, size, changed):
    states = [_state(number, k, changed) for k in range(20)]
    first = f"<initialState>{states[0]}</initialState>"
    rest = "".join(f"<state>{state}</state>" for state in states[1:])
    shape = f"<rectangle><length>{size[0]}</length><width>{size[1]}</width></rectangle>"
    return (
        f'<dynamicObstacle id="{number + 10}"><type>car</type><shape>{shape}</shape>'
        f"{first}<trajectory>{rest}</trajectory></dynamicObstacle>"
    )


def _state(number, k, changed):
    way = {"x": k + 10.0 * number, "y": 0.0, "heading": 0.0}
    if number % 2:
        way = {"x": 30.0, "y": k + 10.0 * number, "heading": np.pi / 2}
    row = way | {"speed": 10.0}
    row |= {name: change(row) for name, change in changed.items()}
    return (
        f"<position><point><x>{row['x']}</x><y>{row['y']}</y></point></position>"
        f"<orientation><exact>{row['heading']}</exact></orientation>"
        f"<time><exact>{k}</exact></time><velocity><exact>{row['speed']}</exact></velocity>"
    )


def test_what_is_said_as_it_moves(tmp_path):
    assert told(tmp_path) == ()
    # A bit off, as estimated speeds and headings are, is no doubt
    assert told(tmp_path, speed=lambda row: 12.0, heading=lambda row: row["heading"] + 0.2) == ()
    # All of them back, and say so by their speeds
    turned = {"heading": lambda row: row["heading"] + np.pi}
    assert told(tmp_path, speed=lambda row: -10.0, **turned) == ()


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"speed": lambda row: 16.0}, "speeds are 1.6 times what places and times say"),
        ({"heading": lambda row: row["heading"] + 0.5}, "29° off their headings"),
        ({"size": (1.8, 4.5)}, "wider than long"),
        (
            {"size": (14.8, 5.9)},
            "cars are 14.8 m long in the median: lengths may be in feet or cent",
        ),
    ],
)
def test_units_and_sizes_that_contradict_the_places(tmp_path, changed, said):
    (remark,) = told(tmp_path, **changed)
    assert said in remark


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"speed": lambda row: 36.0}, "speeds are 3.6 times what places and times say"),
        ({"step": 100}, "speeds are 1e+03 times what places and times say"),
        ({"speed": lambda row: 3.0}, "speeds are 0.3 times what places and times say"),
    ],
)
def test_speeds_that_contradict_places_stop_it_until_somebody_is_sure(tmp_path, changed, said):
    with pytest.raises(RulecError, match=re.escape(said)) as refused:
        told(tmp_path, **changed)
    (problem,) = refused.value.diagnostics
    rate = 1 / changed.get("step", 0.1)
    by_places = f"say `frame_rate={rate:g}` if time steps are, and it is judged by places"
    assert (problem.code, problem.help) == ("R0610", by_places)
    (remark,) = told(tmp_path, rate=rate, **changed)
    assert said in remark
    with pytest.raises(RulecError, match="states its own time steps") as refused:
        told(tmp_path, rate=2 * rate, **changed)
    assert refused.value.diagnostics[0].code == "R0613"


TRACKS = st.lists(
    st.tuples(st.floats(1.0, 40.0), st.integers(10, 40), st.floats(-0.25, 0.25)),
    min_size=3,
    max_size=8,
)


@given(TRACKS, st.sampled_from((0.04, 0.1, 0.5)), st.integers(0, 1000))
def test_noise_stops_no_table_and_a_wrong_unit_stops_each(tracks, step_s, seed):
    """Speeds up to a quarter off, places off by decimetres; then in km/h, and with frames."""
    chance = np.random.default_rng(seed)
    rows = {name: [] for name in ("track", "frame", "x", "y", "speed")}
    for number, (speed, steps, off) in enumerate(tracks):
        noise = 0.1 * speed * step_s
        for k in range(steps + int(6 / speed / step_s)):
            said = speed * (1 + off + chance.uniform(-0.2, 0.2))
            x = k * step_s * speed + chance.uniform(-noise, noise)
            row = (str(number), k, x, 0.1 * number, said)
            for column, value in zip(rows.values(), row, strict=True):
                column.append(value)
    lanes = {"lane": ["a", "a"], "x": [-50.0, 2000.0], "y": [0.0, 0.0]}
    read = partial(recording_from_columns, lanes=lanes)
    assert read(rows, frame_rate=1 / step_s).step_s == pytest.approx(step_s)
    with pytest.raises(RulecError, match="no frame rate"):
        read(rows)
    times = [frame * step_s for frame in rows["frame"]]
    timed = {"t": times, **{name: rows[name] for name in ("track", "x", "y", "speed")}}
    right = read(timed)
    in_kmh = {**timed, "speed": [3.6 * speed for speed in timed["speed"]]}
    for wrong in (in_kmh, {**timed, "t": [float(frame) for frame in rows["frame"]]}):
        if wrong is in_kmh or step_s < 0.5:
            with pytest.raises(RulecError, match="times what places and times say"):
                read(wrong)
        assert read(wrong, frame_rate=1 / step_s).step_s == pytest.approx(right.step_s)


@pytest.mark.parametrize(
    ("changed", "angle"),
    [
        ({"x": lambda row: row["y"], "y": lambda row: row["x"]}, 90),
        ({"heading": lambda row: np.pi / 2 - row["heading"]}, 90),
        ({"heading": lambda row: row["heading"] + np.pi}, 180),
    ],
)
def test_axes_that_contradict_the_headings(tmp_path, changed, angle):
    with pytest.raises(RulecError, match=f"vehicles move {angle}° away") as refused:
        told(tmp_path, **changed)
    assert refused.value.diagnostics[0].code == "R0610"


def test_of_one_or_two_nothing_is_concluded(tmp_path):
    """Who alone slides, or is measured badly, may do so."""
    assert told(tmp_path, cars=2, speed=lambda row: 36.0, heading=lambda row: 3.0) == ()


EASTWARD = {
    "x": lambda row: row["x"] if row["heading"] == 0.0 else row["y"],
    "y": lambda row: 0.0,
    "heading": lambda row: 0.0,
}


@pytest.mark.parametrize(
    ("limit", "cars", "said"),
    [
        # 130 km/h in a field of m/s, however fast the few cars are
        (130, 1, "limits are up to 468 km/h"),
        # At 10 m/s all drive 2.6 times 50 km/h that were divided by 3.6 twice
        (3.86, 8, "half of the vehicles drive 2.6 times the limit or faster"),
        # 25 mph without a unit, read as km/h, and traffic at 22 mph
        (6.5, 5, "half of the vehicles drive 1.5 times the limit or faster"),
        # 36 km/h would be the limit of a queue as well, but 30 m/s is no limit where 10 m/s is
        (30, 12, "nine in ten vehicles drive 0.33 times the limit or slower"),
    ],
)
def test_limits_that_no_traffic_goes_by(tmp_path, limit, cars, said):
    (remark,) = told(tmp_path, cars=cars, limit=limit, **EASTWARD)
    assert said in remark
    assert "unit" in remark or "km/h or mph" in remark


@pytest.mark.parametrize(
    ("limit", "cars"),
    [
        # As they should be; the highest limit that there is; nobody on the road but a few
        *[(13.89, 12), (8.33, 12), (44.44, 12), (3.86, 4)],
        # A queue on a motorway is slow, too; and so are a few, whatever the limit
        *[(33.33, 12), (30, 9)],
    ],
)
def test_limits_that_traffic_may_go_by(tmp_path, limit, cars):
    assert told(tmp_path, cars=cars, limit=limit, **EASTWARD) == ()


def test_who_is_on_no_lane_with_a_limit_says_nothing_of_limits(tmp_path):
    aside = EASTWARD | {"y": lambda row: 9.0}
    (remark,) = told(tmp_path, cars=12, limit=3.86, **aside)
    assert remark.startswith("only 0% of the places of vehicles that move are on lanes")


def test_who_is_as_fast_as_no_traffic(tmp_path):
    """Hundredths of a second for tenths: 100 m/s along the lane are 1,000 m/s."""
    (remark,) = told(tmp_path, step=0.001, speed=lambda row: 1000.0)
    assert remark.startswith("half of the vehicles move at 3,600 km/h or more: columns, or units")


def test_impossible_speeds_of_single_states(tmp_path):
    def spawned(row):
        # Who goes east is put on the road from far away, as simulators do it
        return 17367.0 if row["heading"] == 0 and row["x"] % 10 == 0 else 10.0

    (remark,) = told(tmp_path, speed=spawned)
    assert remark == (
        "4 speeds are up to 62,521 km/h, where places say otherwise: "
        "there it is the speeds of places that count"
    )
    recording = read_recording(tmp_path / "DEU_Some-1_1_T-1.xml")
    speeds = [state.speed for body in recording.participants for state in body.states.values()]
    assert speeds == pytest.approx([10.0] * 80)
    accelerations = [x.acceleration for x in recording.participants[0].states.values()]
    assert accelerations == pytest.approx([0.0] * 20)


def test_one_impossible_speed(tmp_path):
    (remark,) = told(tmp_path, cars=1, speed=lambda row: 200.0 if row["x"] == 3 else 10.0)
    assert remark.startswith("one speed is 720 km/h, where")


def test_impossible_speeds_in_a_wrong_unit(tmp_path):
    (remark,) = told(tmp_path, rate=10, speed=lambda row: 1000.0)
    assert "speeds are 100 times what places and times say" in remark
