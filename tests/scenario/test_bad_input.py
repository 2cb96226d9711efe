"""What is wrong with a scenario file is said with its place, in words, all of it in one run."""

import os
import re
from contextlib import suppress

import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.diagnostics import RulecError
from rulec.scenario import Scenario, load_scenario
from rulec.scenario.time_grid import MAX_LAYERS

GOOD = """\
horizon_s = 4.0
step_s = 1.0

[road]
s = [0.0, 100.0]
lanes = [0.0, 3.0, 6.0]

[[road.surface]]
type = "crossing"
s = [60.0, 64.0]

[[road.missing]]
lane = 1
s = [80.0, 100.0]

[ego]
s = 5.0
d = 1.5

[[obstacle]]
id = "o1"
type = "vehicle"
length = 4.0
width = 1.8
s = 30.0
d = 1.5
speed = 5.0

[[obstacle]]
id = "p1"
type = "pedestrian"
length = 0.5
width = 0.5
s = 62.0
d = 1.0
lateral_speed = 1.0

[signals]
CONGESTED = false
"""


def complaints(tmp_path, text, name="x.toml"):
    file = tmp_path / name
    file.write_bytes(text if isinstance(text, bytes) else text.encode())
    with pytest.raises(RulecError) as caught:
        load_scenario(file)
    assert all(d.place is not None and d.place.file == str(file) for d in caught.value.diagnostics)
    return caught.value.diagnostics


def line_of(text, part):
    return text[: text.index(part)].count("\n") + 1


def test_the_file_that_the_others_are_made_from_is_good(tmp_path):
    (tmp_path / "x.toml").write_text(GOOD, encoding="utf-8")
    assert len(load_scenario(tmp_path / "x.toml").obstacles) == 2


FIELDS = [
    # old, new, code, words in the message, words in what was expected or the way out; without
    # the backquotes around names and values
    ("speed = 5.0", 'speed = "fast"', "R0604", 'obstacle 1 (o1): speed is "fast"', "m/s along"),
    ("speed = 5.0", "speed = nan", "R0604", "speed is nan", "m/s along the road"),
    ("speed = 5.0", "speed = inf", "R0604", "speed is inf", "at most 1000"),
    ("speed = 5.0", "speed = 1e9", "R0604", "speed is 1000000000.0", "at most 1000"),
    ("speed = 5.0", "speed = true", "R0604", "speed is true", "m/s"),
    ("speed = 5.0", "speed = [5.0]", "R0604", "speed is a list of 1", "m/s"),
    ("speed = 5.0", f"speed = 1{'0' * 400}", "R0604", "more than 30 digits", "m/s"),
    ("speed = 5.0", "sped = 5.0", "R0603", "a field sped that does not exist", "speed?"),
    ("length = 4.0", "lenght = 4.0", "R0603", "a field lenght that does not", "length?"),
    ("speed = 5.0", "colour = 5", "R0603", "colour that does not exist", "leave it out"),
    ("speed = 5.0", "until_d = 4.5", "R0605", "never reaches until_d = 4.5", "sign"),
    ("speed = 5.0", "trajectory = [[0, 1, 2]]", "R0605", "and also s, d", "leave out one"),
    ("speed = 5.0", "walking_direction = 400", "R0604", "walking_direction is 400", "degrees"),
    ("s = 30.0\n", "", "R0603", "obstacle 1 (o1) has no s", "trajectory instead"),
    ("length = 4.0", "length = -4.0", "R0604", "length is -4.0", "metres, from 0.01"),
    ("length = 4.0", "length = 0", "R0604", "length is 0", "metres, from 0.01"),
    ("length = 4.0\n", "", "R0603", "obstacle 1 (o1) has no length", "add a line length"),
    ('id = "o1"', "id = 7", "R0604", "obstacle 1: id is 7", "a name in quotes"),
    ('id = "o1"', 'id = ""', "R0604", 'id is ""', "a name in quotes"),
    ('id = "o1"', 'id = "a\\nb"', "R0604", 'id is "a?b"', "on one line"),
    ('id = "o1"', 'id = "p1"', "R0605", "obstacles 1 and 2 are both called p1", "no other"),
    ('type = "vehicle"', 'type = "two words"', "R0604", 'type is "two words"', '"vehicle"'),
    ("lateral_speed = 1.0\n", "", "R0603", "stands still", "walking_direction = 90"),
    ("lateral_speed = 1.0", "signals = 3", "R0604", "signals is 3", "a table"),
    ("width = 0.5", "width = 0.5\nsignals = { a = [1] }", "R0604", "a is a list", "true, false"),
    *(
        ("width = 0.5", f"width = 0.5\nsignals = {{ a = {given} }}", "R0604", "a is a table", '"?"')
        for given in (
            "{ from = 4, to = 3 }",
            "{ from = 4 }",
            "{ from = 1, to = 2, or = 3 }",
            '{ from = "?", to = 2 }',
            "{ from = true, to = 2 }",
        )
    ),
    (
        "width = 0.5",
        "width = 0.5\nsignals = { lateral = 1 }",
        "R0605",
        "the partition supplies",
        "",
    ),
    (
        "lateral_speed = 1.0",
        "lateral_speed = 1.0\nsignals = { CONGESTED = true }",
        "R0605",
        "and so does [signals]",
        "either global or per object",
    ),
    ("CONGESTED = false", "CONGESTED = nan", "R0604", "CONGESTED is nan", "finite number"),
    ("CONGESTED = false", f"LIMIT = 1{'0' * 400}", "R0604", "LIMIT is a number", "finite"),
    ("CONGESTED = false", "surface = 1", "R0605", "sets surface", "something else"),
    ("s = [0.0, 100.0]", "s = [0.0]", "R0604", "road: s is a list of 1", "from and to"),
    ("s = [0.0, 100.0]", 's = [0.0, "far"]', "R0604", 's, number 2 is "far"', "from and to"),
    ("s = [0.0, 100.0]", "s = [100.0, 0.0]", "R0605", "from 100 to 0", "s = [0, 100]"),
    ("s = [0.0, 100.0]", "s = [0.0, 0.0]", "R0605", "from 0 to 0", "larger than the first"),
    ("s = [0.0, 100.0]", "s = [0.0, 1e7]", "R0604", "s, number 2 is 10000000.0", "metres"),
    (
        "lanes = [0.0, 3.0, 6.0]",
        "lanes = [0.0]",
        "R0604",
        "lanes is a list of 1",
        "one number more",
    ),
    ("lanes = [0.0, 3.0, 6.0]", "lanes = []", "R0604", "lanes is a list of 0", "one number more"),
    ("lanes = [0.0, 3.0, 6.0]", "lanes = [0.0, 6.0, 3.0]", "R0605", "3 follows 6", "sort"),
    ("lanes = [0.0, 3.0, 6.0]", "lanes = [0.0, 3.0, 3.0]", "R0605", "3 follows 3", "larger"),
    ("lanes = [0.0, 3.0, 6.0]", "lanes = 2", "R0604", "lanes is 2", "one number more"),
    ('type = "crossing"', 'type = "crosing"', "R0604", 'type is "crosing"', "one of carriageway"),
    ("s = [60.0, 64.0]", "s = [64.0, 60.0]", "R0605", "road.surface 1: s runs", "[60, 64]"),
    ("lane = 1", "lane = 3", "R0605", "road.missing 1: lane is 3", "from 1 to 2"),
    ("lane = 1", "lane = 0", "R0604", "lane is 0", "counted from the right"),
    ("lane = 1", "lane = 1.5", "R0604", "lane is 1.5", "counted from the right"),
    (
        "s = 5.0",
        "s = -5.0",
        "R0605",
        "ego is off the road, at s = -5, d = 1.5",
        "within s 0 to 100, d 0 to 6",
    ),
    ("s = 5.0", "s = 90.0", "R0605", "ego is where the road has no lane", "road.missing"),
    ("s = 5.0", "s = 31.0", "R0605", "ego stands inside obstacle 1 (o1)", "s 28 to 32"),
    ("s = 5.0\n", "", "R0603", "ego has no s", "add a line s = …"),
    ("horizon_s = 4.0", "horizon_s = 4.5", "R0606", "4.5 s is not a whole number", "step"),
    ("horizon_s = 4.0", "horizon_s = -1", "R0604", "horizon_s is -1", "above 0"),
    ("step_s = 1.0", "step_s = 1e-5", "R0606", "too many layers", "longer step"),
    ("step_s = 1.0", "step = 1.0", "R0603", "a field step", "did you mean step_s?"),
    ("[ego]\ns = 5.0\nd = 1.5\n", "", "R0603", "the scenario has no ego", "[ego]"),
]


@pytest.mark.parametrize(("old", "new", "code", "message", "words"), FIELDS)
def test_a_bad_field(tmp_path, old, new, code, message, words):
    assert old in GOOD
    text = GOOD.replace(old, new, 1)
    (problem,) = complaints(tmp_path, text)
    assert problem.code == code
    assert message in problem.message.replace("`", "")
    assert words in f"{problem.expected} {problem.help}".replace("`", "")
    assert not problem.expected or problem.expected.startswith("expected ")


def test_names_and_values_stand_in_backquotes(tmp_path):
    (problem,) = complaints(tmp_path, GOOD.replace("speed = 5.0", 'speed = "fast"'))
    assert problem.message == 'obstacle 1 (`o1`): `speed` is `"fast"`'
    (problem,) = complaints(tmp_path, GOOD.replace("speed = 5.0", "sped = 5.0"))
    assert problem.message == "obstacle 1 (`o1`) has a field `sped` that does not exist"
    assert problem.help == "did you mean `speed`?"


def test_the_place_is_that_of_the_field(tmp_path):
    text = GOOD.replace("lateral_speed = 1.0", "  lateral_speed = []  # oh")
    (problem,) = complaints(tmp_path, text)
    assert problem.place.line == line_of(text, "  lateral_speed")
    assert (problem.place.column, problem.place.end_column) == (3, 27)
    assert problem.place.excerpt == "  lateral_speed = []  # oh"


def test_the_place_of_a_missing_field_is_its_table(tmp_path):
    text = GOOD.replace('type = "pedestrian"\n', "")
    (problem,) = complaints(tmp_path, text)
    assert problem.place.line == line_of(text, '[[obstacle]]\nid = "p1"')


def test_a_field_in_an_inline_table_is_named_in_words(tmp_path):
    text = "ego = { s = 1, d = 1, w = 2 }\nroad = { s = [0, 9], lanes = [0, 3] }\n"
    (problem,) = complaints(tmp_path, text)
    assert "ego has a field `w`" in problem.message


def test_independent_mistakes_are_reported_together(tmp_path):
    text = (
        GOOD.replace("speed = 5.0", 'speed = "fast"\nlenght = 3', 1)
        .replace("lanes = [0.0, 3.0, 6.0]", "lanes = [0.0]")
        .replace("lateral_speed = 1.0", "lateral_speed = nan")
        .replace("s = 5.0", 's = "here"')
        .replace("horizon_s = 4.0", "horizon_s = 0")
    )
    problems = complaints(tmp_path, text)
    assert sorted(d.code for d in problems) == ["R0603"] + ["R0604"] * 5
    assert len({d.place.line for d in problems}) == 6


def test_trajectories(tmp_path):
    def problem(trajectory):
        old = "s = 30.0\nd = 1.5\nspeed = 5.0\n"
        assert old in GOOD
        (found,) = complaints(tmp_path, GOOD.replace(old, f"trajectory = {trajectory}\n"))
        return found

    assert problem("[]").code == "R0604"
    assert "`trajectory`, number 2 is a list of 2" in problem("[[0, 1, 1], [1, 2]]").message
    assert "number 1, number 2 is `nan`" in problem("[[0, nan, 1]]").message
    unordered = problem("[[0.0, 50, 1], [2.0, 51, 1], [1.0, 52, 1]]")
    assert unordered.code == "R0605"
    assert "time 1 follows 2" in unordered.message
    assert "time 0 follows 0" in problem("[[0, 50, 1], [0, 51, 1]]").message


@pytest.mark.parametrize(
    ("text", "line", "column", "words"),
    [
        ("[road]\ns = [0, 1\n", 3, 1, "not TOML"),
        ("[road]\ns 0\n", 2, 3, "Expected '='"),
        ('name = "x\n', 1, 10, "not TOML"),
        ("[ego]\ns = 1\ns = 2\n", 3, 6, "Cannot overwrite a value"),
        ("just some words\n", 1, 6, "not TOML"),
    ],
)
def test_broken_toml(tmp_path, text, line, column, words):
    (problem,) = complaints(tmp_path, text)
    assert problem.code == "R0602"
    assert (problem.place.line, problem.place.column) == (line, column)
    assert words in problem.message
    assert "(at " not in problem.message


@pytest.mark.parametrize(
    ("content", "code", "words"),
    [
        ("name = 'Straße'\n".encode("latin-1"), "R0101", "is not UTF-8"),
        (GOOD.encode("utf-16"), "R0101", "is in UTF-16"),
        (b"\x7fELF\x02\x01\x01\x00\xff\xfe", "R0101", "is not UTF-8"),
        (b"a = 'x\x00'\n", "R0101", "null character"),
        (b"a = " + b"[" * 100_000, "R0602", "nested too deeply"),
        (b"a" + b".a" * 100_000 + b" = 1", "R0602", "too many parts joined by dots"),
        (b"[" + b"a . " * 100_000 + b"a]", "R0602", "too many parts joined by dots"),
        (b"a = " + b"9" * 5000, "R0602", "Exceeds the limit"),
        (b"#" * 4_000_001, "R0602", "too large"),
    ],
)
def test_files_that_are_no_scenario(tmp_path, content, code, words):
    (problem,) = complaints(tmp_path, content)
    assert problem.code == code
    assert words in problem.message
    assert len(problem.message) < 200


def test_wrong_encoding_has_its_place(tmp_path):
    (problem,) = complaints(tmp_path, "a = 1\nb = 'Straße'\n".encode("latin-1"))
    assert (problem.place.line, problem.place.column) == (2, 10)


def test_an_empty_file(tmp_path):
    problems = complaints(tmp_path, "")
    assert [d.message for d in problems] == [
        "the scenario has no `road`",
        "the scenario has no `ego`",
    ]


def test_tables_that_are_none(tmp_path):
    problems = complaints(tmp_path, "road = 1\nego = []\nobstacle = [1]\nsignals = 2\ngoal = 3\n")
    assert [d.code for d in problems] == ["R0604"] * 5


def test_a_goal_off_the_road(tmp_path):
    (problem,) = complaints(tmp_path, GOOD + "\n[goal]\ns = [200.0, 300.0]\n")
    assert (problem.code, problem.message) == ("R0605", "the goal is off the road")


def test_two_surfaces_in_one_place(tmp_path):
    more = '[[road.surface]]\ntype = "carriageway"\ns = [62.0, 70.0]\n\n[[road.missing]]'
    (problem,) = complaints(tmp_path, GOOD.replace("[[road.missing]]", more))
    assert (problem.code, problem.expected) == ("R0605", "expected one surface in one place")


def test_too_many_obstacles(tmp_path):
    text = "obstacle = [" + "{}," * 501 + "]\n[road]\ns=[0,9]\nlanes=[0,3]\n[ego]\ns=1\nd=1\n"
    (problem,) = complaints(tmp_path, text)
    assert "`obstacle` is a list of 501" in problem.message
    assert problem.expected == "expected at most 500 `[[obstacle]]`"


def test_files_that_cannot_be_read(tmp_path):
    for path in (tmp_path / "nowhere.toml", tmp_path, "no/such/folder", "a\x00b.toml"):
        with pytest.raises(RulecError) as caught:
            load_scenario(path)
        assert [d.code for d in caught.value.diagnostics] == ["R0701"]


def test_an_endless_file():
    if not os.path.exists("/dev/zero"):  # noqa: PTH110 - a device, not a path of ours
        pytest.skip("there is no /dev/zero here")
    with pytest.raises(RulecError) as caught:
        load_scenario("/dev/zero")
    assert [d.code for d in caught.value.diagnostics] == ["R0602"]


@given(st.integers(0, len(GOOD)), st.integers(0, 40), st.text(max_size=5))
def test_a_damaged_file_is_read_or_refused(tmp_path_factory, at, cut, put):
    """Never anything but a scenario or a RulecError."""
    file = tmp_path_factory.mktemp("damaged") / "x.toml"
    text = GOOD[:at] + put + GOOD[at + cut :]
    file.write_bytes(text.encode("utf-8", "surrogatepass"))
    with suppress(RulecError):
        assert isinstance(load_scenario(file), Scenario)


toml_values = st.recursive(
    st.sampled_from(["1", "-1", "0.0", "nan", "-inf", "1e308", "true", '""', '"x"', "1979-05-27"]),
    lambda inner: st.lists(inner, max_size=3).map(lambda xs: "[" + ", ".join(xs) + "]"),
    max_leaves=5,
) | st.just("{ a = 1 }")


@given(st.integers(0, 30), toml_values)
def test_any_value_in_any_field_is_read_or_refused(tmp_path_factory, which, value):
    lines = GOOD.split("\n")
    keys = [i for i, line in enumerate(lines) if " = " in line]
    i = keys[which % len(keys)]
    lines[i] = lines[i].partition(" = ")[0] + " = " + value
    file = tmp_path_factory.mktemp("value") / "x.toml"
    file.write_text("\n".join(lines), encoding="utf-8")
    try:
        assert isinstance(load_scenario(file), Scenario)
    except RulecError as error:
        for problem in error.diagnostics:
            assert problem.place.line is not None
            assert problem.expected or problem.help


def test_surfaces_beyond_number(tmp_path):
    """Each is held against all others."""
    surfaces = (
        f'\n[[road.surface]]\ntype = "crossing"\ns = [{at}.0, {at}.5]' for at in range(5000)
    )
    (only,) = complaints(tmp_path, GOOD + "".join(surfaces))
    assert (only.code, only.expected) == ("R0604", "expected at most 500 tables of a kind")


ODD_NUMBERS = ["nan", "inf", "-inf", "1e308", "1e-308", "9" * 400, "9" * 5000, "-1e400"]


@pytest.mark.parametrize("value", ODD_NUMBERS)
def test_an_odd_number_in_any_field_is_refused_or_taken_as_it_is(value, tmp_path):
    """None of them fails, takes memory or hangs."""
    lines = GOOD.splitlines()
    numbered = [n for n, line in enumerate(lines) if re.search(r"= \[?-?[0-9]", line)]
    assert len(numbered) > 15
    file = tmp_path / "odd.toml"
    for number in numbered:
        odd = re.sub(r"-?[0-9.]+", value, lines[number].partition("=")[2], count=1)
        changed = lines[number].partition("=")[0] + "=" + odd
        file.write_text("\n".join([*lines[:number], changed, *lines[number + 1 :]]))
        with suppress(RulecError):
            scenario = load_scenario(file)
            assert scenario.horizon_s / scenario.step_s < MAX_LAYERS
