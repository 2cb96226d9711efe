"""What floating-car data hold, as SUMO writes them and as XML allows."""

from pathlib import Path

import pytest

from rulec.diagnostics import RulecError
from rulec.recordings.sumo.fcd import read_fcd

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


def written(folder: Path, text: str) -> Path:
    file = folder / "fcd.xml"
    file.write_bytes(text.encode())
    return file


def test_data_as_sumo_writes_them(tmp_path):
    data = read_fcd(written(tmp_path, PLAIN))
    assert data.head.net == "a.net.xml"
    assert data.moments == [0, 100_000, 200_000, 300_000]
    assert list(data.tracks) == ["a", "w", "b"]
    assert list(data.tracks["a"].moments) == [0, 2, 3]
    assert list(data.tracks["b"].rows) == [-100.0, -4.8, 90.0, 9.25]
    assert list(data.on) == ["in_1", "in", "in_2", "out_1"]
    assert data.on["in_2"] == ("lane", PLAIN[: PLAIN.index('"in_2"')].count("\n") + 1)


def test_speeds_may_be_left_out(tmp_path):
    data = read_fcd(written(tmp_path, PLAIN.replace(' speed="9.25"', "")))
    assert list(map(repr, data.tracks["b"].rows)) == ["-100.0", "-4.8", "90.0", "nan"]
    assert list(data.tracks["w"].rows)[3] == 1.2


@pytest.mark.parametrize(
    ("before", "after", "rows"),
    [
        ('x="-1e2" y="-4.80"', 'x="-1073741824" y="-1073741824"', None),
        ('acceleration="-0.25"', 'acceleration="-0.25" vehicle="a"', None),
        ('acceleration="-0.25"/>', '><person id="p" x="1"/></vehicle>', [-100.0, -4.8, 90.0, 9.25]),
        ('x="-1e2"', 'x="\u00a0-1e2"', [-100.0, -4.8, 90.0, 9.25]),
    ],
)
def test_who_is_there(tmp_path, before, after, rows):
    """Nobody is who has no place, or rides in another one; blanks around numbers are none."""
    assert before in PLAIN
    track = read_fcd(written(tmp_path, PLAIN.replace(before, after))).tracks.get("b")
    assert (None if track is None else list(track.rows)) == rows


@pytest.mark.parametrize("number", ["1_0", "\u0661", "here", ""])
def test_what_is_no_number(tmp_path, number):
    with pytest.raises(
        RulecError, match=r"`x` of a `vehicle` is|the element `vehicle` has no `x`"
    ) as caught:
        read_fcd(written(tmp_path, PLAIN.replace('x="-1e2"', f'x="{number}"')))
    line = PLAIN[: PLAIN.index('x="-1e2"')].count("\n") + 1
    assert caught.value.diagnostics[0].place.line == line


@pytest.mark.parametrize("lamps", ["0", "2", "8.0"])
def test_lamps(tmp_path, lamps):
    told = f'acceleration="-0.25" signals="{lamps}"'
    data = read_fcd(written(tmp_path, PLAIN.replace('acceleration="-0.25"', told)))
    assert data.tracks["b"].lamps == {2: int(float(lamps))}
    assert not data.tracks["a"].lamps
