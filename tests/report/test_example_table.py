"""Examples as tables of states."""

import pytest

from rulec.report.rulebooks.document.book_rule import example_rows
from rulec.rulebook.loader import parse_rulebook

BOOK = """\
rulebook tables
type car
near_it(c: car) is one of close_by, far default far
light is one of red, green
signal wet_road default true
signal follows(c: car, d: car)
quantity speed in km/h default 0
quantity gap(c: car) in m
hard rule r (c: car, d: car) {{ require true {example} }}
"""


@pytest.mark.parametrize(
    ("states", "rows"),
    [
        # What is not mentioned has its default, in parentheses, if it has one.
        ("close_by(c); far(c)", [("near it of c", ("close by", "far"))]),
        ("close_by(c); red", [("near it of c", ("close by", "(far)")), ("light", ("–", "red"))]),
        (
            "not wet_road; red; wet_road",
            [("wet road", ("no", "(yes)", "yes")), ("light", ("–", "red", "–"))],
        ),
        (
            "follows(c, d); follows(d, c)",
            [("follows of c and d", ("yes", "–")), ("follows of d and c", ("–", "yes"))],
        ),
        (
            "speed = 36 km/h; speed = 1.5 m/s; red",
            [("speed, km/h", ("36", "5.4", "(0)")), ("light", ("–", "–", "red"))],
        ),
        ("gap(c) = 1.25 m; red", [("gap of c, m", ("1.25", "–")), ("light", ("–", "red"))]),
    ],
)
def test_what_an_example_says(states, rows):
    text = BOOK.format(example=f"accept {{ {states} }}")
    book = parse_rulebook(text)
    (example,) = book.rules[0].examples
    table = [[subject, *values] for subject, values in rows]
    assert list(example_rows(example, book.vocabulary)) == table
