"""SUMO's data as the user gives them: every verb that takes recorded traffic takes their net."""

import json

import pytest

from rulec.cli.main import main
from support.builders.sumo_files import ROAD_NET, body, data, moment, written

DRIVE = data(*(moment(k / 2, body(x=20 + 5 * k, lane="in_1")) for k in range(12)))


@pytest.fixture
def files(tmp_path):
    """The data, and in another folder the net."""
    written(tmp_path, DRIVE, net=None, types=None)
    net = tmp_path / "nets" / "road.net.xml"
    net.parent.mkdir()
    net.write_text(ROAD_NET, encoding="utf-8")
    return str(tmp_path / "fcd.xml"), str(net)


@pytest.mark.parametrize(
    "words",
    [
        ["maneuvers", "FILE", "-r", "esterle2019", "--ego", "f.0"],
        ["maneuvers", "--envelopes", "FILE", "-r", "esterle2019", "--ego", "f.0", "-o", "OUT.csv"],
        ["maneuvers", "--traces", "FILE", "--ego", "f.0", "-o", "OUT.jsonl"],
        ["draw", "scene", "FILE", "--ego", "f.0", "-o", "OUT.svg"],
        ["verify", "FILE", "-r", "gb", "--ego", "f.0"],
    ],
    ids=lambda words: words[0],
)
def test_every_verb_takes_the_net(files, tmp_path, capfd, words):
    file, net = files
    words = [
        file if word == "FILE" else word.replace("OUT", str(tmp_path / "out")) for word in words
    ]
    assert main(words) == 2
    assert "[R0614]" in capfd.readouterr().err
    assert main([*words, "--map", net]) == 0, capfd.readouterr().err
    assert capfd.readouterr().err == ""


def test_what_the_file_leaves_open_is_said(files, capfd):
    file, net = files
    words = ["maneuvers", file, "-r", "esterle2019", "--map", net, "--ego", "f.0"]
    assert main(words) == 0
    said = "note        types that no file describes get default values: `small` (car, 5 m)"
    assert said in capfd.readouterr().out
    assert main([*words, "--json"]) == 0
    scene = json.loads(capfd.readouterr().out)["scene"]
    assert scene["reference"] == "in_1"
    assert [said.partition("note        ")[2]] == scene["remarks"]
    assert main(["verify", file, "-r", "gb", "--map", net]) == 0
    assert f"note: {scene['remarks'][0]}" in capfd.readouterr().out
    assert main(["verify", file, "-r", "gb", "--map", net, "--json"]) == 0
    assert json.loads(capfd.readouterr().out)["remarks"] == scene["remarks"]


def test_who_can_be_ego_is_said(files, capfd):
    file, net = files
    assert main(["maneuvers", file, "-r", "esterle2019", "--map", net]) == 2
    error = capfd.readouterr().err
    assert "[R0612]" in error
    assert "--ego: `f.0`" in error


def test_a_net_without_recorded_traffic(tmp_path, files, capfd):
    traces = tmp_path / "traces.jsonl"
    traces.write_text("", encoding="utf-8")
    assert main(["verify", str(traces), "-r", "gb", "--map", files[1]]) == 2
    said = capfd.readouterr().err
    assert "--map is for recorded traffic, and no file looks like it; add `--input" in said


def test_the_net_alone(files, capfd):
    assert main(["verify", files[1], "-r", "gb"]) == 2
    assert "it is a map (nets of SUMO's), with nobody on its roads" in capfd.readouterr().err


def test_what_a_file_is_tells_its_content(files, tmp_path, capfd):
    """Whatever it is called."""
    _, net = files
    other = tmp_path / "recording.dat"
    other.write_text("\n" + DRIVE, encoding="utf-8")
    assert main(["verify", str(other), "-r", "gb", "--map", net]) == 0
    assert "recording: 1 drive" in capfd.readouterr().out
