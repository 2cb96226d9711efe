"""What is wrong with SUMO's files is said in a sentence; no file ends in a traceback."""

import gzip

import pytest

from rulec import read_recording
from rulec.diagnostics import RulecError
from rulec.recordings.encodings import safe_xml
from rulec.recordings.encodings.file_format import XmlFormat
from rulec.scenario import Choice, load_scenario
from support.builders.sumo_files import ROAD_NET, TYPES, body, data, moment, written

GOOD = data(moment(0, body(lane="in_1")), moment(0.1, body(x=21, lane="in_1")))


def problem_with(file, net=None):
    with pytest.raises(RulecError) as caught:
        read_recording(file, net)
    (found,) = caught.value.diagnostics
    assert "\n" not in found.message
    assert found.help
    return found


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        ("<fcd-export>", "<!DOCTYPE a><fcd-export>", "it has a `DOCTYPE`"),
        (GOOD, "<fcd-export/>", "it contains no road users"),
        (GOOD, data(moment(0), moment(1)), "it contains no road users"),
        ("</fcd-export>", "", "it has been cut short"),
        ('time="0.10"', "", "the element `timestep` has no `time`"),
        ('time="0.10"', 'time="soon"', "`time` of a `timestep` is `soon`"),
        ('time="0.10"', 'time="0.00"', "not in ascending order"),
        ('time="0.10"', 'time="1e300"', "`time` of a `timestep` is `1e300`"),
        ('id="f.0" x="21"', 'x="21"', "the element `vehicle` has no `id`"),
        ('id="f.0" x="21"', 'id="" x="21"', "the id of a `vehicle` is empty"),
        ('id="f.0" x="21"', f'id="{"f" * 300}" x="21"', "longer than 200"),
        ('x="21"', "", "the element `vehicle` has no `x`"),
        ('x="21"', 'x="nan"', "`x` of a `vehicle` is `nan`"),
        ('x="21"', 'x="-inf"', "`x` of a `vehicle` is `-inf`"),
        ('x="21"', 'x="1e9"', "`x` of a `vehicle` is `1e9`"),
        ('x="21" y="-4.8"', 'x="21" y="nan"', "`y` of a `vehicle` is `nan`"),
        ('x="21"', 'x="here"', "`x` of a `vehicle` is `here`"),
        ('x="21"', 'x="2_1"', "`x` of a `vehicle` is `2_1`"),
        ('x="21"', 'x="２１"', "`x` of a `vehicle` is `２１`"),
        ('time="0.10"', 'time="0_0.10"', "`time` of a `timestep` is `0_0.10`"),
        ('angle="90.0" ', "", "the element `vehicle` has no `angle`"),
        ('lane="in_1"', 'acceleration="much" lane="in_1"', "`acceleration` of a `vehicle` is"),
        ('lane="in_1"', 'signals="left" lane="in_1"', "`signals` of a `vehicle` is `left`"),
        ("<fcd-export>", f"<fcd-export>{body()}", "a `vehicle` is in no `timestep`"),
        ("</timestep>", f"{body()}</timestep>", "`f.0` is twice in one time step"),
    ],
)
def test_data(tmp_path, before, after, says):
    assert before in GOOD
    found = problem_with(written(tmp_path, GOOD.replace(before, after)))
    assert found.code == "R0610"
    assert "cannot be read as SUMO's floating-car data" in found.message
    assert says in found.message


def test_uneven_times(tmp_path):
    found = problem_with(
        written(tmp_path, data(*(moment(time, body()) for time in (0, 0.1, 0.25, 0.4))))
    )
    assert "0.25 s is not a multiple of 0.1 s" in found.message


def test_a_time_that_is_a_slip(tmp_path):
    """It would make room for a billion states that nobody is in."""
    found = problem_with(written(tmp_path, data(*(moment(t, body()) for t in (0, 0.1, 9e7)))))
    assert "its 3 time steps of 0.1 s are spread over 9e+07 s" in found.message


@pytest.mark.parametrize(
    ("before", "after", "says"),
    [
        ("<net ", "<roads ", "of `roads`, not of `net`"),
        (ROAD_NET, '<routes version="1"/>', "of `routes`, not of `net`"),
        (ROAD_NET, "<net/>", "it has no lane"),
        (ROAD_NET, '<net><lane id="a"/></net>', "a `lane` is in no `edge`"),
        ('shape="0.00,-4.80 200.00,-4.80"', "", "the element `lane` has no `shape`"),
        ('shape="0.00,-4.80 ', 'shape="0.00 ', "has no x and y"),
        ('shape="0.00,-4.80 ', 'shape="0.00,nan ', "`shape` of a `lane` is `nan`"),
        ('shape="0.00,-4.80 ', 'shape="1e300,0 ', "`shape` of a `lane` is `1e300`"),
        ('shape="0.00,-4.80 ', 'shape="-9e6,-4.80 ', "a lane is longer than 20 km"),
        ('width="2.00"', 'width="-2"', "`width` of a `lane` is -2"),
        ('width="2.00"', 'width="2000"', "a lane is 2000 m wide"),
        ('speed="13.89"', 'speed="0"', "`speed` of a `lane` is 0"),
        ('id="in_2"', 'id="in_1"', "there are two lanes `in_1`"),
        ('index="2"', 'index="left"', "`index` of a `lane` is `left`"),
        ('toLane="1"', "", "the element `connection` has no `toLane`"),
    ],
)
def test_net(tmp_path, before, after, says):
    assert before in ROAD_NET
    found = problem_with(written(tmp_path, GOOD, net=ROAD_NET.replace(before, after)))
    assert (found.code, found.place.file) == ("R0610", str(tmp_path / "road.net.xml"))
    assert "cannot be read as a SUMO net" in found.message
    assert says in found.message


def test_a_name_is_said_in_few_letters(tmp_path):
    long = "in_" + "9" * 5000
    net = ROAD_NET.replace('"in_1"', f'"{long}"').replace('"in_2"', f'"{long}"')
    found = problem_with(written(tmp_path, GOOD, net=net))
    assert "there are two lanes `in_999" in found.message
    assert len(found.message) < 200


def test_types(tmp_path):
    types = TYPES.replace('length="10.0"', 'length="long"')
    found = problem_with(written(tmp_path, GOOD, types=types))
    assert (found.code, found.place.line) == ("R0610", 3)
    assert "`length` of a `vType` is `long`" in found.message


def test_no_net_and_several(tmp_path):
    file = written(tmp_path, GOOD, net=None)
    found = problem_with(file)
    assert (found.code, "no net beside it" in found.message) == ("R0614", True)
    for name in "ab":
        (tmp_path / f"{name}.net.xml").write_text(ROAD_NET, encoding="utf-8")
    assert "several nets beside it: `a.net.xml`, `b.net.xml`" in problem_with(file).message
    assert read_recording(file, tmp_path / "a.net.xml").lanelets


def test_the_net_that_the_data_name(tmp_path):
    """By its name alone, wherever it was when the data were made."""
    head = '<net-file value="/elsewhere/b.net.xml"/>'
    file = written(tmp_path, GOOD.replace("<sumoConfiguration>", f"<sumoConfiguration>{head}"))
    (tmp_path / "b.net.xml").write_text("<net/>", encoding="utf-8")
    assert problem_with(file).place.file == str(tmp_path / "b.net.xml")
    for name in ("b.net.xml", "road.net.xml"):
        (tmp_path / name).unlink()
    found = problem_with(file)
    assert (found.code, "`b.net.xml`" in found.message) == ("R0614", True)


@pytest.mark.parametrize(
    ("fcd", "says"),
    [
        (GOOD.replace('"in_1"', '"in_7"'), "on lane `in_7`"),
        (GOOD.replace('lane="in_1"', 'edge="elsewhere"'), "on edge `elsewhere`"),
        (data(moment(0, body(x=48.1, y=5000.0))), "far from all roads"),
    ],
)
def test_another_roads_net(tmp_path, fcd, says):
    found = problem_with(written(tmp_path, fcd))
    assert (found.code, says in found.message) == ("R0615", True)


@pytest.mark.parametrize("word", ["true", "1", "Yes", "on", "x", "T"])
def test_degrees_of_longitude_and_latitude(tmp_path, word):
    """SUMO has several words for true."""
    head = f'<fcd-output.geo value="{word}"/>'
    found = problem_with(written(tmp_path, data(moment(0, body()), head=head)))
    assert "degrees of longitude and latitude" in found.message
    assert "--fcd-output.geo" in found.help


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "it is empty"),
        (b"\n\n", "not well-formed XML: no element found"),
        (b"what a day", "not well-formed XML"),
        (b"\x00\x01\x02", "not well-formed XML"),
        (b'<?xml version="1.0" encoding="klingon"?><fcd-export/>', "its encoding"),
        (b'<?xml version="1.0" encoding="utf-7"?><fcd-export/>', "its encoding"),
        (b"<fcd-export>\xff</fcd-export>", "not well-formed XML"),
        (b"<kml/>", "it is XML of `kml`"),
        (b"PK\x03\x04\x14\0", "it is a ZIP archive"),
        (b"version https://git-lfs.github.com/spec/v1\noid sha256:1\n", "a Git LFS pointer"),
        (b"<net/>", "it is a map (nets of SUMO's), with nobody on its roads"),
        (gzip.compress(b"", mtime=0), "it is empty"),
    ],
)
def test_files_that_are_something_else(tmp_path, content, says):
    file = written(tmp_path, GOOD)
    file.write_bytes(content)
    found = problem_with(file)
    assert (found.code, found.place.file) == ("R0610", str(file))
    assert says in found.message


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (gzip.compress(GOOD.encode(), mtime=0)[:-40], "it is packed, and ends too soon"),
        (gzip.compress(GOOD.encode(), mtime=0)[:10] + b"abcdefgh" * 9, "it is packed, and damaged"),
    ],
)
def test_packed_files_that_are_broken(tmp_path, content, says):
    file = written(tmp_path, GOOD)
    file.write_bytes(content)
    found = problem_with(file)
    assert (found.code, found.place.file) == ("R0701", str(file))
    assert says in found.message


def test_packed_and_in_other_encodings(tmp_path):
    file = written(tmp_path, GOOD)
    (plain,) = (one.states for one in read_recording(file).participants)
    file.write_bytes(gzip.compress(GOOD.encode()))
    assert read_recording(file).participants[0].states == plain
    file.write_bytes(f'<?xml version="1.0" encoding="utf-16"?>{GOOD}'.encode("utf-16"))
    assert read_recording(file).participants[0].states == plain


def test_a_little_file_that_unpacks_to_a_huge_one(tmp_path):
    file = written(tmp_path, GOOD)
    huge = b"<fcd-export><timestep " + b" " * 5_000_000 + b"/></fcd-export>"
    file.write_bytes(gzip.compress(huge))
    assert "a tag of more than 1,000,000 bytes" in problem_with(file).message
    file.write_bytes(gzip.compress(b" " * 5_000_000))
    assert "nothing begins in its first" in problem_with(file).message


def test_too_much_is_not_read(tmp_path, monkeypatch):
    monkeypatch.setattr(safe_xml, "_BLOCK", 100)
    from rulec.recordings.sumo import fcd

    monkeypatch.setattr(fcd, "FCD", XmlFormat("data", "less", 300, root="fcd-export"))
    assert "too large: at most 300 bytes" in problem_with(written(tmp_path, GOOD)).message


def test_a_net_is_for_sumo(tmp_path):
    file = written(tmp_path, "<commonRoad/>")
    assert problem_with(file, tmp_path / "road.net.xml").code == "R0613"
    with pytest.raises(RulecError) as caught:
        load_scenario("s1", Choice(map_path=tmp_path / "road.net.xml"))
    assert [x.code for x in caught.value.diagnostics] == ["R0613"]
