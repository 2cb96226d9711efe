"""Small CommonRoad files that ask for much: refused, in little time and memory."""

import gzip
import tracemalloc

import pytest

from rulec import read_recording
from rulec.diagnostics import RulecError
from rulec.recordings.encodings import xml_tree
from support.builders.recorded_cars import car
from support.builders.recordings import ROAD_XML

HEAD, TAIL = ROAD_XML.index("  <obstacle"), ROAD_XML.index("  <planning")
PHANTOM = """<phantomObstacle id="9"><occupancySet><occupancy>
<shape><circle><radius>1</radius></circle></shape><time>{}</time></occupancy></occupancySet>
</phantomObstacle>"""
INTERVAL = "<intervalStart>{}</intervalStart><intervalEnd>{}</intervalEnd>"


def with_obstacles(folder, obstacles):
    file = folder / "ZAM_Road-1_1_T-1.xml"
    file.write_text(ROAD_XML[:HEAD] + obstacles + ROAD_XML[TAIL:])
    return file


def refused(file):
    with pytest.raises(RulecError) as caught:
        read_recording(file)
    (found,) = caught.value.diagnostics
    assert found.code == "R0610"
    return found


@pytest.mark.parametrize("step", [20_000_000, 1_000_001, 99_999])
def test_one_time_step_far_away(tmp_path, step):
    """Whoever asks for all tracks at once would get arrays from the first to the last step."""
    cars = car(7, 10, 0, 12).replace("<exact>29</exact>", f"<exact>{step}</exact>")
    found = refused(with_obstacles(tmp_path, cars))
    assert f"steps 0 to {step} are too far apart" in found.message
    assert "a time that is wrong" in found.help


def test_few_states_of_many_for_a_long_time(tmp_path):
    """Each of them is there once; together with a long recording they would be many cells."""
    many = "".join(car(number, 10, 0, 12, steps=1) for number in range(100, 1100))
    assert len(read_recording(with_obstacles(tmp_path, many)).participants) == 1000
    long_one = car(7, 10, 0, 12, steps=30).replace("<exact>29</exact>", "<exact>25000</exact>")
    assert len(read_recording(with_obstacles(tmp_path, long_one)).participants) == 1
    found = refused(with_obstacles(tmp_path, many + long_one))
    assert "obstacles: 1,001, states: 1,030" in found.message


@pytest.mark.parametrize(
    ("time", "says"),
    [
        (INTERVAL.format(5, 3), "an interval of time begins at step 5 and ends at 3"),
        (INTERVAL.format(0, 99_000_000), "more than 1,000,000 steps in total"),
        (f"<exact>{10**300}</exact>", "`exact` is `1000"),
        (f"<exact>{'9' * 5000}</exact>", "`exact` is `9999"),
        ("<exact>1.5</exact>", "`exact` is `1.5`"),
        ("", "the element `time` has no `intervalStart`"),
    ],
)
def test_times_that_are_none(tmp_path, time, says):
    assert says in refused(with_obstacles(tmp_path, PHANTOM.format(time))).message


def test_what_is_there_for_an_interval_takes_one_outline(tmp_path):
    found = read_recording(with_obstacles(tmp_path, PHANTOM.format(INTERVAL.format(0, 900))))
    (phantom,) = found.participants
    assert list(phantom.outlines) == list(range(901))
    assert phantom.outlines[0] is phantom.outlines[900]


def test_a_number_of_a_million_digits_is_not_cut(tmp_path):
    """What is kept of it would be another number."""
    file = with_obstacles(
        tmp_path, car(7, 10, 0, 12).replace("<x>10</x>", f"<x>{'0' * 10**6}1</x>")
    )
    assert "`x` is `0000" in refused(file).message


def test_elements_in_elements_without_end(tmp_path):
    deep = 200_000
    file = with_obstacles(tmp_path, "<a>" * deep + "</a>" * deep)
    assert read_recording(file).participants == ()


def test_shapes_in_shapes_without_end(tmp_path):
    deep = 50_000
    groups = "<shapeGroup><shape>" * deep, "</shape></shapeGroup>" * deep
    cars = car(7, 10, 0, 12).replace("<shape>", f"<shape>{groups[0]}")
    file = with_obstacles(tmp_path, cars.replace("</shape>", f"{groups[1]}</shape>"))
    (found,) = read_recording(file).participants
    assert len(found.outlines) == 30


def test_an_obstacle_of_too_many_elements(tmp_path, monkeypatch):
    monkeypatch.setattr(xml_tree, "MOST_ELEMENTS", 1000)
    assert len(read_recording(with_obstacles(tmp_path, car(7, 10, 0, 12))).participants) == 1
    found = refused(with_obstacles(tmp_path, car(7, 10, 0, 12, steps=100)))
    assert "the element `obstacle` has more than 1,000 others in it" in found.message
    assert found.place.line == ROAD_XML[:HEAD].count("\n") + 2


def test_a_packed_file_is_unpacked_as_it_is_read(tmp_path):
    file = tmp_path / "DEU_Road-1_1_T-1.xml.gz"
    file.write_bytes(gzip.compress(ROAD_XML.encode()))
    recording = read_recording(file)
    assert (recording.name, recording.country) == ("DEU_Road-1_1_T-1", "DEU")


def test_a_state_of_a_large_file_takes_little_memory(tmp_path):
    """A few numbers, whether or not anybody looks at its outline."""
    many = "".join(car(number, 10, 0, 12, steps=400) for number in range(100, 110))
    file = with_obstacles(tmp_path, many)
    read_recording(file)  # what is imported on the way is not the recording's
    tracemalloc.start()
    recording = read_recording(file)
    kept, most = tracemalloc.get_traced_memory()
    tracemalloc.stop()
    states = sum(len(one.states) for one in recording.participants)
    assert states == 10 * 400
    assert kept / states < 105
    assert most / states < 500
