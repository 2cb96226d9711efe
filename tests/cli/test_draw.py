"""``rulec draw`` as its user meets it."""

import xml.etree.ElementTree as ET

import pytest

from rulec.cli.main import main

RULES = ("-r", "esterle2019")


def draw(capfd, *arguments):
    status = main(["draw", *map(str, arguments)])
    out, err = capfd.readouterr()
    return status, out, err


def texts(file):
    return [one.text for one in ET.parse(file).iter("{http://www.w3.org/2000/svg}text")]


def test_a_scene(tmp_path, capfd):
    file = tmp_path / "s2.svg"
    assert draw(capfd, "scene", "s2", *RULES, "-o", file) == (0, f"wrote {file}\n", "")
    found = texts(file)
    assert found[0] == "s2: maneuver 1 of 83 that satisfy esterle2019; cost 0 1/s"
    assert [one for one in found if one.endswith(" s")] == [f"{n} s to {n + 1} s" for n in range(5)]


@pytest.mark.parametrize("requires", ["CONGESTED", "(CONGESTED or b(v)) and not f(v)"])
def test_a_maneuver_of_which_a_rule_is_open_may_satisfy(requires, tmp_path, capfd):
    """Nobody says whether it is congested: that alone judges nothing."""
    source = tmp_path / "near.rules"
    rule = f"hard rule A (v: vehicle) {{ require always ({requires}) }}"
    source.write_text(f"rulebook near\nuse paper\n{rule}\n")
    file = tmp_path / "s2.svg"
    assert draw(capfd, "scene", "s2", "-r", source, "--told-only", "-o", file)[0] == 0
    assert " that may satisfy near; cost 0 1/s" in texts(file)[0]


def test_a_scene_without_rules_shows_no_maneuver(tmp_path, capfd):
    file = tmp_path / "s2.svg"
    assert draw(capfd, "scene", "s2", "--layer", 4, "--layer", 1, "-o", file)[0] == 0
    found = texts(file)
    assert found[0] == "s2: 35 cells in 5 layers"
    assert [one for one in found if " s to " in one] == ["1 s to 2 s", "4 s to 5 s"]
    assert "the maneuver's cell" not in found


def test_a_graph(tmp_path, capfd):
    file = tmp_path / "s2.svg"
    assert draw(capfd, "graph", "s2", *RULES, "-o", file)[0] == 0
    assert texts(file)[0] == (
        "s2: 35 nodes, 124 edges, 139 maneuvers, 83 satisfying by esterle2019"
    )
    assert draw(capfd, "graph", "s2", "-o", file)[0] == 0
    assert texts(file)[0] == "s2: 35 nodes, 124 edges, 139 maneuvers"


def test_a_scene_that_no_maneuver_satisfies(tmp_path, capfd):
    source = tmp_path / "stop.rules"
    source.write_text("rulebook stop\nuse paper\nhard rule A (v: vehicle) { require l(v) }\n")
    file = tmp_path / "s2.svg"
    assert draw(capfd, "scene", "s2", "-r", source, "-o", file)[0] == 0
    assert texts(file)[0] == "s2: no maneuver satisfies stop"
    assert draw(capfd, "graph", "s2", "-r", source, "-o", file)[0] == 0
    assert "0 steps of satisfying maneuvers" in texts(file)


def test_a_trace_by_its_id(tmp_path, capfd):
    file = tmp_path / "t.svg"
    traces = "docs/samples/traces.jsonl"
    assert draw(capfd, "trace", traces, *RULES, "-o", file)[0] == 0
    assert texts(file)[0] == "t1: 1 violation by esterle2019"
    assert draw(capfd, "trace", traces, *RULES, "--trace", "t2", "-o", file)[0] == 0
    assert texts(file)[0] == "t2: no violation by esterle2019"


def test_a_part_of_a_trace(tmp_path, capfd):
    """t1 passes v1 on the right, which R1 forbids; there is nobody else."""
    file = tmp_path / "t.svg"
    draw_trace = ("trace", "docs/samples/traces.jsonl", *RULES, "-o", file)
    assert draw(capfd, *draw_trace)[0] == 0
    assert {"CONGESTED", "position(v1)"} <= set(texts(file))
    assert draw(capfd, *draw_trace, "--rule", "R[12]", "--object", "v1")[0] == 0
    assert texts(file)[0] == "t1: 1 violation by esterle2019, only R[12], v1"
    assert draw(capfd, *draw_trace, "--rule", "R3")[0] == 0
    assert texts(file)[0] == "t1: no violation by esterle2019, only R3"
    assert "CONGESTED" not in texts(file)


PASSING = ("docs/samples/passing.fcd.xml", "--map", "docs/samples/passing.net.xml", "-r", "de")


def test_all_rows_of_a_trace(tmp_path, capfd):
    file = tmp_path / "t.svg"
    draw_trace = ("trace", "docs/samples/traces.jsonl", *RULES, "-o", file)
    draw(capfd, *draw_trace)
    assert "surface" not in texts(file)
    assert "without 1 row that no violated rule reads" in texts(file)
    draw(capfd, *draw_trace, "--all")
    assert "surface" in texts(file)


def test_a_drive(tmp_path, capfd):
    file = tmp_path / "d.svg"
    assert draw(capfd, "drive", *PASSING, "-o", file) == (0, f"wrote {file}\n", "")
    found = texts(file)
    assert found[0].startswith("passing, ")
    assert "10 m" in found
    assert any(one.startswith("cannot be judged from this recording: ") for one in found)
    assert draw(capfd, "drive", *PASSING, "--ego", "g.0", "--at-time", 4, "-o", file)[0] == 0
    assert texts(file)[0].startswith("passing, g.0: ")
    assert texts(file)[1] == "4 s"
    dark = ("--theme", "dark", "--format", "html")
    status, out, _ = draw(capfd, "drive", *PASSING, *dark, "-o", "-")
    assert status == 0
    assert out.startswith('<!DOCTYPE html>\n<html lang="en" data-theme="dark">')


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (("--ego", "h.0"), "there is no vehicle `h.0` that drives"),
        (("--ego", "f.0#2"), "there is no drive `f.0#2`"),
        (("--rule", "parking_*"), "de has no rule like `parking_*`"),
        (("--theme", "blue"), "--theme: there is no `blue`; it is one of auto, light, dark"),
    ],
)
def test_a_drive_that_cannot_be_drawn(arguments, message, tmp_path, capfd):
    status, _, err = draw(capfd, "drive", *PASSING, *arguments, "-o", tmp_path / "d.svg")
    assert status == 2
    assert message in err


def test_to_standard_output(capfd):
    status, out, err = draw(capfd, "scene", "s1", "--layer", 0, "-o", "-")
    assert (status, err) == (0, "")
    assert out.startswith("<svg ")
    assert out.endswith("</svg>\n")
    assert draw(capfd, "scene", "s1", "-o", "-", "--format", "html")[1].startswith("<!DOCTYPE")


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        (["scene", "s2", "--maneuver", 1], "`--maneuver` takes a rulebook"),
        (["scene", "s2", *RULES, "--maneuver", 84], "There is no maneuver 84: 83 satisfy"),
        (["scene", "s2", "--layer", 5], "There is no layer 5; they are 0 to 4."),
        (
            ["trace", "docs/samples/traces.jsonl", *RULES, "--trace", "t9"],
            "`docs/samples/traces.jsonl` has no trace `t9`; it has `t1`, `t2`.",
        ),
        (
            ["trace", "docs/samples/traces.jsonl", *RULES, "--object", "v7"],
            "trace `t1` has no object `v7`; it has `v1`.",
        ),
        (
            ["trace", "docs/samples/traces.jsonl", *RULES, "--rule", "S*"],
            "esterle2019 has no rule like `S*`",
        ),
        (["trace", "/dev/null", *RULES], "there is no trace in this file"),
    ],
)
def test_what_cannot_be_drawn(arguments, message, tmp_path, capfd):
    file = tmp_path / "none.svg"
    status, out, err = draw(capfd, *arguments, "-o", file)
    assert (status, out) == (2, "")
    assert message in err
    assert not file.exists()


def test_nothing_is_left_behind_if_it_cannot_be_written(tmp_path, capfd):
    status, _, err = draw(capfd, "scene", "s2", "-o", tmp_path / "no" / "s2.svg")
    assert (status, "R0702" in err) == (2, True)
    assert list(tmp_path.iterdir()) == []
