"""Maneuvers of a recorded scene, as the user meets them."""

import json

import pytest

from rulec.cli.main import main
from support.builders.recordings import ROAD_XML


@pytest.fixture
def road(tmp_path):
    file = tmp_path / "road.xml"
    file.write_text(ROAD_XML)
    return str(file)


@pytest.fixture
def answer(capfd, road):
    def run(*arguments, asked=()):
        status = main(["maneuvers", *asked, road, *arguments])
        captured = capfd.readouterr()
        return status, captured.out, captured.err

    return run


def test_text(answer):
    status, out, err = answer("-r", "esterle2019", "--bounds", "none")
    assert (status, err) == (0, "")
    assert out.splitlines()[:9] == [
        "scenario    road: 4 s in steps of 0.5 s, partition paper, adjacency touch",
        "obstacles   1 on the road of lanelet 1",
        "recorded    until 0 s; participants present then are assumed to keep their last",
        "            speed",
        "derived     CONGESTED = false: it takes 3 vehicles that go ego's way on its",
        "            road, here 1",
        "graph       18 nodes, 16 edges",
        "maneuvers   1 path through cells",
        "satisfying  1 by esterle2019 (R1, R2, R3)",
    ]


def test_json(answer):
    status, out, _ = answer("-r", "vienna", "--json")
    found = json.loads(out)
    scene = found["scene"]
    assert status == 0
    # What cells cannot tell is unknown, and no default but what is presumed
    assert set(found["by_default"]) <= {"told_to_stop", "told_to_go"}
    assert "speed" in found["unknown"]
    assert found["traces"] == sum(found[x] for x in ("satisfying", "violating", "open"))
    assert "junction_priority" in found["judged"]
    assert not set(found["judged"]) & {rule["rule"] for rule in found["not_judged"]}
    assert scene.pop("derived") == {}
    counted = {"reference": "1", "obstacles": 1, "left_out": 0, "recorded_until_s": 0.0}
    counted["mirrored"] = False
    assert scene == {**counted, "remarks": []}


def test_congestion_is_configurable(tmp_path, capsys):
    cars = "".join(
        ROAD_XML[ROAD_XML.index("  <obstacle") : ROAD_XML.index("  <planning")]
        .replace('"3"', f'"{n}"')
        .replace("<x>40<", f"<x>{n}<")
        for n in (30, 50, 70)
    )
    file = tmp_path / "full.xml"
    file.write_text(ROAD_XML.replace("  <planning", f"{cars}  <planning"))
    for below, expected in (("17", False), ("19", True)):  # they go 5 m/s, 18 km/h
        main(["maneuvers", str(file), "-r", "esterle2019", "--json", "--congested-below", below])
        scene = json.loads(capsys.readouterr().out)["scene"]
        assert scene["derived"]["CONGESTED"]["value"] is expected


def test_another_ego(answer):
    status, out, _ = answer("-r", "esterle2019", "--ego", "3", "--json")
    found = json.loads(out)
    assert (status, found["scene"]["obstacles"], found["nodes"]) == (0, 0, 9)


@pytest.mark.parametrize(
    "option",
    [["--ego", "7"], ["--at-time", "1"], ["--reference", "7"], ["--ego", "3", "--at-time", "1"]],
)
def test_what_is_not_there(answer, option):
    status, out, err = answer("-r", "esterle2019", *option)
    assert (status, out) == (2, "")
    assert "error[R0612]" in err
    assert "= help: " in err


def test_choices_are_refused_for_other_scenarios(capsys):
    assert main(["maneuvers", "s1", "-r", "esterle2019", "--prediction", "constant"]) == 2
    assert "error[R0613]" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("value", "message"),
    [
        ("constnat", "it has to be `recorded` or `constant`, or each of them once with a weight"),
        ("recorded=1,recorded=0.5", "or each of them once with a weight"),
        ("recorded=0.7,constant", "`constant` has to end in a weight above 0, such as `=0.7`"),
        ("recorded=0,constant=1", "`recorded=0` has to end in a weight above 0"),
        ("recorded=0.7,constant=0.2", "the weights have to add up to 1"),
    ],
)
def test_predictions_that_cannot_be(answer, value, message):
    status, out, err = answer("-r", "esterle2019", "--prediction", value)
    assert (status, out) == (2, "")
    assert message in err


def test_who_is_known_at_one_moment_has_one_prediction(answer):
    status, out, _ = answer(
        "-r", "esterle2019", "--prediction", "recorded=0.7,constant=0.3", "--json", "--worlds"
    )
    found = json.loads(out)
    assert (status, found["worlds"]) == (0, [])
    assert found["likeliest"] == 1


def test_the_step_gets_shorter_until_ego_has_room(tmp_path, capsys):
    """A car 3 m behind ego's centre at 10 m/s takes its place in 0.3 s: 0.5 s are too long."""
    file = tmp_path / "close.xml"
    text = ROAD_XML.replace("<x>40<", "<x>4<").replace(
        "<velocity><exact>5</exact></velocity>\n    </initialState>\n  </obstacle>",
        "<velocity><exact>10</exact></velocity>\n    </initialState>\n  </obstacle>",
    )
    file.write_text(text)
    assert main(["maneuvers", str(file), "-r", "esterle2019", "--json", "--bounds", "none"]) == 0
    assert json.loads(capsys.readouterr().out)["step_s"] == 0.25
    assert main(["maneuvers", str(file), "-r", "esterle2019", "--step", "0.5"]) == 2
    assert "a step of 0.25 s would do" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("types", "kind"),
    [
        ("type vehicle", "vehicle"),
        ("type vehicle\ntype car is vehicle", "car"),
        ("type road_user", "road_user"),
        ("type obstacle", "obstacle"),
    ],
)
def test_the_most_specific_type_that_a_rulebook_knows(answer, tmp_path, types, kind):
    book = tmp_path / "book.rules"
    book.write_text(
        f"rulebook book\n{types}\nposition(o: {kind}) is one of b, f, l, r\n"
        f"hard rule A (o: {kind}) {{ require always b(o) }}\n"
    )
    status, out, err = answer("-r", str(book), "--json", "--bounds", "none")
    assert (status, err) == (0, "")
    assert json.loads(out)["satisfying"] == 1


def test_what_a_rulebook_cannot_speak_of_is_in_the_way_all_the_same(answer, tmp_path):
    book = tmp_path / "book.rules"
    book.write_text(
        "rulebook book\ntype cat\nposition(o: cat) is one of b, f, l, r\n"
        "hard rule A (o: cat) { require always b(o) }\n"
    )
    status, out, err = answer("-r", str(book), "--json", "--bounds", "none")
    assert (status, err) == (0, "")
    assert json.loads(out)["nodes"] == 18


def test_signals_that_mean_something_else_are_left_out(answer, tmp_path):
    book = tmp_path / "book.rules"
    book.write_text(
        "rulebook book\nlanes is one of narrow, wide default wide\n"
        "quantity congested in m default 3\nhard rule A { require always "
        "(wide and congested > 2 m) }\n"
    )
    status, out, err = answer("-r", str(book), "--json", "--bounds", "none")
    assert (status, err) == (0, "")
    found = json.loads(out)
    assert (found["scene"]["derived"], found["by_default"]) == ({}, ["lanes", "congested"])


def test_traces_in_a_rulebooks_words_are_judged_by_it(answer, tmp_path, capfd):
    file = str(tmp_path / "t.jsonl")
    assert answer("-r", "esterle2019", "-o", file, asked=["--traces"])[0] == 0
    assert main(["verify", file, "-r", "esterle2019"]) == 0
    capfd.readouterr()
    (trace,) = map(json.loads, (tmp_path / "t.jsonl").read_text().splitlines())
    assert trace["objects"] == {"3": "vehicle"}
    assert set(trace["states"][0]) == {"position", "surface", "CONGESTED"}


def test_traces_without_one_have_all_that_is_known(answer):
    status, out, _ = answer("-o", "-", asked=["--traces"])
    trace = json.loads(out)
    assert (status, trace["objects"]) == (0, {"3": "car"})
    assert {"lanes", "two_wheeled"} < set(trace["states"][0])
