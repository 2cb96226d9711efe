"""Whether examples exercise their rule: which verdicts it has, and which of them are shown."""

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from rulec import compile_rulebook
from rulec.book_tests.example_coverage import uncovered_verdicts, verdicts
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.rulebook.loader import parse_rulebook

HEAD = "rulebook sample\nsignal p, q default false\nquantity v in m default 0\n"


def run_of(*rules, pattern=None):
    rulebook = parse_rulebook(HEAD + "\n".join(rules))
    return run_rulebook_examples(
        rulebook, compile_rulebook(rulebook), patterns=() if pattern is None else (pattern,)
    )


def said(*rules, pattern=None):
    return [one.message for one in uncovered_verdicts(run_of(*rules, pattern=pattern))]


KEPT, BROKEN = "accept { p and q }", "reject { p }"
REQUIRE = "hard rule A { require always (p implies q) %s }"


@pytest.mark.parametrize(
    ("examples", "expected"),
    [
        ("", ["rule `A` has no example"]),
        (KEPT, ["no example breaks rule `A`"]),
        (f"{KEPT} accept {{ q }}", ["no example breaks rule `A`"]),
        (BROKEN, ["no example keeps rule `A`"]),
        (f"{KEPT} {BROKEN}", []),
        # What fails has to be mended first.
        ("accept { p }", []),
        (f"{KEPT} reject {{ q }}", []),
    ],
)
def test_both_verdicts_have_to_be_shown(examples, expected):
    assert said(REQUIRE % examples) == expected


@pytest.mark.parametrize(
    ("formula", "expected"),
    [
        ("p", {True, False}),
        ("true", {True}),
        ("never (p and not p)", {True}),
        ("p and not p", {False}),
        ("next next p", {True, False}),
        # No number is above 3 and below 2.
        ("never (v > 3 m and v < 2 m)", {True}),
        ("eventually (v > 3 m and v < 2 m)", {False}),
    ],
)
def test_the_verdicts_that_a_rule_has(formula, expected):
    run = run_of(f"hard rule A {{ require {formula} }}")
    assert verdicts(run.compiled.rules[0].machine, run.compiled.vocabulary) == expected


def test_states_that_a_fact_rules_out_show_nothing():
    run = run_of("fact not (p and q)", "hard rule A { require never (p and q) accept { p } }")
    assert verdicts(run.compiled.rules[0].machine, run.compiled.vocabulary) == {True}
    assert list(uncovered_verdicts(run)) == []


def test_a_verdict_that_a_rule_never_has_is_not_asked_for():
    assert said("hard rule A { require never (p and not p) accept { p } }") == []
    assert said("hard rule A { require p and not p reject { p } }") == []


def test_a_warning_says_where_and_what_to_write():
    (one,) = uncovered_verdicts(run_of(REQUIRE % KEPT))
    assert (one.code, one.severity, one.place.line) == ("R0408", "warning", 4)
    assert one.expected == "expected `reject { … }`"
    assert one.notes == ("all of its examples would also pass if it required nothing",)
    (one,) = uncovered_verdicts(run_of(REQUIRE % ""))
    assert one.expected == "expected `accept { … }` and `reject { … }`"
    (one,) = uncovered_verdicts(run_of(REQUIRE % BROKEN))
    assert one.notes == ("all of its examples would also pass if it forbade everything",)


def test_a_chosen_few_need_not_show_everything():
    assert said(REQUIRE % KEPT, pattern="*") == []


words = st.lists(st.sampled_from(["p", "q", "p and q", "not p"]), min_size=1, max_size=3)


@settings(max_examples=settings().max_examples // 10)  # each starts Spot four times
@given(st.sampled_from(["p", "eventually q", "p until q", "always (p implies next q)"]), words)
def test_a_rule_with_an_example_and_its_opposite_is_exercised(formula, states):
    """A formula and its denial: one accepts the word, the other one rejects it."""
    word = "; ".join(states)
    warned = [
        one
        for rule in (formula, f"not ({formula})")
        for verdict in ("accept", "reject")
        for one in said(f"hard rule A {{ require {rule} {verdict} {{ {word} }} }}")
    ]
    # Of each rule the example with the right verdict passes, and is alone.
    assert sorted(warned) == ["no example breaks rule `A`", "no example keeps rule `A`"]
