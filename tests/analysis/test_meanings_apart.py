"""Two rulebooks that define a word differently are compared by their definitions."""

import pytest

from rulec import parse_rulebook
from rulec.analysis.diff.comparison_matrix import growing_matrices
from rulec.analysis.diff.rulebook_comparison import diff_rulebooks

WORDS = """rulebook {name}
type car
quantity speed in km/h default 0
quantity gap(c: car) in m default 1000
signal behind(c: car) default false
signal wet default false
signal near(c: car) default false
signal slow default false
{define}
hard rule keeps(c: car) {{ require always not near(c) }}
hard rule flows {{ require always not slow }}
"""
SIGHT = "define near(c: car) = gap(c) < {} * speed + speed * speed / (2 * {})"


def relation(first, second, rule="keeps"):
    books = [
        parse_rulebook(WORDS.format(name=name, define=define))
        for name, define in (("one", first), ("two", second))
    ]
    diff = diff_rulebooks(*books)
    return {pair.name: pair.relation for pair in diff.pairs}[rule]


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        (SIGHT.format("1 s", "8 m/s^2"), SIGHT.format("1 s", "8 m/s^2"), "equal"),
        # Whoever needs longer to react, or brakes less, has to keep farther away
        (SIGHT.format("1 s", "8 m/s^2"), SIGHT.format("2 s", "8 m/s^2"), "laxer"),
        (SIGHT.format("1 s", "6 m/s^2"), SIGHT.format("1 s", "8 m/s^2"), "stricter"),
        (SIGHT.format("2 s", "6 m/s^2"), SIGHT.format("1 s", "8 m/s^2"), "stricter"),
        (SIGHT.format("2 s", "8 m/s^2"), SIGHT.format("1 s", "6 m/s^2"), "incomparable"),
        ("define near(c: car) = gap(c) < 3 m", "define near(c: car) = gap(c) < 5 m", "laxer"),
        (
            "define near(c: car) = gap(c) <= 3 m",
            "define near(c: car) = gap(c) < 3 m",
            "stricter",
        ),
        (
            "define near(c: car) = behind(c) and gap(c) < 5 m",
            "define near(c: car) = behind(c) and gap(c) < 3 m",
            "stricter",
        ),
        (
            "define near(c: car) = not (behind(c) implies gap(c) >= 5 m)",
            "define near(c: car) = not (behind(c) implies gap(c) >= 3 m)",
            "stricter",
        ),
        (
            "define near(c: car) = gap(c) < 5 m and once[<= 2 s] behind(c)",
            "define near(c: car) = gap(c) < 5 m and once[<= 3 s] behind(c)",
            "laxer",
        ),
        (
            "define near(c: car) = historically[<= 2 s] gap(c) < 5 m",
            "define near(c: car) = historically[<= 3 s] gap(c) < 5 m",
            "stricter",
        ),
        (
            "define near(c: car) = wet since[>= 2 s] wet and behind(c)",
            "define near(c: car) = wet since[>= 3 s] wet and behind(c)",
            "stricter",
        ),
        (
            "define near(c: car) = behind(c) and historically[2 s .. 9 s] wet",
            "define near(c: car) = behind(c) and historically[3 s .. 9 s] wet",
            "laxer",
        ),
        ("define near(c: car) = gap(c) < 5 m", "define near(c: car) = wet", "incomparable"),
    ],
)
def test_a_definition_is_ordered_by_its_numbers(first, second, expected):
    assert relation(first, second) == expected
    turned = {"laxer": "stricter", "stricter": "laxer"}
    assert relation(second, first) == turned.get(expected, expected)


@pytest.mark.parametrize(
    ("counted", "expected"),
    [
        ("some c: car (gap(c) < {} m)", "laxer"),
        ("every c: car (gap(c) < {} m)", "laxer"),
        ("not some c: car (gap(c) < {} m)", "stricter"),
        ("count c: car (gap(c) < {} m) > 2", "laxer"),
        ("count c: car (gap(c) < {} m) <= 2", "stricter"),
        ("count c: car (gap(c) < {} m) = 2", "incomparable"),
    ],
)
def test_a_definition_is_ordered_by_the_numbers_in_what_it_counts(counted, expected):
    """Who is nearer than three metres is nearer than five."""
    first, second = (f"define slow = {counted.format(metres)}" for metres in (3, 5))
    assert relation(first, second, "flows") == expected


ROAD = """rulebook {}
use road
set {}
hard rule flows {{ require never impedes_traffic }}
"""


@pytest.mark.parametrize(
    ("first", "second"),
    [
        ("far_below_limit = 0.4", "far_below_limit = 0.5"),
        ("slow_for = 20 s", "slow_for = 10 s"),
        ("falling_behind = 1 m/s", "falling_behind = 2 m/s"),
        ("allowed_anywhere = 20 km/h", "allowed_anywhere = 30 km/h"),
        ("least_acceleration = 0.2 m/s^2", "least_acceleration = 0.5 m/s^2"),
    ],
)
def test_books_that_set_a_parameter_of_impedes_traffic_are_ordered(first, second):
    """A law that calls less traffic impeded forbids less."""
    books = [
        parse_rulebook(ROAD.format(name, own))
        for name, own in zip("ab", (first, second), strict=True)
    ]
    assert [pair.relation for pair in diff_rulebooks(*books).pairs] == ["laxer"]
    assert [pair.relation for pair in diff_rulebooks(*books[::-1]).pairs] == ["stricter"]


def test_the_names_of_variables_say_nothing():
    first = "define near(c: car) = gap(c) < 5 m"
    assert relation(first, first.replace("(c", "(d")) == "equal"


def test_other_rules_are_as_equal_as_before():
    first, second = (f"define near(c: car) = gap(c) < {n} m" for n in (3, 5))
    assert relation(first, second, "flows") == "equal"


CHAIN = """rulebook {name}
type car
quantity speed in km/h default 0
quantity difference(c: car) in km/h default 0
quantity gap(c: car) in m default 1000
signal too_close(c: car)
signal bothers(c: car)
signal slow
signal gains(c: car)
param reaction : time = {reaction}
define too_close(c: car) = gap(c) < reaction * speed
define bothers(c: car) = too_close(c)
define slow = 5 m / speed >= reaction
define gains(c: car) = gap(c) * gap(c) < 1 m * reaction * (speed - difference(c))
hard rule keeps(c: car) {{ require always not bothers(c) }}
hard rule many {{ require always (count c: car (too_close(c))) * speed <= 5 km/h }}
hard rule slows {{ require always slow }}
hard rule gaining(c: car) {{ require always not gains(c) }}
hard rule other {{ require always speed < 50 km/h }}
"""
CHAINED = {
    "keeps": "laxer",
    "many": "incomparable",
    "slows": "laxer",
    # What one gains may be negative, so that more time for it is less
    "gaining": "incomparable",
    "other": "equal",
}


def chained():
    return [
        parse_rulebook(CHAIN.format(name=name, reaction=reaction))
        for name, reaction in (("one", "1 s"), ("two", "2 s"))
    ]


def test_what_is_defined_by_what_differs_differs():
    assert {pair.name: pair.relation for pair in diff_rulebooks(*chained()).pairs} == CHAINED


def test_a_matrix_tells_definitions_apart():
    *_, matrix = growing_matrices(chained())
    assert {rule.name: rule.relation("one", "two") for rule in matrix.rules} == CHAINED
