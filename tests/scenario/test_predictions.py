"""Several predictions of an obstacle in a scenario file."""

from fractions import Fraction

import pytest

from rulec.diagnostics import RulecError
from rulec.scenario import Alternative, ConstantAcceleration, Trajectory, load_scenario

HEAD = """\
[road]
s = [0.0, 100.0]
lanes = [0.0, 3.0, 6.0]

[ego]
s = 5.0
d = 1.5

[[obstacle]]
id = "first"
type = "vehicle"
length = 4.0
width = 1.8
s = 70.0
d = 4.5

[[obstacle.prediction]]
weight = 1

[[obstacle]]
id = "o1"
type = "vehicle"
length = 4.0
width = 1.8
s = 30.0
d = 1.5
speed = 5.0
acceleration = -1.0
"""


def prediction(weight, *lines):
    return "\n".join(["", "[[obstacle.prediction]]", f"weight = {weight}", *lines, ""])


def read(tmp_path, *parts):
    file = tmp_path / "x.toml"
    file.write_text(HEAD + "".join(parts), encoding="utf-8")
    return load_scenario(file).obstacles[1]


def complaint(tmp_path, *parts):
    with pytest.raises(RulecError) as caught:
        read(tmp_path, *parts)
    (problem,) = caught.value.diagnostics
    return problem


def test_a_prediction_says_what_is_different_from_its_obstacle(tmp_path):
    found = read(
        tmp_path,
        prediction(0.5, "speed = 7.0"),
        prediction(0.2, "lateral_speed = 1.0", "until_d = 4.5"),
        prediction(0.3, "trajectory = [[0, 30, 1.5], [4, 50, 1.5]]"),
    )
    assert found.motion == ConstantAcceleration(30.0, 1.5, 7.0, -1.0)
    assert found.weight == Fraction(1, 2)
    # The likelier one comes first
    assert found.alternatives == (
        Alternative(Fraction(3, 10), Trajectory(((0.0, 30.0, 1.5), (4.0, 50.0, 1.5)))),
        Alternative(Fraction(1, 5), ConstantAcceleration(30.0, 1.5, 5.0, -1.0, 1.0, 4.5)),
    )


def test_of_equally_likely_ones_the_first_is_the_likeliest(tmp_path):
    found = read(tmp_path, prediction(0.5, "speed = 7.0"), prediction(0.5, "speed = 8.0"))
    assert found.motion.speed == 7.0
    assert [one.motion.speed for one in found.alternatives] == [8.0]


def test_equal_predictions_are_one(tmp_path):
    found = read(
        tmp_path, prediction(0.4, "speed = 7.0"), prediction(0.3), prediction(0.3, "speed = 5")
    )
    assert (found.motion.speed, found.weight) == (5.0, Fraction(3, 5))
    assert [(one.motion.speed, one.weight) for one in found.alternatives] == [(7.0, Fraction(2, 5))]


def test_weights_that_are_rounded_become_probabilities(tmp_path):
    thirds = [prediction(0.333, f"speed = {speed}") for speed in (7.0, 8.0, 9.0)]
    found = read(tmp_path, *thirds)
    assert found.weight == Fraction(1, 3)
    assert sum(one.weight for one in found.alternatives) == Fraction(2, 3)


@pytest.mark.parametrize(
    ("parts", "line", "message", "way_out"),
    [
        (
            [prediction(0.7), prediction(0.2, "speed = 1")],
            '[[obstacle]]\nid = "o1"',
            "the weights of obstacle 2 (`o1`)'s predictions add up to 0.9",
            "expected weights that add up to 1",
        ),
        (
            [prediction(1.5)],
            "weight = 1.5",
            "obstacle 2 (`o1`), prediction 1: `weight` is `1.5`",
            "expected a probability, above 0 and at most 1, such as `0.7`",
        ),
        (
            [prediction(0.5), prediction(0.5, "sped = 3.0")],
            "sped = 3.0",
            "obstacle 2 (`o1`), prediction 2 has a field `sped` that does not exist",
            "did you mean `speed`?",
        ),
        (
            [prediction(0.5), "\n[[obstacle.prediction]]\nspeed = 2.0\n"],
            "[[obstacle.prediction]]\nspeed = 2.0",
            "obstacle 2 (`o1`), prediction 2 has no `weight`",
            "add a line `weight = …`",
        ),
        (
            [prediction(1, "until_d = 4.5")],
            "until_d = 4.5",
            "obstacle 2 (`o1`), prediction 1 never reaches `until_d = 4.5`",
            "change the sign of `lateral_speed`, or leave `until_d` out",
        ),
        (
            [prediction(1, "speed = 3.0", "trajectory = [[0, 30, 1.5]]")],
            "speed = 3.0",
            "obstacle 2 (`o1`), prediction 1 has a `trajectory` and also `speed`",
            "leave out one of the two",
        ),
        (
            ["prediction = 3\n"],
            "prediction = 3",
            "obstacle 2 (`o1`): `prediction` is `3`",
            "expected at most 10 `[[obstacle.prediction]]`",
        ),
    ],
)
def test_a_mistake_is_said_in_its_place(tmp_path, parts, line, message, way_out):
    problem = complaint(tmp_path, *parts)
    text = HEAD + "".join(parts)
    assert problem.message == message
    assert way_out in (problem.help, problem.expected)
    assert problem.place.line == text[: text.index(line)].count("\n") + 1


def test_a_place_is_wanted_once(tmp_path):
    text = HEAD.replace("s = 30.0\n", "")
    file = tmp_path / "x.toml"
    file.write_text(text + prediction(0.5) + prediction(0.5, "speed = 3.0"), encoding="utf-8")
    with pytest.raises(RulecError) as caught:
        load_scenario(file)
    (problem,) = caught.value.diagnostics
    assert problem.message == "obstacle 2 (`o1`) has no `s`"


def test_a_trajectory_of_its_own_leaves_no_room_for_predictions(tmp_path):
    file = tmp_path / "x.toml"
    own = "trajectory = [[0, 30, 1.5], [4, 50, 1.5]]\n"
    moved = HEAD[: HEAD.rindex("s = 30.0")] + own
    file.write_text(moved + prediction(1), encoding="utf-8")
    with pytest.raises(RulecError) as caught:
        load_scenario(file)
    (problem,) = caught.value.diagnostics
    assert problem.message == "obstacle 2 (`o1`) has a `trajectory` and also predictions"


def test_a_pedestrian_needs_a_direction_if_by_any_prediction_it_stands(tmp_path):
    walker = HEAD[HEAD.index("\n[[obstacle]]") : HEAD.index("\n[[obstacle.pred")]
    walker = walker.replace("first", "p").replace("vehicle", "pedestrian")
    moving, standing = prediction(0.5, "lateral_speed = 1.0"), prediction(0.5)
    problem = complaint(tmp_path, walker, moving, standing)
    assert problem.message == "obstacle 3 (`p`) stands still and has no `walking_direction`"
    read(tmp_path, walker, moving, prediction(0.5, "lateral_speed = -1.0"))
