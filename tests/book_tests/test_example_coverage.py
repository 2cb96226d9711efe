"""Coverage: what it counts, and that the examples it proposes do what it says of them."""

from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.strategies import composite

from rulec import compile_rulebook
from rulec.book_tests.example_coverage import coverage, percent
from rulec.book_tests.example_runs import run_rulebook_examples
from rulec.logic.formula import Atom
from rulec.logic.printing import formula_text
from rulec.report.tests.example_text import missing_example
from rulec.rulebook.loader import parse_rulebook

HEAD = """rulebook sample
type t
signal p, q default false
signal near(v: t)
light(v: t) is one of red, amber, green, off
only is one of lone
signal heavy, wide(v: t) default false
quantity mass in t default 1.5
constant heavy, wide, mass
"""


def covered(*rules, pattern=None):
    rulebook = parse_rulebook(HEAD + "\n".join(rules))
    return coverage(
        run_rulebook_examples(
            rulebook, compile_rulebook(rulebook), patterns=() if pattern is None else (pattern,)
        )
    )


WORDS = parse_rulebook(HEAD + "hard rule A { require p }").vocabulary


def test_edges_and_values_are_counted():
    # Until `p` there are two edges: staying, and leaving for good.
    (one,) = covered("hard rule A { require eventually p accept { not p; p } reject { not p } }")
    assert (one.n_edges, one.missing_edges, one.n_values, one.missing_values) == (2, (), 2, ())
    assert percent([one]) == 100


def test_what_is_missing_is_said():
    (one,) = covered("hard rule A { require eventually p reject { not p; not p } }")
    (edge,) = one.missing_edges
    assert (edge.source, edge.accepted) == (0, True)
    assert edge.target != 0
    assert missing_example(edge, WORDS) == "accept { p }"
    assert one.missing_values == ((Atom("p"), True),)
    assert (one.total, one.covered, percent([one])) == (4, 2, 50)


def test_a_default_is_seen_too():
    (one,) = covered("hard rule A { require always (p implies q) accept { p and q } }")
    assert set(one.missing_values) == {(Atom("p"), False), (Atom("q"), False)}
    (one,) = covered("hard rule A { require always (p implies q) accept { p and q; q } }")
    assert one.missing_values == ((Atom("q"), False),)


def test_a_value_that_can_only_be_true_need_not_be_false():
    (one,) = covered("hard rule A { require eventually (lone and p) accept { lone and p } }")
    assert one.n_values == 3
    assert one.missing_values == ((Atom("p"), False),)


def test_an_atom_that_stands_twice_counts_once():
    (one,) = covered("hard rule A { require p until (q and next p) }")
    assert one.n_values == 4


def test_a_rule_that_is_settled_has_nothing_to_cover():
    (one,) = covered("hard rule A { require true }")
    assert (one.total, percent([one]), percent([])) == (0, 100, 100)


def test_with_a_pattern_only_rules_that_ran_count():
    rules = [f"hard rule {name} {{ require p accept {{ p }} }}" for name in "AB"]
    assert [one.rule for one in covered(*rules)] == ["A", "B"]
    assert [one.rule for one in covered(*rules, pattern="B")] == ["B"]


def test_a_value_that_the_rule_does_not_name_stands_for_the_others():
    (one,) = covered("hard rule A (v: t) { require always not red(v) }")
    assert [missing_example(edge, WORDS) for edge in one.missing_edges] == [
        "reject { red(v) }",
        "accept { amber(v) }",
    ]


def test_a_trace_is_proposed_in_which_nothing_changes_that_cannot():
    (one,) = covered("hard rule A { require always (previously p and heavy implies q) }")
    assert {missing_example(edge, WORDS) for edge in one.missing_edges} == {
        "accept { true }",
        "accept { p }",
        "accept { heavy }",
        "reject { p and heavy }",  # as the state stays, p was before
        "accept { p; true }",
        "accept { p; p }",
        "reject { p and heavy and q; heavy }",
        "reject { p and heavy and q; p and heavy }",
    }


def test_edges_that_only_a_change_of_what_cannot_change_would_take_do_not_count():
    (one,) = covered("hard rule A { require always (previously heavy implies heavy) }")
    assert {missing_example(edge, WORDS) for edge in one.missing_edges} == {
        "accept { true }",
        "accept { heavy }",
        "accept { heavy; heavy }",
    }


def test_a_number_that_cannot_change_is_close_to_its_limit_in_all_states():
    (one,) = covered("hard rule A { require always (previously p implies mass <= 3.5 t) }")
    assert {missing_example(limit.example, WORDS) for limit in one.missing_limits} == {
        "accept { p and mass = 3.5 t; mass = 3.5 t }",
        "reject { p and mass = 3.6 t; mass = 3.6 t }",
    }


ATOMS = ["p", "q", "near(v)", "red(v)", "green(v)", "heavy", "wide(v)", "mass > 2 t"]


@composite
def formulas(draw, depth=3):
    if depth == 0 or draw(st.booleans()):
        return draw(st.sampled_from(ATOMS))
    operator = draw(st.sampled_from(["not", "always", "eventually", "next", "until", "and", "or"]))
    inside = f"({draw(formulas(depth - 1))})"
    if operator in ("until", "and", "or"):
        return f"{inside} {operator} ({draw(formulas(depth - 1))})"
    return f"{operator} {inside}"


@given(formulas())
@settings(max_examples=25)
def test_with_every_proposed_example_everything_is_covered(formula):
    rule = f"require {formula}"
    (before,) = covered(f"hard rule A (v: t) {{ {rule} }}")
    assert len(before.missing_edges) == before.n_edges
    examples = "\n".join(missing_example(edge, WORDS) for edge in before.missing_edges)
    rulebook = parse_rulebook(f"{HEAD}hard rule A (v: t) {{ {rule}\n{examples} }}")
    run = run_rulebook_examples(rulebook, compile_rulebook(rulebook))
    assert all(one.passed for one in run.outcomes), formula_text(rulebook.rules[0].formula)
    (after,) = coverage(run)
    assert after.missing_edges == ()
