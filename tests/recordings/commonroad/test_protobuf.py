"""CommonRoad's scenarios in Protocol Buffers mean what the same ones in XML mean.

The samples are what commonroad-io has written of `DEU_EveryElement-1_1_T-1.xml`: its release 2026.1
in parts, and 2023.4 in a single file.
"""

import shutil
from dataclasses import replace

import pytest

from rulec import read_recording
from rulec.cli.main import main
from rulec.diagnostics import RulecError
from rulec.recordings.commonroad import commonroad_protobuf
from support.builders.recorded_data import RECORDINGS
from support.builders.recordings import SAMPLES
from support.builders.wire_bytes import counted, double, field, whole
from support.oracles.same_recording import assert_same

MORE = RECORDINGS.parent / "commonroad_more"
BOTH_FORMS = MORE / "ARG_Carcarana-4_5_T-1.pb"
needs_more = pytest.mark.skipif(
    not BOTH_FORMS.exists(), reason="CommonRoad's scenarios are not here: set RULEC_RECORDINGS"
)
(XML,) = (file for file in SAMPLES if file.stem == "DEU_EveryElement-1_1_T-1")
TRAFFIC = XML.with_suffix(".pb")
PROBLEMS = XML.with_name("DEU_EveryElement-1_1_T-1-SC.pb")
MAP = XML.with_name("DEU_EveryElement-1.pb")
SINGLE = XML.with_name("DEU_SingleFile-1_1_T-1.pb")
PARTS = (MAP, TRAFFIC, PROBLEMS)

TEXT = XML.read_text(encoding="utf-8")
SEVERAL = TEXT.index("      <state>\n        <position><rectangle>")
NOWHERE = "<stopLine><lineMarking>dashed</lineMarking></stopLine>"
SHIFT = "<originXShift>-3.5</originXShift>"
NOT_IN_PARTS = {NOWHERE: "", SHIFT: "", "<active>false": "<active>true"}
"""What commonroad-io's writer has otherwise: lines without a place get one, shifts are lost, and so
is that a light does not work."""
NOT_IN_SINGLE = {
    NOWHERE: "",
    SHIFT: "",
    TEXT[SEVERAL : TEXT.index("</state>", SEVERAL) + len("</state>")]: "",
    "outgoingStraight": "successorsStraight",
    # Another mark to some of its releases
    "solid_solid": "broad_solid",
}
"""What its release 2023.4 cannot read or write."""


def in_xml(folder, name, otherwise):
    """The recording in the sample's XML with some of its words replaced."""
    text = TEXT
    for words, others in otherwise.items():
        assert words in text
        text = text.replace(words, others)
    file = folder / name
    file.write_text(text, encoding="utf-8")
    return read_recording(file)


def refused(file, *, beside=None):
    with pytest.raises(RulecError) as caught:
        read_recording(file)
    (found,) = caught.value.diagnostics
    assert (found.code, found.place.file) == ("R0610", str(beside or file))
    return found


def copied(folder, *files):
    """The first of some files, copied into a folder with the others."""
    copies = [shutil.copy(file, folder / file.name) for file in files]
    return copies[0]


@pytest.mark.parametrize("file", [TRAFFIC, PROBLEMS], ids=["traffic", "problems"])
def test_parts_are_the_xml(tmp_path, file):
    assert_same(read_recording(file), in_xml(tmp_path, XML.name, NOT_IN_PARTS))


def test_a_single_file_is_the_xml(tmp_path):
    expected = in_xml(tmp_path, "DEU_SingleFile-1_1_T-1.xml", NOT_IN_SINGLE)
    assert_same(read_recording(SINGLE), expected)


@needs_more
def test_a_recorded_scene_is_the_same_in_both_forms(capsys):
    xml = BOTH_FORMS.with_suffix(".xml")
    assert_same(read_recording(BOTH_FORMS), read_recording(xml))
    said = []
    for file in (BOTH_FORMS, xml):
        assert main(["verify", str(file), "-r", "de", "--json"]) == 0
        said.append(capsys.readouterr().out.replace(file.name, ""))
    assert said[0] == said[1]
    assert said[0].count("\n") == 8


def test_the_planning_problems_may_be_missing(tmp_path):
    found = read_recording(copied(tmp_path, TRAFFIC, MAP))
    assert_same(found, replace(read_recording(TRAFFIC), problems=()))


@pytest.mark.parametrize(
    ("there", "missing"),
    [
        ([TRAFFIC, PROBLEMS], MAP),
        ([PROBLEMS, MAP], TRAFFIC),
        ([PROBLEMS, TRAFFIC], MAP),
    ],
)
def test_a_missing_part_is_named(tmp_path, there, missing):
    found = refused(copied(tmp_path, *there))
    assert f"another part, `{missing.name}`, is not beside it" in found.message
    assert found.help == "put the parts into one folder"


def test_a_map_alone_is_no_recording():
    found = refused(MAP)
    assert "it is the map of a scenario in parts, without traffic" in found.message
    assert "give the part with the traffic" in found.help


def test_another_file_with_the_name_of_a_part(tmp_path):
    file = copied(tmp_path, TRAFFIC)
    shutil.copy(SINGLE, tmp_path / MAP.name)
    found = refused(file, beside=tmp_path / MAP.name)
    assert f"it is not the part that `{TRAFFIC.name}` refers to" in found.message


@pytest.mark.parametrize(
    "name", ["../DEU_EveryElement-1_1_T-1", "a\\b", "\0", "a\nb", "/etc/passwd"]
)
def test_a_part_is_never_sought_elsewhere(tmp_path, name):
    inner = tmp_path / "inner"
    inner.mkdir()
    for part in PARTS:
        shutil.copy(part, tmp_path)
    file = inner / PROBLEMS.name
    file.write_bytes(counted(1, counted(1, whole(1, 0))) + counted(4, name.encode()))
    assert "the name of another part of it is `" in refused(file).message


@pytest.mark.parametrize("command", ["verify", "maneuvers"])
def test_what_is_none_is_refused_in_one_sentence(command, tmp_path, capsys):
    file = tmp_path / "DEU_Road-1_1_T-1.pb"
    file.write_bytes(b"\x0a\x81\x01\x0a\x19\x0a\x03DEU\xcb\x0a\xe7\x0a")
    assert main([command, str(file), "-r", "de"]) == 2
    text = capsys.readouterr().err
    assert text.count("error[R0610]") == 1
    assert "at byte 0, a value begins that has more bytes than are left" in text


def test_a_net_is_not_for_these():
    with pytest.raises(RulecError) as caught:
        read_recording(TRAFFIC, MAP)
    assert caught.value.diagnostics[0].code == "R0613"


def point(number, x, y):
    return counted(number, double(1, x), double(2, y))


BEGIN = counted(1, counted(1, b"2020a"), counted(2, b"DEU_Road-1_1_T-1"), double(7, 0.1))
LEFT = counted(2, point(1, 0, 3), point(1, 50, 3))
RIGHT = counted(3, point(1, 0, 0), point(1, 50, 0))


def written(folder, *elements):
    """A single file with a lanelet that has some more elements."""
    file = folder / "DEU_Road-1_1_T-1.pb"
    file.write_bytes(BEGIN + counted(4, whole(1, 7), *elements))
    return file


def test_a_lanelet_by_hand(tmp_path):
    beside = whole(6, 8) + whole(8, 0) + whole(7, 9) + whole(9, 1)
    packed = counted(4, b"\1\2") + counted(11, b"\0\x0b")
    lanelet = read_recording(written(tmp_path, LEFT, RIGHT, beside, packed)).lanelets["7"]
    assert lanelet.left.tolist() == [[0, 3], [50, 3]]
    assert (lanelet.left_of, lanelet.right_of) == ("8", None)
    assert (lanelet.predecessors, lanelet.types) == (("1", "2"), {"urban", "sidewalk"})


def test_who_else_may_use_a_bus_lane(tmp_path):
    lanelet = written(tmp_path, LEFT, RIGHT, whole(11, 8), whole(12, 6), whole(13, 9))
    types = read_recording(lanelet).lanelets["7"].types
    assert types == {"busLane", "busesOnly", "cyclesAllowed", "taxisAllowed"}


@pytest.mark.parametrize(
    ("number", "mark"),
    [(0, "broken"), (1, "solid"), (2, None), (3, None), (5, None), (9, "solid"), (11, "none")],
)
def test_marks_that_two_releases_number_otherwise_are_unknown(tmp_path, number, mark):
    """Until 2023.3 a broad broken line had the number that a double solid one has since."""
    marked = counted(2, point(1, 0, 3), point(1, 50, 3), whole(2, number))
    assert read_recording(written(tmp_path, marked, RIGHT)).lanelets["7"].left_mark == mark


@pytest.mark.parametrize(
    ("elements", "why"),
    [
        ([LEFT], "the element `lanelet` has no `rightBound`"),
        (
            [LEFT, RIGHT, whole(11, 99)],
            "`laneletType` has the unknown value 99",
        ),
        ([LEFT, counted(3, point(1, 0, 0), point(1, 5e9, 0))], "`x` is `5000000000.0`"),
        ([LEFT, counted(3, point(1, 0, 0), point(1, float("nan"), 0))], "`x` is `nan`"),
        ([LEFT, counted(3, point(1, 0, 0))], "has fewer than 2 points"),
        ([LEFT, RIGHT, whole(1, 8)], "a message has a second field 1"),
    ],
)
def test_what_is_wrong_in_an_element_has_a_place(tmp_path, elements, why):
    found = refused(written(tmp_path, *elements))
    assert why in found.message
    assert "at byte " in found.message


@pytest.mark.parametrize(
    ("begin", "why"),
    [
        (BEGIN.replace(b"2020a", b"2031z"), "its `commonRoadVersion` is `2031z`"),
        (BEGIN.replace(b"2020a", b"hello"), "it does not begin like a scenario"),
        (counted(1, counted(1, b"2020a")), "has no `benchmarkID`"),
        (field(9, 5, b"\0\0\0\0"), "it does not begin like a scenario"),
    ],
)
def test_what_a_file_begins_with(tmp_path, begin, why):
    file = tmp_path / "DEU_Road-1_1_T-1.pb"
    file.write_bytes(begin)
    assert why in refused(file).message


def test_bounds_may_be_drawn_the_other_way_round(tmp_path):
    file = copied(tmp_path, TRAFFIC)
    bounds = [
        counted(5, whole(1, -1), point(2, 50, 3), point(2, 0, 3), whole(3, 1)),
        counted(5, whole(1, -2), point(2, 0, 0), point(2, 50, 0)),
    ]
    lanelet = counted(3, whole(1, 7), whole(2, -1), whole(3, -2), whole(4, 1), whole(5, 0))
    head = counted(1, counted(1, counted(1, b"DEU")))
    (tmp_path / MAP.name).write_bytes(head + lanelet + b"".join(bounds))
    found = read_recording(file).lanelets["7"]
    assert (found.left.tolist(), found.left_mark) == ([[0, 3], [50, 3]], "solid")
    assert (found.right.tolist(), found.right_mark) == ([[0, 0], [50, 0]], None)


def test_a_bound_that_the_map_has_not(tmp_path):
    file = copied(tmp_path, TRAFFIC)
    data = MAP.read_bytes()
    lanelet = counted(3, whole(1, 7), whole(2, 4711), whole(3, 4711))
    (tmp_path / MAP.name).write_bytes(data + lanelet)
    found = refused(file, beside=tmp_path / MAP.name)
    assert (
        f"at byte {len(data) + 5:,}, `leftBound` is 4711, which is not in the map" in found.message
    )


def test_bounds_of_too_many_lanelets(tmp_path, monkeypatch):
    """A large bound and many lanelets that refer to it would take all memory."""
    file = copied(tmp_path, TRAFFIC)
    points = b"".join(point(2, 0.1 * number, 3) for number in range(100))
    lanelets = [counted(3, whole(1, number), whole(2, 1), whole(3, 1)) for number in range(1, 50)]
    head = counted(1, counted(1, counted(1, b"DEU")))
    data = head + counted(5, whole(1, 1), points) + b"".join(lanelets)
    (tmp_path / MAP.name).write_bytes(data)
    assert len(read_recording(file).lanelets) == 49
    monkeypatch.setattr(commonroad_protobuf, "FEW_POINTS", 400)
    found = refused(file, beside=tmp_path / MAP.name)
    assert "bounds belong to more than 4 lanelets each" in found.message
