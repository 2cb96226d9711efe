"""The nearest trace that keeps a rule: no other is nearer, and all that is said to do does."""

from dataclasses import replace
from fractions import Fraction
from itertools import product

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from rulec.automata.compiler import compile_rulebook
from rulec.logic.formula import atoms_of
from rulec.logic.semantics import holds
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.explain.explanation import explain
from rulec.monitoring.explain.nearest_satisfying import nearest_satisfying
from rulec.monitoring.limits import LIMITS
from rulec.report.json_document import as_builtins
from rulec.report.verdicts import violation_table as report
from rulec.report.verdicts.verdict_json import explanation_data
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from support.builders.rulebooks import book, compile_here, rule
from support.generators.random_formulas import ATOMS, formulas

small_formulas = formulas.filter(lambda one: len(set(atoms_of(one))) <= 3)


def compiled(formula, semantics):
    x = ("x: thing",) if any(atom.arguments for atom in atoms_of(formula)) else ()
    rules = compile_here(replace(book(rule("A", formula, *x)), semantics=semantics))
    return rules.rules[0].machine


def letters_of(machine):
    return list(product(*[range(one.size) for one in machine.reads]))


def atoms_in(machine, letter):
    """The atoms that are true where a machine reads a letter, by what the reads mean."""
    return {
        atom
        for atom in ATOMS
        for one, digit in zip(machine.reads, letter, strict=True)
        if one.name == atom.name and one.digit(True if atom.value is None else atom.value) == digit
    }


def distances(one, other):
    return [sum(a != b for a, b in zip(x, y, strict=True)) for x, y in zip(one, other, strict=True)]


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(formula=small_formulas, chosen=st.lists(st.integers(0, 1 << 16), min_size=1, max_size=3))
def test_no_word_that_holds_is_nearer(semantics, formula, chosen):
    machine = compiled(formula, semantics)
    every = letters_of(machine)
    assume(len(every) ** len(chosen) <= 2000)
    word = [every[one % len(every)] for one in chosen]
    holding = {
        other
        for other in product(every, repeat=len(word))
        if holds(formula, [atoms_in(machine, one) for one in other], semantics)
    }
    changes = nearest_satisfying(machine, word)
    if not holding:
        assert changes is None
        return
    # The fewest changes, and the latest of these.
    best = min((sum(found := distances(word, one)), found) for one in holding)
    assert [one.place for one in changes] == [n for n, some in enumerate(best[1]) if some]
    for mended in mendings(machine, word, changes):
        assert mended in holding
        assert distances(word, mended) == best[1]
    if len(changes) == 1:
        # Then nothing that does is left out.
        nearest = {one for one in holding if distances(word, one) == best[1]}
        listed = set(mendings(machine, word, changes))
        assert listed == nearest or len(changes[0].cubes) == LIMITS.repairs_listed


def mendings(machine, word, changes):
    """The word with all changes made, in every way that is listed for each of them."""
    ways = [[letter] for letter in word]
    for change in changes:
        ways[change.place] = [
            letter
            for cube in change.cubes
            for letter in product(
                *[
                    [was] if len(digits) == read.size else sorted(digits)
                    for read, was, digits in zip(
                        machine.reads, word[change.place], cube, strict=True
                    )
                ]
            )
        ]
    return [tuple(mended) for mended in product(*ways)]


BOOK = """rulebook nearest
type car
signal p, q, r default false
quantity speed in m/s default 5
quantity room in m default 5
place(c: car) is one of near, far, gone default far
fact not (p and q)

hard rule fact_stands { require always (p implies (q or r)) }
hard rule numbers {
  require eventually (
    (speed > 5 m/s and room > 0 m and room + 1 s * speed < 3 m) or (p and r)
  )
}
hard rule nobody { require always (p and q) }
hard rule many { require always (count c: car (near(c)) <= 1) }
soft rule limit (c: car) { require always (near(c) implies speed <= 3 m/s) }
"""
RULES = compile_rulebook(parse_rulebook(BOOK), step_s=Fraction(1))
CARS = {"a": "car", "b": "car"}


def explained(name, *states):
    """What the report says would have kept the rule, above the table of its first violation."""
    trace = Trace("t", 1.0, CARS, states)
    violation = next(one for one in verify(trace, RULES).violations if one.rule == name)
    found = explain(violation, trace, RULES)
    text = [line.strip() for line in report.as_text(found).splitlines()]
    at = next(n for n, line in enumerate(text) if line.startswith(("kept if", "no trace")))
    table = next(n for n, line in enumerate(text) if line.startswith("state "))
    return text[at:table], as_builtins(explanation_data(found))["repair"]


def test_what_facts_exclude_is_no_way_out():
    # `q` would do, too, if it could be the case together with `p`.
    assert explained("fact_stands", {"p": True})[0] == ["kept if state 0 says: not p or r"]


def test_numbers_that_contradict_each_other_are_no_way_out():
    # Of the sum alone too little is wrong, were it not the sum of the other two.
    text, data = explained("numbers", {"speed": 6, "room": 1})
    assert text == ["kept if state 0 says: p and r"]
    assert data == [{"state": 0, "says": "p and r"}]


def test_nothing_helps_a_rule_that_cannot_be_kept():
    text, data = explained("nobody", {}, {})
    assert text == ["no trace of as many states keeps it"]
    assert data is None


def test_a_count_is_changed_as_a_number():
    states = {"place": {"a": "near", "b": "near"}}
    text, _ = explained("many", {}, states, {}, states, states)
    assert text == ["kept if states 1, 3-4 say: count c: car (near(c)) <= 1"]


def test_states_with_other_ways_out_have_lines_of_their_own():
    near = {"place": {"a": "near"}}
    text, data = explained("limit", near, {**near, "speed": 3}, near)
    assert text == ["kept if states 0, 2 say: not near(c) or speed <= 3 m/s"]
    assert [one["state"] for one in data] == [0, 2]


TURNS = """rulebook turns
semantics finite
signal q, r default false
hard rule turns { require always ((q or r) and (q implies weak next not q)) }
"""


def test_only_the_last_change_is_free_to_lead_elsewhere():
    # With `r` in state 0, what is said of state 2 would not do: `q` there is free only behind `r`.
    rules = compile_rulebook(parse_rulebook(TURNS), step_s=Fraction(1))
    trace = Trace("t", 1.0, {}, ({}, {"r": True}, {}))
    (violation,) = verify(trace, rules).violations
    text = report.as_text(explain(violation, trace, rules)).splitlines()
    assert [line.strip() for line in text if " if state" in line] == [
        "kept if state 0 says: q",
        "and if state 2 says: q or r",
    ]


def test_states_are_those_of_the_trace_where_an_object_comes_late():
    near = {"place": {"a": "near"}}
    trace = Trace("t", 1.0, CARS, ({}, {}, near, {}, near), present={"a": (2, 4), "b": (0, 1)})
    (violation,) = [one for one in verify(trace, RULES).violations if one.rule == "limit"]
    found = explain(violation, trace, RULES)
    assert [one.place for one in found.repair] == [2, 4]


def test_many_stretches_are_not_all_listed():
    states = [{"place": {"a": "near"}, "speed": 5 if n % 2 else 1} for n in range(29)]
    text, data = explained("limit", *states)
    listed = ", ".join(str(n) for n in range(1, 24, 2))
    says = "not near(c) or speed <= 3 m/s"
    assert " ".join(text) == f"kept if states {listed}, … (2 more) say: {says}"
    assert len(data) == 14
