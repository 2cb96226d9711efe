"""Hostile sizes and depths: a clear error, soon."""

import subprocess
import sys

import pytest

from rulec.diagnostics import RulecError, Source
from rulec.files.read_files import MAX_SOURCE_BYTES as MAX_BYTES
from rulec.rulebook.loader import parse_rulebook
from rulec.syntax import decode, parse, parse_formula, print_formula
from support.builders.counted_steps import grows_in_proportion

HEAD = "rulebook big\nsignal p, q\nhard rule r { require "


def only(text):
    with pytest.raises(RulecError) as caught:
        parse_rulebook(text)
    (one,) = caught.value.diagnostics
    return one


def test_two_hundred_levels_are_read_and_printed_and_no_more():
    deepest = parse_formula("!" * 200 + "p")
    assert parse_formula(print_formula(deepest)) == deepest
    with pytest.raises(RulecError) as caught:
        parse_formula("!" * 201 + "p")
    assert caught.value.diagnostics[0].code == "R0111"


@pytest.mark.parametrize(
    "formula",
    [
        "(" * 201 + "p" + ")" * 201,
        "!" * 300 + "p",
        "p" + " & p" * 300,
        "p" + " U p" * 300,
        "p -> (" * 250 + "p" + ")" * 250,
        "(" * 20_000,
        "!" * 20_000 + "p",
        "p" + "&p" * 20_000,
        "-" * 201 + "p > 0",
        "p > " + "-" * 20_000,
        "a" + " + a" * 300 + " > 0",
        "a" + " - (a" * 210 + ")" * 210 + " > 0",
        "always[<= 3 s] " * 201 + "p",
        "p" + " until[1 s .. 2 s] p" * 300,
        "some x: T (" * 201 + "p" + ")" * 201,
        "count x: T (" * 201 + "p" + ") > 1" * 201,
        "count x: T (" * 20_000,
        "(a if p else " * 201 + "a" + ")" * 201 + " > 0",
        "(a if " * 5_000,
        "a > (" + "a if p else " * 300 + "a)",
        "always[" * 20_000,
    ],
    ids=lambda formula: formula[:12],
)
def test_a_formula_too_deep_or_too_long_is_one_error(formula):
    one = only(f"{HEAD}{formula} }}")
    assert one.code == "R0111"
    assert one.place.line == 3
    assert "split" in one.help


def test_two_hundred_levels_of_a_rule_are_resolved():
    rulebook = parse_rulebook(f"{HEAD}{'p & (q -> ' * 66}p{')' * 66} }}")
    assert rulebook.rules[0].name == "r"


def test_a_file_too_large_is_one_error():
    with pytest.raises(RulecError) as caught:
        decode("big.rules", b"#" * (MAX_BYTES + 1))
    (one,) = caught.value.diagnostics
    assert (one.code, one.place.file) == ("R0102", "big.rules")
    assert only("#" * (MAX_BYTES + 1)).code == "R0102"


def test_a_file_of_too_many_signs_is_one_error():
    one = only("rulebook big\n" + ";" * 1_000_001)
    assert one.code == "R0102"
    assert one.place.line == 2


REPEATED = [
    ("", '"', ""),
    ("", "'", ""),
    ("", '"a\n', ""),
    ("", "{", ""),
    ("", "}", ""),
    ("", "a(", ""),
    ("", "a(b,\n", ""),
    ("", "vocabulary x\n", ""),
    ("", "rulebook x\n", ""),
    ("", "accept {\n", ""),
    ("", "hard rule r {\n", ""),
    ("", "hard rule r { require p }\n", ""),
    ("", "signal p\n", ""),
    ("", "x is one of a\n", ""),
    ("", "\n", "}"),
    ("rulebook x\nhard rule r { require (", "p & ", ")"),
    ("", "some x: T (", ""),
    ("", "always[", ""),
    ("", "always[<= 3 s]\n", ""),
    ("", "a <\n", ""),
    ("", "x y\n", ""),
    ("define a =\n", "x y\n", ""),
    ("define a = (\n", "sgnal y and\n", ""),
    ("", "silent on\n", ""),
    ("", "soften rule x\n", ""),
    ("", "param x = 3 m\n", ""),
    ("", "define f(x: T) = p\n", ""),
    ("", "priority a > b\n", ""),
    ("", "override rule r {}\n", ""),
    ("rulebook x\nhard rule r {\n", "unless p at end\n", "}"),
    ("rulebook x\nhard rule r {\n", "in force\n", "}"),
    ("rulebook x\nhard rule r { require p accept {\n", "v = 3 m;\n", "}}"),
    ("rulebook x\nfact a", " < b", ""),
    ("rulebook x\nfact a[", "(", ""),
]


@pytest.mark.parametrize(("before", "part", "behind"), REPEATED)
def test_repetition_takes_steps_in_proportion(before, part, behind):
    def read(size):
        parse(Source("hostile.rules", before + part * size + behind))

    assert grows_in_proportion(read, 400)


@pytest.mark.long
def test_repetition_does_not_hang():
    program = f"""
from rulec.diagnostics import Source
from rulec.syntax import parse
for before, part, behind in {REPEATED!r}:
    parse(Source("hostile.rules", before + part * (100_000 // len(part)) + behind))
"""
    subprocess.run([sys.executable, "-c", program], check=True, timeout=600)


def test_an_example_of_too_many_states_is_one_error_at_its_head():
    def with_states(number):
        return f"{HEAD}p\n  accept {{ {'; '.join(['p'] * number)} }}\n}}"

    assert len(parse_rulebook(with_states(10_000)).rules[0].examples[0].states) == 10_000
    one = only(with_states(10_001))
    assert (one.code, one.place.line) == ("R0111", 4)
    assert "10,001 states" in one.message
    assert "`rulec verify`" in one.help
