"""Data as SUMO writes them are read without a parser of XML, and hold what XML says they do."""

from pathlib import Path

import pytest

from rulec.diagnostics import RulecError
from rulec.recordings.sumo import plain_fcd
from rulec.recordings.sumo.fcd import read_fcd, read_fcd_as_xml
from rulec.recordings.sumo.plain_fcd import read_plain_fcd
from support.builders.sumo_files import SUMO

HEAD = """<?xml version="1.0" encoding="UTF-8"?>

<!-- generated
<configuration><net-file value="a.net.xml"/></configuration>
-->

<fcd-export xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance">
"""
CAR = '        <vehicle id="{}" x="{}" y="-4.80" angle="90.00" type="car" speed="9.25" pos="5.10" '
CAR += 'lane="{}" slope="0.00" acceleration="{}"/>\n'
WALKER = '        <person id="{}" x="{}" y="3.00" angle="0.00" speed="1.20" edge="{}"/>\n'


def step(time, *elements):
    return f'    <timestep time="{time}">\n{"".join(elements)}    </timestep>\n'


PLAIN = (
    HEAD
    + step("0.00", CAR.format("a", "5.10", "in_1", "0.00"), WALKER.format("w", "7", "in"))
    + '    <timestep time="0.10"/>\n'
    + step("0.20", CAR.format("b", "-1e2", "in_2", "-0.25"), CAR.format("a", "6", "out_1", "nan"))
    + step("0.30", WALKER.format("w", "8", ""), CAR.format("a", " 7.5", "in_1", "0.50"))
    + "</fcd-export>\n"
)


def content(read, path: Path):
    try:
        data = read(path)
    except RulecError as problem:
        return [str(x) for x in problem.diagnostics]
    return repr(data), list(data.tracks), list(data.on)


def written(folder: Path, text: str) -> Path:
    file = folder / "fcd.xml"
    file.write_bytes(text.encode())
    return file


@pytest.mark.parametrize("size", [1 << 18, 700, 350])
def test_plain_data(tmp_path, monkeypatch, size):
    monkeypatch.setattr(plain_fcd, "_BLOCK", size)
    file = written(tmp_path, PLAIN)
    plain = read_plain_fcd(file)
    assert plain is not None
    assert repr(plain) == repr(read_fcd_as_xml(file))
    assert plain.head.net == "a.net.xml"
    assert plain.moments == [0, 100_000, 200_000, 300_000]
    assert list(plain.tracks) == ["a", "w", "b"]
    assert list(plain.tracks["a"].moments) == [0, 2, 3]
    assert list(plain.tracks["b"].rows) == [-100.0, -4.8, 90.0, 9.25]
    assert list(plain.on) == ["in_1", "in", "in_2", "out_1"]
    assert plain.on["in_2"] == ("lane", PLAIN[: PLAIN.index('"in_2"')].count("\n") + 1)


def test_speeds_may_be_left_out(tmp_path):
    file = written(tmp_path, PLAIN.replace(' speed="9.25"', ""))
    plain = read_plain_fcd(file)
    assert plain is not None
    assert repr(plain) == repr(read_fcd_as_xml(file))
    assert list(map(repr, plain.tracks["b"].rows)) == ["-100.0", "-4.8", "90.0", "nan"]
    assert list(plain.tracks["w"].rows)[3] == 1.2


FIRST = CAR.format("a", "5.10", "in_1", "0.00")


@pytest.mark.parametrize(
    ("before", "after"),
    [
        ('id="a" x="6"', 'id="&#97;" x="6"'),
        ('id="b"', 'id="ä"'),
        ('id="b"', 'id="b>" rest=">"'),
        ('id="b"', 'id="w"'),
        ('id="b"', 'id="a"'),
        ('id="b"', 'id=""'),
        ('id="b"', f'id="{"b" * 201}"'),
        ('id="b"', 'id="b" id="c"'),
        ('id="b"', "id='b'"),
        ('id="b"', 'id="b<"'),
        ('id="b"', 'id="b\t"'),
        ('x="-1e2"', 'x="nan"'),
        ('x="-1e2"', 'x="1e9"'),
        ('x="-1e2" y="-4.80"', 'x="-1073741824" y="-1073741824"'),
        ('x="-1e2"', 'x="here"'),
        ('x="-1e2"', ""),
        ('acceleration="-0.25"', 'acceleration="1e9"'),
        ('acceleration="-0.25"', 'acceleration="much"'),
        ('acceleration="-0.25"', 'signals="8"'),
        ('acceleration="-0.25"', 'acceleration="-0.25" signals=""'),
        ('acceleration="-0.25"', 'acceleration="-0.25" signals="left"'),
        ('acceleration="-0.25"', 'acceleration="-0.25" signals="1e9"'),
        ('acceleration="-0.25"', 'acceleration="-0.25" vehicle="a"'),
        ('lane="in_2"', 'lane="" edge="in"'),
        (FIRST, FIRST.replace("/>", "></vehicle>")),
        (FIRST, FIRST.replace("/>", '><person id="p" x="1"/></vehicle>')),
        (FIRST, FIRST.replace("/>", '/><!-- "-->')),
        (FIRST, f"<!--\n{FIRST}-->\n"),
        (FIRST, f"{FIRST}\n"),
        (FIRST, FIRST.rstrip("\n")),
        (FIRST, ""),
        ('time="0.20"', 'time="0.05"'),
        ('time="0.20"', 'time="inf"'),
        ('time="0.20"', 'time="1e300"'),
        ('time="0.20"', 'time="soon"'),
        ('time="0.20"', 'time="0.20" n="1"'),
        ("    </timestep>\n", ""),
        ("    </timestep>\n", "    </timestep>\n" + FIRST),
        ("</fcd-export>\n", ""),
        ("</fcd-export>\n", "</fcd-export>"),
        ("</fcd-export>\n", "</fcd-export>\n<more/>\n"),
        ("</fcd-export>\n", "</fcd-export>\n</fcd-export>\n"),
        ("</fcd-export>\n", "</timestep>\n"),
        ("<fcd-export", "<!DOCTYPE fcd-export><fcd-export"),
        ("<fcd-export", "<fcd-export><a/"),
        ("<fcd-export", "<routes"),
        ('encoding="UTF-8"', 'encoding="UTF-16"'),
        ('encoding="UTF-8"', 'encoding="none"'),
        ("\n", "\r\n"),
        ("    <", "<"),
    ],
)
@pytest.mark.parametrize("size", [1 << 18, 350])
def test_what_else_xml_may_be(tmp_path, monkeypatch, before, after, size):
    """Whatever a file is, its content and what is wrong with it are what the parser says."""
    monkeypatch.setattr(plain_fcd, "_BLOCK", size)
    assert before in PLAIN
    file = written(tmp_path, PLAIN.replace(before, after))
    assert content(read_fcd, file) == content(read_fcd_as_xml, file)


@pytest.mark.parametrize("lamps", ["0", "2", "8.0"])
def test_lamps(tmp_path, lamps):
    told = f'acceleration="-0.25" signals="{lamps}"'
    file = written(tmp_path, PLAIN.replace('acceleration="-0.25"', told))
    plain = read_plain_fcd(file)
    assert plain is not None
    assert plain.tracks["b"].lamps == {2: int(float(lamps))}
    assert not plain.tracks["a"].lamps
    assert repr(plain) == repr(read_fcd_as_xml(file))


def test_no_file_is_plain(tmp_path):
    assert read_plain_fcd(tmp_path / "none.xml") is None
    assert read_plain_fcd(written(tmp_path, "")) is None


@pytest.mark.skipif(not SUMO.is_dir(), reason="needs the recordings")
def test_data_of_a_simulation():
    file = SUMO / "fcd.xml.gz"
    plain = read_plain_fcd(file)
    assert plain is not None
    assert content(lambda _: plain, file) == content(read_fcd_as_xml, file)
