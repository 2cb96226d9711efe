"""What a file says of how bodies move, against how their places move."""

import numpy as np
import pytest

from rulec import RulecError, read_recording

LANE = """
<lanelet id="1">
  <leftBound><point><x>-9</x><y>2</y></point><point><x>99</x><y>2</y></point></leftBound>
  <rightBound><point><x>-9</x><y>-2</y></point><point><x>99</x><y>-2</y></point></rightBound>
</lanelet>"""


def told(tmp_path, cars=4, size=(4.5, 1.8), step=0.1, limit="", **changed):
    """The remarks on cars that go east and north in turns, at 10 m/s."""
    said = f"<speedLimit>{limit}</speedLimit>" if limit else ""
    lane = LANE.replace("</lanelet>", f"{said}</lanelet>")
    bodies = "".join(_car(number, size, changed) for number in range(cars))
    file = tmp_path / "DEU_Some-1_1_T-1.xml"
    head = f'commonRoadVersion="2020a" benchmarkID="DEU_Some-1_1_T-1" timeStepSize="{step}"'
    file.write_text(f"<commonRoad {head}>{lane}{bodies}</commonRoad>")
    return read_recording(file).remarks


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
        ({"speed": lambda row: 36.0}, "speeds are 3.6 times what places and times say"),
        ({"step": 100}, "speeds are 1e+03 times what places and times say"),
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
    (remark,) = told(tmp_path, speed=lambda row: 1000.0)
    assert "speeds are 100 times what places and times say" in remark
