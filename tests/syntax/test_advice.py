"""Frequent mistakes: each gets the help that it needs."""

import pytest

from rulec.diagnostics import RulecError, Source
from rulec.syntax import parse, parse_formula

COMPARED = "formulas are compared by `iff`; a value is an atom itself, such as `crossing`"
NAMES = "names are made of letters, digits and `_`, and begin with a letter"
BOUNDS = "bounds of time cannot be written; `next` goes one step ahead, `previously` one back"
FORMULAS = [
    ("p => q", "=>", "write `implies` or `->`"),
    ("p → q", "→", "write `implies` or `->`"),
    ("p == q", "==", COMPARED),
    ("p = q", "=", COMPARED),
    ("if p then q", "p", "write `p implies q` for `if p then q`"),
    ("eventualy p", "p", "did you mean `eventually`?"),
    ("p untl q", "untl", "did you mean `until`?"),
    ("b-v", "-", NAMES),
    ("1p", "1p", NAMES),
    ("p // why", "//", "a comment begins with `#`"),
    ("p <=> q", "<=>", "write `iff` or `<->`"),
    ("p ∧ q", "∧", "write `and` or `&`"),
    ("p ∨ q", "∨", "write `or` or `|`"),
    ("~p", "~", "write `not` or `!`"),
    ("¬p", "¬", "write `not` or `!`"),
    ("□ p", "□", "write `always` or `G`"),
    ("◇ p", "◇", "write `eventually` or `F`"),
    ("○ p", "○", "write `next` or `X`"),
    ("p OR q", "OR", "write `or` or `|`"),
    ("p Until q", "Until", "write `until` or `U`"),
    ("nevr p", "p", "did you mean `never`?"),
    ("onse p", "p", "did you mean `once`?"),
    ("p sinc q", "sinc", "did you mean `since`?"),
    ("p than q", "than", "did you mean `then`?"),
    ("p and then q", "then", "`then` stands alone between two phases: write `p then q`"),
    ("if not p then q", "not", "write `p implies q` for `if p then q`"),
    ("⧫ p", "⧫", "write `once` or `O`"),
    ("Previously p", "p", "did you mean `previously`?"),
    ("GHp p", "p", ""),
    ("OH p", "p", "`OH` is read as one name; write `O H`"),
    ("always[<= 3 s] p", "[", BOUNDS),
    ("O[<= 3 s] p", "[", BOUNDS),
    ("p since[<= 3 s] q", "[", BOUNDS),
    ("p U[<= 3 s] q", "[", BOUNDS),
    ("p and [ q", "[", "write `always` or `G`"),
    ("speed < 50", "<", "formulas are about signals and values; numbers cannot be compared"),
    ("gap >= 2", ">=", "formulas are about signals and values; numbers cannot be compared"),
    ("weak p", "weak", "`weak` stands before `until`, `next` or `previously`"),
    ("p weak since q", "weak", "`weak` stands before `until`, `next` or `previously`"),
    ("p strong until q", "strong", "`strong` stands before `release`"),
    ("(p & q))", ")", "delete the `)`, or open it before"),
    ("p;", ";", "delete the `;`"),
    ("'p'", "'p'", 'texts stand in straight double quotes: "…"'),
]


def check(found, underlined, way_out):
    assert found.help == way_out
    place = found.place
    assert place.excerpt[place.column - 1 : place.end_column - 1] == underlined


@pytest.mark.parametrize(("text", "underlined", "way_out"), FORMULAS)
def test_in_a_formula(text, underlined, way_out):
    with pytest.raises(RulecError) as caught:
        parse_formula(text)
    (one,) = caught.value.diagnostics
    check(one, underlined, way_out)


LINES = [
    ("title 'A'", "'A'", 'texts stand in straight double quotes: "…"'),
    ('title = "A"', "=", "delete the `=`"),
    ('title: "A"', ":", "delete the `:`"),
    ("title A", "A", 'put the text in double quotes: "…"'),
    ("law «A»", "«", 'texts stand in straight double quotes: "…"'),
    ("signal p q", "q", "separate the names by `,`"),
    ("signal p; q", ";", "separate the names by `,`"),
    (
        "signal p default 1",
        "1",
        "a signal is true or false: write `default true` or `default false`",
    ),
    ("x is a, b", "a", "the values stand behind `is one of`, such as `is one of a, b`"),
    ("x is one of a or b", "or", "separate the names by `,`"),
    ("sgnal p", "sgnal", "did you mean `signal`?"),
    ("import p", "import", ""),
    ("use paper, road", ",", "write a `use` line for each vocabulary"),
    ("use my words", "words", "a name is one word, such as `my_words`"),
    ('law "A" 2020', "2020", 'the line is written `law "…"` or `law "…" as of 2006-03-28`'),
    ("hard rule no-u { require p }", "-", NAMES),
    ('hard rule "A" { require p }', '"A"', NAMES),
    ("hard rule a { p -> q }", "p", "a formula stands behind `require`"),
    ("colour", "colour", "an enumeration is declared by `colour is one of a, b`"),
    ("hard a { require p }", "a", "write `hard rule a`"),
    ("soft a { require p }", "a", "write `soft rule a`"),
    ("rule a { require p }", "rule", "a rule begins with `hard rule` or `soft rule`"),
    ("sotf rule a { require p }", "sotf", "did you mean `soft`?"),
    (
        "hard rule a (v car) { require p }",
        "car",
        "a variable is written with its type, such as `v: vehicle`",
    ),
    ("hard rule a () { require p }", ")", "a rule without variables has no parentheses"),
    (
        "hard rule a { require p accept { p, q } }",
        ",",
        "states are separated by `;`, the facts of one state by `and`",
    ),
    (
        "hard rule a { require p accept { p or q } }",
        "or",
        "a state says what holds; for another possibility write another example",
    ),
    (
        "hard rule a { require p accept { p; X q } }",
        "X",
        "a state holds atoms and `not` before a signal; no other operator",
    ),
    (
        "hard rule a { require p accept { p then q } }",
        "then",
        "a state holds atoms and `not` before a signal; no other operator",
    ),
    (
        "hard rule a { require p accept { p; O q } }",
        "O",
        "a state holds atoms and `not` before a signal; no other operator",
    ),
    (
        "hard rule a { require p accept { p; } }",
        "",
        "say what holds in this state; a `;` stands only between two states",
    ),
    ('hard rule a { require p says "a "b" c" }', "b", 'a quote inside a text is written \\"'),
    ("hard rule a { require p; }", ";", "delete the `;`"),
    ("hard rule a { require p\nsay 'no' }", "say", "did you mean `says`?"),
]


@pytest.mark.parametrize(("line", "underlined", "way_out"), LINES)
def test_in_a_line(line, underlined, way_out):
    text = f"rulebook a\n{line}\nhard rule last {{ require p }}\n"
    _, (one,) = parse(Source("a.rules", text))
    check(one, underlined, way_out)


EXPECTED = [
    ("p and", "expected an atom, `not`, or `(`"),
    ("p q", "expected an operator such as `and`"),
    ("(p", "expected `)`"),
    ("", "expected an atom, `not`, or `(`"),
]


@pytest.mark.parametrize(("text", "expected"), EXPECTED)
def test_what_was_expected_is_said_in_words(text, expected):
    with pytest.raises(RulecError) as caught:
        parse_formula(text)
    (one,) = caught.value.diagnostics
    assert one.expected == expected
    assert one.place.column == len(text) + 1 or text == "p q"


def test_an_open_parenthesis_is_shown():
    with pytest.raises(RulecError) as caught:
        parse_formula("(p) & (q -> (r)")
    (label,) = caught.value.diagnostics[0].labels
    assert label.place.column == 7
