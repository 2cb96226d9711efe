"""Reading scenarios: the built-in ones, and a file with everything in it."""

import pytest

from rulec.diagnostics import RulecError
from rulec.scenario import (
    Box,
    ConstantAcceleration,
    Ego,
    MissingLane,
    Obstacle,
    Road,
    Scenario,
    Stretch,
    Trajectory,
    available_scenarios,
    load_scenario,
)
from rulec.vocabulary.partial_values import UNKNOWN, Interval

EVERYTHING = """
name = "all"
about = "one of each"
horizon_s = 6
step_s = 0.5

[road]
s = [-20, 200.0]
lanes = [-5.25, -1.75, 1.75, 5.25]

[[road.surface]]
type = "crossing"
s = [60.0, 64.0]

[[road.missing]]
lane = 3
s = [120.0, 200.0]

[ego]
s = 0.0
d = 0.0
length = 4.5
width = 1.8

[[obstacle]]
id = "bus 7"
type = "bus"
length = 12.0
width = 2.5
s = 30.0
d = 0.0
speed = 8.0
acceleration = -1.0
lateral_speed = 1.0
until_d = 3.5
signals = { braking = true, gap = 3, loud = "?" }

[[obstacle]]
id = "p"
type = "pedestrian"
length = 0.5
width = 0.5
walking_direction = 90
trajectory = [[0.0, 62.0, -6.0], [4.0, 62.0, 0.0]]

[signals]
CONGESTED = true
limit = 50.0
pace = { from = 3, to = 4.5 }
ice = "?"
weather = "rain"

[goal]
s = [100.0, 200.0]
"""


def test_everything_a_file_can_say(tmp_path):
    file = tmp_path / "all.toml"
    file.write_text(EVERYTHING, encoding="utf-8")
    assert load_scenario(file) == Scenario(
        "all",
        Road(
            (-20.0, 200.0),
            (-5.25, -1.75, 1.75, 5.25),
            (Stretch("crossing", (60.0, 64.0)),),
            (MissingLane(3, (120.0, 200.0)),),
        ),
        Ego(0.0, 0.0, 4.5, 1.8),
        (
            Obstacle(
                "bus 7",
                "bus",
                12.0,
                2.5,
                ConstantAcceleration(30.0, 0.0, 8.0, -1.0, 1.0, 3.5),
                None,
                {"braking": True, "gap": 3.0, "loud": UNKNOWN},
            ),
            Obstacle(
                "p",
                "pedestrian",
                0.5,
                0.5,
                Trajectory(((0.0, 62.0, -6.0), (4.0, 62.0, 0.0))),
                90.0,
            ),
        ),
        {
            "CONGESTED": True,
            "limit": 50.0,
            "pace": Interval(3.0, 4.5),
            "ice": UNKNOWN,
            "weather": "rain",
        },
        Box(100.0, 200.0, -5.25, 5.25),
        6.0,
        0.5,
        "one of each",
    )


def test_the_shortest_file(tmp_path):
    file = tmp_path / "short.toml"
    file.write_text(
        "[road]\ns = [0, 50]\nlanes = [0, 3]\n[ego]\ns = 1\nd = 1\n", encoding="utf-8-sig"
    )
    scenario = load_scenario(str(file))
    assert scenario == Scenario("short", Road((0.0, 50.0), (0.0, 3.0)), Ego(1.0, 1.0))
    assert (scenario.horizon_s, scenario.step_s) == (4.0, 1.0)


def test_windows_line_ends(tmp_path):
    file = tmp_path / "all.toml"
    file.write_bytes(EVERYTHING.replace("\n", "\r\n").encode())
    assert load_scenario(file).name == "all"


def test_built_in_scenarios():
    assert available_scenarios() == ("s1", "s2", "s3")
    for name in available_scenarios():
        assert load_scenario(name).name == name
        assert load_scenario(name) == load_scenario(name.upper())


def test_a_file_beside_a_built_in_name(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "s1").write_text(EVERYTHING, encoding="utf-8")
    (tmp_path / "mine").write_text(EVERYTHING, encoding="utf-8")
    assert load_scenario("s1").name == "s1"
    assert load_scenario("./s1").name == "all"
    assert load_scenario("mine").name == "all"


@pytest.mark.parametrize(
    ("name", "help_text"),
    [("s22", "did you mean `s2`?"), ("highway", "give one of these names"), ("", "give one of")],
)
def test_an_unknown_name(name, help_text):
    with pytest.raises(RulecError) as caught:
        load_scenario(name)
    (problem,) = caught.value.diagnostics
    assert problem.code == "R0601"
    assert "`s1`, `s2`, `s3`" in problem.expected
    assert help_text in problem.help
