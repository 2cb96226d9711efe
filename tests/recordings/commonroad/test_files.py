"""CommonRoad's files: a small one, and what is wrong with others."""

import subprocess
import sys
from dataclasses import replace

import numpy as np
import pytest

from rulec import read_map, read_recording
from rulec.diagnostics import RulecError
from rulec.recordings.commonroad import commonroad_file
from rulec.scenario import Choice, ConstantAcceleration, load_scenario
from support.builders.recordings import ROAD_XML

BOUND = "<leftBound><point><x>0</x><y>2</y></point><point><x>99</x><y>2</y></point></leftBound>"
DEFINITION = """\
<!DOCTYPE a [<!ENTITY b "bbbbbbbbbb"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;&b;&b;">
<!ENTITY d SYSTEM "file:///etc/hostname">]>
"""


@pytest.fixture
def written(tmp_path):
    def write(text):
        file = tmp_path / "road.xml"
        file.write_text(text, encoding="utf-8")
        return file

    return write


def problem_with(file):
    with pytest.raises(RulecError) as caught:
        load_scenario(file)
    (found,) = caught.value.diagnostics
    assert found.place.file == str(file)
    return found


def test_a_small_one(written):
    scenario = load_scenario(written(ROAD_XML))
    assert scenario.name == "road"
    assert scenario.road.s == pytest.approx((-9, 90))
    assert scenario.road.lanes == pytest.approx((-2, 2))
    assert (scenario.ego.s, scenario.ego.d) == pytest.approx((0, 0))
    (car,) = scenario.obstacles
    assert (car.id, car.type) == ("3", "car")
    assert (car.length, car.width) == pytest.approx((4, 2))
    assert car.motion == ConstantAcceleration(pytest.approx(31), pytest.approx(0), 5.0)


def test_standing_obstacles_in_the_old_spelling(written):
    text = ROAD_XML.replace("dynamic", "static").replace(">car<", ">parkedVehicle<")
    (parked,) = load_scenario(written(text)).obstacles
    assert (parked.type, parked.motion.speed) == ("vehicle", 0)


AT_THE_END = "<point><x>99</x><y>2</y></point><point><x>99</x><y>-2</y></point>"


@pytest.mark.parametrize("places", ["", AT_THE_END], ids=["no place", "at the lanelet's end"])
def test_a_stop_line_is_where_the_file_has_drawn_it(written, places):
    """Without a place it is not surely at the lanelet's end, where the format puts it."""
    line = f"<stopLine>{places}<lineMarking>solid</lineMarking></stopLine>"
    found = read_recording(written(ROAD_XML.replace("</rightBound>", f"</rightBound>{line}", 1)))
    drawn = found.lanelets["1"].stop_line
    assert drawn is None if not places else drawn.tolist() == [[99, 2], [99, -2]]


def test_areas_and_intervals_are_taken_whole(written):
    """An area of 6 m x 1 m for the centre, and a heading of up to 90° either way."""
    area = "<rectangle><length>6</length><width>1</width><orientation>0</orientation>"
    area += "<center><x>40</x><y>0</y></center></rectangle>"
    text = ROAD_XML.replace("<point><x>40</x><y>0</y></point>", area)
    (car,) = load_scenario(written(text)).obstacles
    assert (car.length, car.width) == pytest.approx((4 + 6, 2 + 1))
    turned = "<intervalStart>-1.5707</intervalStart><intervalEnd>1.5707</intervalEnd>"
    text = text.replace("<exact>0</exact></orientation><time>", f"{turned}</orientation><time>", 1)
    (car,) = load_scenario(written(text)).obstacles
    assert car.length > 10
    assert car.width > 4


def test_a_round_body_has_its_radius_in_every_direction(written):
    box = "<rectangle><length>4</length><width>2</width></rectangle>"
    text = ROAD_XML.replace(box, "<circle><radius>0.5</radius></circle>")
    (person,) = read_recording(written(text)).participants
    places = person.outlines[0] - (40, 0)
    assert np.hypot(*places.T) == pytest.approx(0.5, abs=0.002)


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        ("<commonRoad ", f"{DEFINITION}<commonRoad ", "it has a `DOCTYPE`"),
        ("<commonRoad ", "<!DOCTYPE commonRoad><commonRoad ", "it has a `DOCTYPE`"),
        ("2018b", "2017a", "its `commonRoadVersion` is `2017a`"),
        ("</lanelet>", "</lane>", "not well-formed XML: mismatched tag"),
        ("</commonRoad>", "", "it has been cut short"),
        (BOUND, "", "the element `lanelet` has no `leftBound`"),
        (BOUND, "<leftBound/>", "the element `leftBound` has fewer than 2 points"),
        ("<y>2</y>", "", "the element `point` has no `y`"),
        ('<lanelet id="1">', "<lanelet>", "the element `lanelet` has no `id`"),
        ('timeStepSize="0.1"', "", "the element `commonRoad` has no `timeStepSize`"),
        ("<type>car</type>", "", "the element `obstacle` has no `type`"),
        ("<length>4</length>", "", "the element `rectangle` has no `length`"),
        ("<type>car</type>", "<type>carr</type>", "`type` is `carr`"),
        ("dynamic", "flying", "`role` is `flying`"),
        ('"0.1"', '"0"', "a time step of 0 s"),
        ('"0.1"', '"soon"', "`timeStepSize` of a `commonRoad` is `soon`"),
        ("<x>9</x>", "<x>nan</x>", "`x` is `nan`"),
        ("<x>9</x>", "<x>1e300</x>", "`x` is `1e300`"),
        ("<y>2</y>", "<y>1e300</y>", "`y` is `1e300`"),
        ("<x>99</x>", "<x>99999999</x>", "longer than 20 km"),
        ("<y>2</y>", "<y>-2</y>", "no lane of the road is as wide as 1 m"),
    ],
)
def test_what_is_wrong(written, before, after, says):
    found = problem_with(written(ROAD_XML.replace(before, after)))
    assert found.code == "R0610"
    assert says in found.message
    assert "\n" not in found.message


def test_other_xml(written):
    found = problem_with(written("<kml version='0.6'/>"))
    assert "it is XML of `kml`" in found.message
    assert "`commonRoad`" in found.expected


def test_a_file_without_roads_is_no_map(written):
    roads = ROAD_XML[ROAD_XML.index("  <lanelet ") : ROAD_XML.index("  <obstacle ")]
    with pytest.raises(RulecError, match="it has no lanelet"):
        read_map(written(ROAD_XML.replace(roads, "")), 0.1)


def test_where_ego_is_not(written):
    found = problem_with(written(ROAD_XML.replace("<x>9</x>", "<x>900</x>")))
    assert (found.code, "on no lanelet" in found.message) == ("R0612", True)


def test_too_much_is_not_read(written, monkeypatch):
    small = replace(commonroad_file.COMMONROAD, largest_bytes=1000)
    monkeypatch.setattr(commonroad_file, "COMMONROAD", small)
    assert "too large" in problem_with(written(ROAD_XML)).message


def test_a_file_that_is_not_there(tmp_path):
    assert problem_with(tmp_path / "none.xml").code == "R0701"


def test_there_is_nothing_to_choose_in_other_scenarios():
    with pytest.raises(RulecError) as caught:
        load_scenario("s1", Choice(ego=1))
    assert [x.code for x in caught.value.diagnostics] == ["R0613"]
    assert load_scenario("s1", Choice()) == load_scenario("s1")


def test_what_recordings_need_is_not_loaded_for_other_scenarios():
    program = (
        "import sys\n"
        "from rulec.scenario import load_scenario; load_scenario('s1')\n"
        "assert not {'numpy', 'shapely'} & set(sys.modules)"
    )
    subprocess.run([sys.executable, "-c", program], check=True)
