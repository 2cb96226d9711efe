"""Floating-car data as tables say what they say as XML."""

import csv
import io
from xml.etree import ElementTree

import pyarrow
import pyarrow.parquet
import pytest

from rulec.diagnostics import RulecError
from rulec.recordings.recording_files import is_recording
from rulec.recordings.sumo.fcd import read_fcd

DATA = """<fcd-export>
<timestep time="1.00">
<vehicle id="a" x="1.00" y="2.00" angle="90.00" type="car" speed="3.00" lane="e_0" signals="8"/>
</timestep>
<timestep time="1.50">
<person id="p" x="5.25" y="-1.00" angle="0.00" type="ped" speed="1.00" edge="e"/>
<vehicle id="a" x="2.50" y="2.00" angle="90.00" type="car" speed="3.00" lane="e_0" signals="0"/>
<vehicle id="gone" x="-1073741824.00" y="-1073741824.00" angle="0" type="car" speed="0" lane=""/>
</timestep>
</fcd-export>
"""
NAMES = ("id", "x", "y", "angle", "type", "speed", "lane", "edge", "signals")


def rows(element_in_names=False):
    """Rows as SUMO writes them, or, with the elements in the columns' names, as xml2csv.py."""
    found = []
    for moment in ElementTree.fromstring(DATA):
        for body in moment:
            kind = body.tag if element_in_names else "vehicle"
            said = {f"{kind}_{name}": body.get(name, "") for name in NAMES}
            found.append({"timestep_time": moment.get("time"), **said})
    return found


def as_csv(path, lines):
    names = list(dict.fromkeys(name for line in lines for name in line))
    text = io.StringIO()
    table = csv.DictWriter(text, names, delimiter=";", restval="")
    table.writeheader()
    table.writerows(lines)
    path.write_text(text.getvalue(), encoding="utf-8")
    return path


def as_parquet(path, lines):
    texts = ("id", "type", "lane", "edge")
    columns = {
        name: [
            value if name.endswith(texts) else float(value) if value else None
            for value in (line[name] for line in lines)
        ]
        for name in lines[0]
    }
    pyarrow.parquet.write_table(pyarrow.table(columns), path)
    return path


@pytest.mark.parametrize(
    ("write", "as_xml2csv"), [(as_csv, False), (as_csv, True), (as_parquet, False)]
)
def test_the_same_as_in_xml(tmp_path, write, as_xml2csv):
    (tmp_path / "fcd.xml").write_text(DATA, encoding="utf-8")
    path = write(tmp_path / f"fcd.{write.__name__[3:]}", rows(as_xml2csv))
    assert is_recording(str(path))
    found, expected = read_fcd(path), read_fcd(tmp_path / "fcd.xml")
    assert found.moments == expected.moments == [1_000_000, 1_500_000]
    assert found.tracks.keys() == expected.tracks.keys() == {"a", "p"}
    for key, track in expected.tracks.items():
        own = found.tracks[key]
        assert (own.element, own.type, own.lamps) == (track.element, track.type, track.lamps)
        assert (own.moments, own.rows) == (track.moments, track.rows)
    assert {name: what for name, (what, _) in found.on.items()} == {"e_0": "lane", "e": "edge"}


@pytest.mark.parametrize("write", [as_csv, as_parquet])
def test_speeds_may_be_left_out(tmp_path, write):
    lines = [{name: x for name, x in row.items() if name != "vehicle_speed"} for row in rows()]
    found = read_fcd(write(tmp_path / f"fcd.{write.__name__[3:]}", lines))
    assert [repr(own.rows[3]) for own in found.tracks.values()] == ["nan", "nan"]
    lines = rows()
    lines[0]["vehicle_speed"] = ""
    found = read_fcd(write(tmp_path / f"some.{write.__name__[3:]}", lines))
    assert [repr(x) for x in found.tracks["a"].rows[3::4]] == ["nan", "3.0"]


@pytest.mark.parametrize(
    ("change", "line", "said"),
    [
        ({"vehicle_x": ""}, 3, "its column `vehicle_x` holds no number"),
        ({"timestep_time": ""}, 3, "its column `timestep_time` is empty here"),
        ({"timestep_time": "1.00", "vehicle_id": "a"}, 3, "`a` is twice in one time step"),
        ({"vehicle_id": "p" * 201}, 3, "an id is longer than 200 characters"),
    ],
)
def test_what_is_wrong_has_its_line(tmp_path, change, line, said):
    lines = rows()
    lines[1] |= change
    with pytest.raises(RulecError) as refused:
        read_fcd(as_csv(tmp_path / "fcd.csv", lines))
    (found,) = refused.value.diagnostics
    assert found.message == f"the file cannot be read as SUMO's floating-car data: {said}"
    assert found.place.line == line


def test_a_column_that_is_not_there(tmp_path):
    lines = [
        {name: value for name, value in line.items() if "angle" not in name} for line in rows()
    ]
    with pytest.raises(RulecError, match="it has no column `vehicle_angle`"):
        read_fcd(as_csv(tmp_path / "fcd.csv", lines))
