"""The reason for which there is no maneuver at all."""

import json
import re
from pathlib import Path

import pytest

from rulec.cli.main import main
from support.unwrapped import unwrapped

FOLLOWING = str(Path(__file__).resolve().parents[2] / "docs/samples/following.xml")

ROAD = """
horizon_s = 4
step_s = 1
[road]
s = [0, 60]
lanes = [-2, 2]
[ego]
s = 30
d = 0
"""
CAR = """
[[obstacle]]
id = "{name}"
type = "vehicle"
length = 4
width = 2
s = {s}
d = 0
speed = {speed}
"""


def answered(tmp_path, capsys, *cars, step="1"):
    file = tmp_path / "narrow.toml"
    file.write_text(ROAD + "".join(CAR.format(name=n, s=s, speed=v) for n, s, v in cars))
    status = main(["maneuvers", str(file), "-r", "esterle2019", "--step", step])
    return status, capsys.readouterr().out


def test_others_sweep_all_the_room(tmp_path, capsys):
    # One comes from behind at 12 m/s, one from ahead: they meet where ego is after 2.2 s
    status, text = answered(tmp_path, capsys, ("1", 2, 12), ("2", 58, -12))
    assert status == 1
    assert "none leads on from between 1 s and 2 s\n" in text
    assert "closed by   1, 2: in steps of 1 s they sweep its lanes" in text
    # They drive through each other, at any step; but they are 2 m wide, and the lane 4 m.
    assert "opened by   `--extent body`\n" in text


def test_one_alone_sweeps_all_the_room(tmp_path, capsys):
    """It is as long as the road, and comes from ahead: between 1 and 2 s it is everywhere."""
    file = tmp_path / "narrow.toml"
    file.write_text(ROAD + CAR.format(name="1", s=145, speed=-60).replace("= 4", "= 80"))
    assert main(["maneuvers", str(file), "-r", "esterle2019", "--step", "1"]) == 1
    assert "closed by   1: in steps of 1 s it sweeps its lanes" in capsys.readouterr().out


def test_nothing_is_said_where_there_is_a_way(tmp_path, capsys):
    status, text = answered(tmp_path, capsys, ("1", 2, 0))
    assert status == 0
    assert "leads on" not in text


@pytest.mark.parametrize(
    ("require", "satisfying"), [("true", "satisfying  1 "), ("near", "satisfying  0 ")]
)
def test_it_says_that_no_trajectory_was_found(require, satisfying, tmp_path, capsys, monkeypatch):
    """Of those that keep the rule, and of those that may: of `near` nothing is known."""
    search = "rulec.partition.motion.witness_trajectory.WitnessSearch"
    file = tmp_path / "free.toml"
    ego = ROAD.replace("d = 0", 'd = 0\nspeed = 5\nbounds = "car"')
    file.write_text(f'{ego}[signals]\nnear = "?"\n')
    book = tmp_path / "book.rules"
    book.write_text(
        f"rulebook book signal near hard rule r {{ require {require} }} "
        "hard rule s { require always near implies near }"
    )
    command = ["maneuvers", str(file), "-r", str(book), "--list", "1"]
    assert main(command) == 0
    said = capsys.readouterr().out
    assert "listed      none" not in said
    assert satisfying in said
    for way_of_search in ("of", "by_sides"):
        monkeypatch.setattr(f"{search}.{way_of_search}", lambda *_: None)
    assert main(command) == 0
    assert "listed      none: no trajectory was found" in capsys.readouterr().out


def test_who_is_in_the_way_is_named(tmp_path, capsys):
    # 0.75 m before ego's front: from 5 m/s it takes 1.1 m to stop, while its middle has 3 m
    file = tmp_path / "close.toml"
    ego = ROAD.replace("d = 0", 'd = 0\nspeed = 5\nbounds = "car"')
    file.write_text(ego + CAR.format(name="c", s=35, speed=0))
    command = ["maneuvers", str(file), "-r", "esterle2019", "--step", "1", "--list", "1"]
    assert main([*command, "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["in_way"] == ["c"]
    assert main(command) == 0
    assert "those that cost least\nin the way  c\n" in capsys.readouterr().out
    # 1.75 m are enough
    file.write_text(ego + CAR.format(name="c", s=36, speed=0))
    assert main([*command, "--json"]) == 0
    assert "in_way" not in json.loads(capsys.readouterr().out)


def test_the_bounds_are_named_where_they_close_the_way(tmp_path, capsys):
    # 22 m to the rear of one that stands: from 20 m/s ego has come 18 m after 1 s, and 32 after 2
    file = tmp_path / "fast.toml"
    ego = ROAD.replace("d = 0", 'd = 0\nspeed = 20\nbounds = "braking=4"').replace("60", "70")
    file.write_text(ego + CAR.format(name="c", s=54, speed=0))
    assert main(["maneuvers", str(file), "-r", "esterle2019", "--step", "1", "--json"]) == 1
    end = json.loads(capsys.readouterr().out)["dead_end"]
    assert end == {"last_s": 1.0, "closed_by": ["c"], "opened_by": ["--bounds none"]}
    assert main(["maneuvers", str(file), "-r", "esterle2019", "--step", "1"]) == 1
    text = unwrapped(capsys.readouterr().out)
    assert "none leads on from between 1 s and 2 s within the bounds of ego's motion" in text


def test_one_that_does_not_close_the_way_is_not_named(tmp_path, capsys):
    """The road ends there, too: without the other there is no way either."""
    file = tmp_path / "end.toml"
    ego = ROAD.replace("d = 0", 'd = 0\nspeed = 20\nbounds = "braking=4"')
    file.write_text(ego + CAR.format(name="c", s=54, speed=0))
    assert main(["maneuvers", str(file), "-r", "esterle2019", "--step", "1", "--json"]) == 1
    end = json.loads(capsys.readouterr().out)["dead_end"]
    assert (end["last_s"], end["closed_by"]) == (1.0, [])


def test_of_two_the_one_that_closes_the_way_is_named(tmp_path, capsys):
    """From 20 m/s ego has come 32 m after 2 s, at 4 m/s²; without the near one that is enough."""
    file = tmp_path / "two.toml"
    ego = ROAD.replace("d = 0", 'd = 0\nspeed = 20\nbounds = "braking=4"').replace("60", "90")
    cars = CAR.format(name="c", s=54, speed=0) + CAR.format(name="far", s=75, speed=0)
    file.write_text(ego + cars)
    assert main(["maneuvers", str(file), "-r", "esterle2019", "--step", "1", "--json"]) == 1
    assert json.loads(capsys.readouterr().out)["dead_end"]["closed_by"] == ["c"]


def test_no_way_within_bounds_leads_to_the_goal(tmp_path, capsys):
    # It is beyond one that stands on the only lane
    file = tmp_path / "goal.toml"
    ego = ROAD.replace("d = 0", 'd = 0\nspeed = 5\nbounds = "car"')
    goal = "[goal]\ns = [50, 60]\n"
    file.write_text(ego + goal + CAR.format(name="c", s=44, speed=0))
    assert main(["maneuvers", str(file), "-r", "esterle2019", "--step", "1"]) == 1
    text = unwrapped(capsys.readouterr().out)
    assert "no way leads to the goal by the end within the bounds of ego's motion" in text
    assert "maneuvers 0 " in text


@pytest.mark.parametrize(
    ("goal", "opened"),
    [
        # From 30 m on at 10 m/s, by 8 m/s²: 66 m within 2 s, 134 m within 4 s; backwards never
        ("[70, 80]", "`--horizon 4`"),
        ("[0, 20]", "no longer horizon, shorter step, narrower extent or other adjacency"),
    ],
)
def test_a_goal_out_of_reach_is_said(goal, opened, tmp_path, capsys):
    """In one cell with ego, on an empty road."""
    file = tmp_path / "goal.toml"
    ego = ROAD.replace("d = 0", 'd = 0\nspeed = 10\nbounds = "car"').replace("60", "120")
    file.write_text(ego.replace("horizon_s = 4", "horizon_s = 2") + f"[goal]\ns = {goal}\n")
    assert main(["maneuvers", str(file), "-r", "esterle2019", "--step", "1"]) == 1
    text = unwrapped(capsys.readouterr().out)
    assert "no way leads to the goal by the end within the bounds of ego's motion" in text
    assert f"opened by {opened} satisfying" in text


def test_a_rule_is_named_that_closes_every_way(tmp_path, capsys):
    file = tmp_path / "narrow.toml"
    file.write_text(ROAD + CAR.format(name="c", s=50, speed=0))
    book = tmp_path / "never.rules"
    book.write_text(
        "rulebook never\nuse paper\nhard rule away (v: vehicle) { require never b(v) }\n"
    )
    assert main(["maneuvers", str(file), "-r", str(book)]) == 1
    assert "opened by   a softer away (1 more)" in capsys.readouterr().out


def test_whether_a_softer_rule_is_enough_may_be_unknown(tmp_path, capsys):
    """Some keep the other rule perhaps, as gaps are not exactly known in cells; none for sure."""
    book = tmp_path / "never.rules"
    book.write_text(
        "rulebook never\nuse road\n"
        "hard rule away (v: vehicle) { require never (behind(v) and same_lane(v)) }\n"
        "hard rule far (v: vehicle) { require always (behind(v) implies gap(v) > 20 m) }\n"
    )
    assert main(["maneuvers", FOLLOWING, "-r", str(book), "--ego", "1"]) == 1
    (opened,) = [x for x in capsys.readouterr().out.splitlines() if x.startswith("opened by")]
    assert re.fullmatch(r"opened by   a softer away \([0-9,]+ more, perhaps\)", opened)


@pytest.mark.parametrize(("speed", "least", "shown"), [(12, 6.13, "6.1"), (15, 9.578, "9.5")])
def test_an_emergency_is_said(tmp_path, capsys, speed, least, shown):
    # 14 m to the rear of one that stands, less half of a car's 4.508 m: 12² / 2 / 11.746 = 6.13,
    # 15² / 2 / 11.746 = 9.578. It is found to a tenth, in pieces of 0.1 s, and not said to be more.
    # The road leaves no room beside it.
    file = tmp_path / "hard.toml"
    narrow = ROAD.replace("[-2, 2]", "[-1.6, 1.6]")
    ego = narrow.replace("d = 0", f'd = 0\nspeed = {speed}\nbounds = "car"')
    file.write_text(ego + CAR.format(name="c", s=46, speed=0))
    command = ["maneuvers", str(file), "-r", "esterle2019", "--step", "0.5"]
    assert main([*command, "--list", "1", "--json"]) == 0
    assert least - 0.1 < json.loads(capsys.readouterr().out)["least_braking"] < least + 0.01
    assert main([*command, "--list", "1"]) == 0
    said = f"emergency   every maneuver brakes by more than {shown} m/s²"
    assert said in capsys.readouterr().out
    assert main([*command, "--json"]) == 0
    assert "least_braking" not in json.loads(capsys.readouterr().out)


def test_an_emergency_after_the_end_is_said(tmp_path, capsys):
    # From 30 to 10 m/s within 50 m less half of a car's 4.508 m: 20² / 2 / 47.746 = 4.189 m/s²
    file = tmp_path / "later.toml"
    long = ROAD.replace("[-2, 2]", "[-1.6, 1.6]").replace("60", "260")
    ego = long.replace("d = 0", 'd = 0\nspeed = 30\nbounds = "car"')
    file.write_text(ego + CAR.format(name="c", s=82, speed=10))
    command = ["maneuvers", str(file), "-r", "esterle2019", "--step", "0.5", "--horizon", "2"]
    assert main([*command, "--list", "1", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert "least_braking" not in told
    assert 4.08 < told["least_braking_later"] < 4.19
    assert main([*command, "--list", "1"]) == 0
    said = "brakes by more than 4.1 m/s², or has to after 2 s for what is ahead then"
    assert f"emergency every maneuver {said}" in unwrapped(capsys.readouterr().out)
