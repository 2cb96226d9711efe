"""What single elements of CommonRoad's files mean, and what is said of those that mean nothing."""

from math import inf, pi
from pathlib import Path

import numpy as np
import pytest

from rulec import read_recording
from rulec.diagnostics import RulecError
from rulec.recordings.recording import BROAD_LEFT, BROAD_RIGHT, Light, Weather
from support.builders.recordings import ROAD_XML

BOX = "<rectangle><length>4</length><width>2</width></rectangle>"
EXACT = "<orientation><exact>0</exact></orientation><time>"
PLACE = "<position><point><x>40</x><y>0</y></point></position>"
RIGHT = "</rightBound>"
INTERVAL = """<orientation><intervalStart>{}</intervalStart><intervalEnd>{}</intervalEnd>
</orientation><time>"""
GOAL = "<goalState>"
AT = "<center><x>{}</x><y>{}</y></center>"


@pytest.fixture
def read(tmp_path):
    def read(*changes, name="ZAM_Road-1_1_T-1"):
        text = ROAD_XML
        for before, after in changes:
            assert before in text
            text = text.replace(before, after, 1)
        file = tmp_path / f"{name}.xml"
        file.write_text(text)
        return read_recording(file)

    return read


def bounds(outline):
    return [*outline.min(axis=0), *outline.max(axis=0)]


def test_a_truck_shape_lies_around_its_rear_axle(read):
    dims = "<truckDims><length>6</length><width>2.5</width></truckDims>"
    truck = f"<truckShape>{dims}<originXShift>-2</originXShift></truckShape>"
    (found,) = read((BOX, truck)).participants
    assert bounds(found.outlines[0]) == [39, -1.25, 45, 1.25]
    assert (found.states[0].x, found.states[0].y) == (40, 0)


def test_how_far_states_may_be_wrong_is_half_of_what_they_leave_open(read):
    area = f"<rectangle><length>0.6</length><width>0.8</width>{AT.format(40, 0)}</rectangle>"
    (found,) = read((PLACE, f"<position>{area}</position>")).participants
    assert found.stated_error == pytest.approx((0.5, 0.0))
    assert read().participants[0].stated_error is None


def test_a_broad_line_is_a_broken_one_of_a_kind(read):
    for text, broad in (("dashed", False), ("broad_dashed", True), ("broad_solid", False)):
        mark = f"<lineMarking>{text}</lineMarking>"
        lanelet = read(("</leftBound>", f"{mark}</leftBound>")).lanelets["1"]
        assert (BROAD_LEFT in lanelet.types) == broad
        assert lanelet.left_mark == ("solid" if text == "broad_solid" else "broken")
        other = read((RIGHT, f"{mark}{RIGHT}")).lanelets["1"].types
        assert other & {BROAD_LEFT, BROAD_RIGHT} == ({BROAD_RIGHT} if broad else set())


def test_of_several_states_the_median_counts():
    """Of a cycle's five places one is exact, and two circles around them are wider than 1 m."""
    sample = Path(__file__).with_name("samples") / "DEU_EveryElement-1_1_T-1.xml"
    (cycle,) = [body for body in read_recording(sample).participants if body.id == "82"]
    assert cycle.stated_error == pytest.approx((1.0, 0.0))


def test_shapes_together_turn_around_the_obstacles_place(read):
    rear = f"<rectangle><length>4</length><width>2</width>{AT.format(-4, 0)}</rectangle>"
    group = f"<shapeGroup><shape>{BOX}</shape><shape>{rear}</shape></shapeGroup>"
    quarter = EXACT.replace("<exact>0", f"<exact>{pi / 2}")
    (found,) = read((BOX, group), (EXACT, quarter)).participants
    assert bounds(found.outlines[0]) == pytest.approx([39, -6, 41, 2])


def test_a_shape_beside_its_place_that_may_be_turned_counts_either_way(read):
    ahead = BOX.replace("</rectangle>", f"{AT.format(3, 0)}</rectangle>")
    turned = EXACT.replace(
        "<exact>0</exact>", "<intervalStart>0</intervalStart><intervalEnd>0.001</intervalEnd>"
    )
    (found,) = read((BOX, ahead), (EXACT, turned)).participants
    assert bounds(found.outlines[0]) == pytest.approx([35, -1, 45, 1], abs=0.02)


def test_angles_beyond_a_full_turn(read):
    low, high = 6 * pi - 0.1, 6 * pi + 0.3
    interval = f"<intervalStart>{low}</intervalStart><intervalEnd>{high}</intervalEnd>"
    (found,) = read((EXACT, EXACT.replace("<exact>0</exact>", interval))).participants
    assert found.states[0].heading == pytest.approx(2 * pi + 0.1)


def test_of_two_states_of_one_step_the_later_one_holds(read):
    state = f"<state>{PLACE.replace('40', '{}')}{EXACT}<exact>{{}}</exact></time></state>"
    states = "".join(state.format(x, step) for x, step in [(42, 2), (41, 1), (43, 2)])
    (found,) = read(
        ("<velocity><exact>5</exact></velocity>\n    </initialState>", "</initialState>"),
        ("  </obstacle>", f"<trajectory>{states}</trajectory></obstacle>"),
    ).participants
    assert {step: state.x for step, state in found.states.items()} == {0: 40, 1: 41, 2: 43}
    assert found.outlines[2].max(axis=0).tolist() == [45, 1]
    assert found.states[0].speed == 0


def test_lamps_in_any_spelling_of_truth_and_for_an_interval(read):
    time = "<time><intervalStart>1</intervalStart><intervalEnd>3</intervalEnd></time>"
    series = f"<signalState>{time}<horn>0</horn><indicatorLeft>1</indicatorLeft></signalState>"
    series = f"<signalSeries>{series}</signalSeries></obstacle>"
    (found,) = read(("</obstacle>", series)).participants
    assert found.lamps == dict.fromkeys((1, 2, 3), frozenset({"left_indicator"}))
    assert found.shows == {"left_indicator", "horn"}


def three_cars(*lit):
    """Cars with these right indicators at steps 1 and 2, and left ones that are off."""
    state = "<signalState><time><exact>{}</exact></time>{}</signalState>"
    cars = []
    for number, own in enumerate(lit, 21):
        states = "".join(
            state.format(
                step, f"<indicatorLeft>0</indicatorLeft><indicatorRight>{one}</indicatorRight>"
            )
            for step, one in enumerate(own, 1)
        )
        cars.append(
            f'<dynamicObstacle id="{number}"><type>car</type><shape>{BOX}</shape>'
            f"<initialState>{PLACE}{EXACT}<exact>0</exact></time></initialState><signalSeries>{states}</signalSeries>"
            "</dynamicObstacle>"
        )
    return "</commonRoad>", "".join([*cars, "</commonRoad>"])


def test_an_indicator_that_is_on_all_the_time_of_all_is_none(read):
    found = read(three_cars((1, 1), (1, 1), (1, 1)))
    (remark,) = found.remarks
    assert remark == "the right indicator of every vehicle is on all the time, so it is ignored"
    cars = [body for body in found.participants if body.lamps]
    assert len(cars) == 3
    for car in cars:
        assert car.shows == {"left_indicator"}
        assert car.lamps == {1: frozenset(), 2: frozenset()}


@pytest.mark.parametrize("lit", [((1, 1), (1, 1)), ((1, 1), (1, 1), (1, 0))])
def test_an_indicator_of_two_or_one_that_goes_off_is_one(read, lit):
    found = read(three_cars(*lit))
    assert found.remarks == ()
    for car, own in zip([body for body in found.participants if body.lamps], lit, strict=True):
        assert car.shows == {"left_indicator", "right_indicator"}
        assert [bool(on) for on in car.lamps.values()] == [bool(on) for on in own]


@pytest.mark.parametrize(
    ("light", "lights"),
    [
        ("<cycle>{}<timeOffset>4</timeOffset></cycle>", (Light(4, (("red", 30),)),)),
        ("<cycle>{}</cycle><active>1</active>", (Light(0, (("red", 30),)),)),
        ("<cycle>{}</cycle><active>0</active>", ()),
        ("<cycle/>", ()),
        ("", ()),
    ],
)
def test_lights(read, light, lights):
    phase = "<cycleElement><duration>30</duration><color>red</color></cycleElement>"
    found = read(
        (RIGHT, f'{RIGHT}<trafficLightRef ref="7"/><trafficLightRef ref="9"/>'),
        ("  <obstacle", f'<trafficLight id="7">{light.format(phase)}</trafficLight><obstacle'),
    )
    assert found.lanelets["1"].lights == lights


@pytest.mark.parametrize(
    ("country", "number", "name"),
    [
        ("DEU", "205", "YIELD"),
        ("ZAM", "720", "GREEN_ARROW"),
        ("POL", "206", "STOP"),  # not in the tables
        ("C-USA", "R1-3", "STOP_4_WAY"),
        ("USA", "206", "UNKNOWN"),
        ("USA", " R10-11 ", "NO_TURN_ON_RED"),
        ("USA", "R1-2", "YIELD"),
        ("FRA", "AB3a", "YIELD"),
        ("GBR", "602", "YIELD"),
        ("ESP", "r3", "PRIORITY"),
        ("ESP", "r305", "NO_OVERTAKING_START"),
        ("ITA", "274", "MAX_SPEED"),
        ("AUS", "274", "MAX_SPEED"),
    ],
)
def test_signs_by_the_country_of_the_benchmark(read, country, number, name):
    post = f"<trafficSignElement><trafficSignID>{number}</trafficSignID></trafficSignElement>"
    found = read(
        ("ZAM_", f"{country}_"),
        (RIGHT, f'{RIGHT}<trafficSignRef ref="7"/>'),
        ("  <obstacle", f'<trafficSign id="7">{post}</trafficSign><obstacle'),
        name="my own drive",
    )
    assert found.lanelets["1"].signs == {name}
    assert found.lanelets["1"].limit_mps is None


def test_the_lowest_limit_holds_and_none_may_be_infinite(read):
    def lanelet(*limits, number=274):
        posts = "".join(
            f"<trafficSignElement><trafficSignID>{number}</trafficSignID>"
            f"<additionalValue>{limit}</additionalValue></trafficSignElement>"
            for limit in limits
        )
        recording = read(
            (RIGHT, f'{RIGHT}<trafficSignRef ref="7"/>'),
            ("  <obstacle", f'<trafficSign id="7">{posts}</trafficSign><obstacle'),
        )
        return recording.lanelets["1"]

    def found(*limits):
        return lanelet(*limits).limit_mps

    # The least speed of sign 275 is another thing
    least = lanelet("8.25", "13.5", number=275)
    assert (least.limit_mps, least.minimum_mps) == (None, 13.5)
    assert lanelet("13.5").minimum_mps is None
    assert found("inf") == inf
    assert found("13.5", "inf", "8.25") == 8.25
    assert found("80kmh") == pytest.approx(80 / 3.6)
    assert found("36 km/h", "30mph") == pytest.approx(10)
    assert found("50mph") == pytest.approx(22.352)
    for odd in ("kmh", "80 kph", "-5kmh", "8 0kmh"):
        with pytest.raises(RulecError, match="additionalValue"):
            found(odd)


@pytest.mark.parametrize(
    ("sign", "plate", "name", "limit"),
    [
        ("274", None, "MAX_SPEED", 13.5),
        ("274", "1001-30", "MAX_SPEED", 13.5),  # for so many metres
        ("274", "1053-35", "UNKNOWN", None),  # when wet
        ("274", "1040-30", "UNKNOWN", None),  # at these hours
        ("276", "1049-13", "UNKNOWN", None),  # for vehicles of more than 3.5 t
        ("274", "1010-51", "UNKNOWN", None),  # for lorries
        ("276", "1042-33", "UNKNOWN", None),  # from Monday to Friday
        ("274", "1020", "UNKNOWN", None),
        ("274.1", "1040-30", "UNKNOWN", None),
        ("275", "1010-51", "UNKNOWN", None),
    ],
)
def test_of_signs_that_hold_for_some_nothing_is_known(read, sign, plate, name, limit):
    """As of a ban of overtaking for lorries, which is none for ego's car."""
    value = "<additionalValue>13.5</additionalValue>"
    posts = f"<trafficSignElement><trafficSignID>{sign}</trafficSignID>{value}</trafficSignElement>"
    if plate is not None:
        posts += f"<trafficSignElement><trafficSignID>{plate}</trafficSignID></trafficSignElement>"
    lanelet = read(
        ("ZAM_", "DEU_"),
        (RIGHT, f'{RIGHT}<trafficSignRef ref="7"/>'),
        ("  <obstacle", f'<trafficSign id="7">{posts}</trafficSign><obstacle'),
    ).lanelets["1"]
    assert lanelet.signs - ({"UNKNOWN"} if limit else set()) == {name}
    assert (lanelet.limit_mps, lanelet.minimum_mps) == (limit, None)
    untold = {"276": "NO_OVERTAKING_START", "275": "MIN_SPEED"}.get(sign, "MAX_SPEED")
    assert lanelet.untold_signs == (set() if limit else {untold})


def posted(read, *elements, country="DEU_"):
    """The lanelet with a post of these signs: ids and further elements."""
    posts = "".join(
        f"<trafficSignElement><trafficSignID>{number}</trafficSignID>{more}</trafficSignElement>"
        for number, more in elements
    )
    return read(
        ("ZAM_", country),
        (RIGHT, f'{RIGHT}<trafficSignRef ref="7"/>'),
        ("  <obstacle", f'<trafficSign id="7">{posts}</trafficSign><obstacle'),
    ).lanelets["1"]


VALUE = "<additionalValue>13.5</additionalValue>"


def test_a_zone_limits_the_speed(read):
    lanelet = posted(read, ("274.1", VALUE))
    assert (lanelet.signs, lanelet.limit_mps) == ({"MAX_SPEED_ZONE_START"}, 13.5)


@pytest.mark.parametrize(
    ("number", "untold"),
    [("274", "MAX_SPEED"), ("274.1", "MAX_SPEED"), ("275", "MIN_SPEED")],
)
def test_a_sign_without_its_number_is_there_all_the_same(read, number, untold):
    lanelet = posted(read, (number, ""))
    assert (lanelet.limit_mps, lanelet.minimum_mps) == (None, None)
    assert lanelet.untold_signs == {untold}


@pytest.mark.parametrize("plate", ["1000-32", "1002-20"])
def test_plates_about_who_crosses_leave_signs_of_priority_as_they_are(read, plate):
    lanelet = posted(read, ("206", ""), (plate, ""), ("274", VALUE))
    assert lanelet.signs >= {"STOP"}
    assert (lanelet.limit_mps, lanelet.untold_signs) == (None, {"MAX_SPEED"})


@pytest.mark.parametrize(
    ("country", "sign", "plate"),
    [("USA_", "R2-1", "S4-2P"), ("FRA_", "B14", "M4d1"), ("ESP_", "r301", "S-820")],
)
def test_what_is_unknown_on_a_post_of_another_country_may_be_a_plate(read, country, sign, plate):
    assert posted(read, (sign, VALUE), country=country).limit_mps == 13.5
    lanelet = posted(read, (sign, VALUE), (plate, ""), country=country)
    assert (lanelet.limit_mps, lanelet.untold_signs) == (None, {"MAX_SPEED"})


@pytest.mark.parametrize(
    ("sky", "ground", "weather"),
    [
        ("sunny", "clean", Weather(wet=False, icy=False, visibility_m=1000, raining=False)),
        ("clear", "ice", Weather(wet=None, icy=True, visibility_m=1000, raining=False)),
        ("hail", "snow", Weather(wet=True, raining=True)),
        ("snow", "unknown", Weather(raining=True)),
        ("unknown", "unknown", Weather()),
        ("fog", "wet", Weather(wet=True, icy=False, raining=False)),
    ],
)
def test_the_weather(read, sky, ground, weather):
    said = f"<weather>{sky}</weather><underground>{ground}</underground>"
    place = f"<location><environment>{said}</environment></location>"
    assert read(("  <obstacle", f"{place}<obstacle")).weather == weather


@pytest.mark.parametrize(
    ("daytime", "night"), [("night", True), ("noon", False), ("sunset", None), ("12:00", None)]
)
def test_the_time_of_day(read, daytime, night):
    said = f"<timeOfDay>{daytime}</timeOfDay>"
    place = f"<location><environment>{said}</environment></location>"
    assert read(("  <obstacle", f"{place}<obstacle")).weather.night is night


def test_tiny_numbers_are_none(read):
    """Geometry squares them, and divides by that."""
    found = read(("<x>40</x>", "<x>1e-320</x>"))
    assert found.participants[0].states[0].x == 0
    assert np.isfinite(found.participants[0].outlines[0]).all()


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        (BOX, "", "the element `shape` has no shape in it"),
        (BOX, "<semiTrailerTruckShape/>", "`semiTrailerTruckShape` is not a known shape"),
        (BOX, BOX.replace(">4<", ">0<"), "`length` is 0"),
        (BOX, BOX.replace("<width>", "<originXShift>3</originXShift><width>"), "outside it"),
        (BOX, "<polygon><point><x>0</x><y>0</y></point></polygon>", "fewer than 3 points"),
        (BOX, "<circle/>", "the element `circle` has no `radius`"),
        (PLACE, "<position/>", "neither a `point` nor a shape"),
        (PLACE, '<position><lanelet ref="1"/></position>', "neither a `point` nor a shape"),
        (EXACT, "<orientation/><time>", "neither `exact` nor `intervalStart`"),
        (EXACT, INTERVAL.format(1, 0), "begins at 1 and ends at 0"),
        (EXACT, INTERVAL.format(0, 7), "a full turn or more"),
        ("<x>0</x><y>-2</y>", "<x>0</x><y>-2</y></point><point><x>1</x><y>-2</y>", "2 points on"),
        (RIGHT, f"{RIGHT}<stopLine><point><x>1</x><y>1</y></point></stopLine>", "only one end"),
        (RIGHT, f"{RIGHT}<speedLimit>-1</speedLimit>", "a speed limit is -1"),
        (RIGHT, f"{RIGHT}<speedLimit>nan</speedLimit>", "`speedLimit` is `nan`"),
        ("<x>40</x>", "<x>4_0</x>", "`x` is `4_0`"),
        ("<x>40</x>", "<x>４０</x>", "`x` is `４０`"),
        (EXACT, f"{EXACT}<exact>1_0</exact></time><time>", "`exact` is `1_0`"),
        (RIGHT, f"{RIGHT}<laneletType>road</laneletType>", "`laneletType` is `road`"),
        (RIGHT, f"<lineMarking/>{RIGHT}", "`lineMarking` is empty"),
        (RIGHT, f'{RIGHT}<successor ref="two"/>', "`ref` of a `successor` is `two`"),
        (RIGHT, f"{RIGHT}<successor/>", "the element `successor` has no `ref`"),
        (
            GOAL,
            f'{GOAL}<position><lanelet ref="8"/></position>',
            "lanelet 8, which is not in the file",
        ),
        ('<planningProblem id="2">', '<planningProblem id="-2">', "`id` of a `planningProblem`"),
        ('"0.1"', '"1e-9"', "a time step of 1e-09 s"),
    ],
)
def test_what_means_nothing(read, before, after, says):
    with pytest.raises(RulecError) as caught:
        read((before, after))
    (found,) = caught.value.diagnostics
    assert says in found.message
    # The place is the line of the element in question, or one that it begins on
    line = ROAD_XML[: ROAD_XML.index(before)].count("\n") + 1
    assert found.place.line in range(line - 6, line + 3)


@pytest.mark.parametrize(
    ("users", "others"),
    [
        ("", set()),
        ("<userOneWay>bus</userOneWay>", {"busesOnly"}),
        (
            "<userOneWay>bus</userOneWay><userOneWay>bicycle</userOneWay>",
            {"busesOnly", "cyclesAllowed"},
        ),
        ("<userOneWay>taxi</userOneWay>", {"busesOnly", "taxisAllowed"}),
        ("<userBidirectional>bicycle</userBidirectional>", {"busesOnly", "cyclesAllowed"}),
    ],
)
def test_who_else_may_use_a_bus_lane(read, users, others):
    def types(kind):
        return read((RIGHT, f"{RIGHT}<laneletType>{kind}</laneletType>{users}")).lanelets["1"].types

    assert types("busLane") == {"busLane"} | others
    assert types("urban") == {"urban"}


def test_signs_beside_the_carriageway_hold_on_it_nobody_knows_where(read):
    """As in a map of rounD's: signs to give way are nearer to a sidewalk than to the lane."""
    sign = "<trafficSignElement><trafficSignID>{}</trafficSignID></trafficSignElement>"
    bounds = ROAD_XML[ROAD_XML.index("<leftBound>") : ROAD_XML.index(RIGHT) + len(RIGHT)]
    beside = f'<lanelet id="8">{bounds}<laneletType>sidewalk</laneletType>{{}}</lanelet>'

    def found(number, kind="sidewalk"):
        walk = beside.format('<trafficSignRef ref="7"/>').replace("sidewalk", kind)
        post = f'<trafficSign id="7">{sign.format(number)}</trafficSign>'
        return read(("  <obstacle", f"{walk}{post}<obstacle"), name="DEU_Ring-1_1_T-1")

    recording = found(205)
    assert recording.lanelets["1"].untold_signs == {"YIELD"}
    assert recording.lanelets["8"].untold_signs == set()
    assert any("beside the carriageway" in remark for remark in recording.remarks)
    # What bans overtaking says nothing of who goes first, and on a lane a sign is where it holds
    for other in (found(276), found(205, "urban")):
        assert other.lanelets["1"].untold_signs == set()
        assert not any("carriageway" in remark for remark in other.remarks)


def test_intersections_that_share_an_id_are_several(read):
    """As in the map of inD's second place: the second one there names no ways."""
    begin = '<intersection id="70"><incoming id="71"><incomingLanelet ref="2"/>'
    way = '<successorsStraight ref="1"/>'
    twice = "".join(f"{begin}{of_each}</incoming></intersection>" for of_each in (way, "", ""))
    found = read(("  <obstacle", f"{twice}<obstacle"))
    remarks = [remark for remark in found.remarks if "intersections" in remark]
    assert remarks == ["there are several intersections `70`: each is treated as a separate one"]
    assert found.lanelets["1"].junction == "70"


@pytest.mark.parametrize(
    ("name", "says"),
    [
        ("lanelet", "two elements `lanelet` with the id `1`"),
        ("obstacle", "two obstacles `3`"),
        ("planningProblem", "two elements `planningProblem` with the id `2`"),
    ],
)
def test_what_is_there_twice(read, name, says):
    start, end = ROAD_XML.index(f"  <{name} "), ROAD_XML.index(f"</{name}>") + len(f"</{name}>")
    one = ROAD_XML[start:end]
    with pytest.raises(RulecError) as caught:
        read((one, one + one))
    (found,) = caught.value.diagnostics
    assert says in found.message
    assert found.place.line == ROAD_XML[:end].count("\n") + 1
