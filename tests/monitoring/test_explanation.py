"""Explanations: the right states, and values that are those of direct evaluation."""

from dataclasses import replace
from fractions import Fraction
from functools import partial

import pytest
from click import unstyle
from hypothesis import assume, given

from rulec.automata.compiler import compile_rulebook
from rulec.logic.formula import Binary, BinaryOperator, Bound, Unary, UnaryOperator, atoms_of
from rulec.logic.semantics import truth_values
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.explain import explanation
from rulec.monitoring.explain.explanation import explain, states_to_explain
from rulec.monitoring.limits import LIMITS, MonitoringLimits
from rulec.monitoring.uncertainty.known_words import KnownLetters
from rulec.report.json_document import as_builtins
from rulec.report.verdicts import violation_table as report
from rulec.report.verdicts.verdict_json import explanation_data
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rulebook_model import Rulebook
from rulec.trace import Trace
from support.builders.measured_vocabulary import MEASURED, SPEED, closer, gap, number, others_near
from support.builders.rulebooks import (
    P,
    Q,
    always,
    book,
    both,
    compile_here,
    eventually,
    far,
    implies,
    near,
    no,
    rule,
)
from support.generators.random_formulas import formulas, letters, parts_of, words

CARS = {"car1": "car", "car2": "car"}


def trace_of(word):
    return Trace("t", 1.0, {"car1": "car"}, tuple(word))


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(formula=formulas, word=words)
def test_the_formulas_values_are_those_of_direct_evaluation(semantics, formula, word):
    x = ("x: car",) if any(atom.arguments for atom in atoms_of(formula)) else ()
    rules = compile_here(replace(book(rule("A", formula, *x)), semantics=semantics))
    trace = trace_of(word)
    violations = verify(trace, rules).violations
    assume(violations)
    explained = explain(violations[0], trace, rules)
    assert explained.states == tuple(range(len(word)))
    assert list(explained.parts[0].values) == truth_values(formula, letters(word), semantics)
    assert not explained.parts[0].values[0]
    expected = [truth_values(part, letters(word), semantics) for part in parts_of(formula)]
    assert [list(part.values) for part in explained.parts] == expected
    assert {fact.text for fact in explained.facts} == {
        f"{atom.name}(car1)" if atom.arguments else atom.name for atom in atoms_of(formula)
    }
    for shown in (*explained.facts, *explained.parts):
        at = explained.decisive
        assert shown.changed == (at > 0 and shown.values[at] != shown.values[at - 1])


@given(formula=formulas, word=words)
def test_the_states_of_a_window_violate_the_rule_like_all(formula, word):
    x = ("x: car",) if any(atom.arguments for atom in atoms_of(formula)) else ()
    rules = compile_here(book(rule("A", formula, *x)))
    trace = trace_of([*word, *word, *word])
    violations = verify(trace, rules).violations
    assume(violations)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(explanation, "LIMITS", MonitoringLimits(states_explained=1))
        explained = explain(violations[0], trace, rules)
        machine, decisive = rules.rules[0].machine, explained.decisive
        letters_of = KnownLetters(trace, rules)
        of = partial(letters_of.word, rules.rules[0], violations[0].binding)
        numbers = states_to_explain(machine, range(len(trace.states)), decisive, of)
    assert numbers[0] == 0
    assert {decisive - 1, decisive, decisive + 1} & set(range(len(trace.states))) <= set(numbers)
    assert len(numbers) <= len(machine.successors) + 4
    window = replace(trace, states=tuple(trace.states[number] for number in numbers))
    (again,) = verify(window, rules).violations
    assert (again.step is None) == (violations[0].step is None)
    assert numbers[-1 if again.step is None else again.step] == decisive
    assert (explained.looked_at is None) == (len(numbers) == len(trace.states))
    if explained.looked_at:
        assert explained.repair is None
        first, last = explained.lasts
        assert explained.looked_at[0] <= first <= decisive <= last <= explained.looked_at[1]
        assert not explained.parts[0].values[0]


def place(text):
    return {"place": {"car1": {"n": "near", "f": "far"}[text]}, "q": False}


def test_a_long_trace_is_shown_around_the_decisive_state():
    rules = compile_here(book(rule("A", always(no(near("x"))), "x: car")))
    trace = trace_of([place("f")] * 40 + [place("n")] + [place("f")] * 40)
    (violation,) = verify(trace, rules).violations
    explained = explain(violation, trace, rules)
    assert violation.step == explained.decisive == 40
    assert explained.states == (0, *range(33, 42))
    assert len(explained.states) == LIMITS.states_shown
    assert explained.facts[0].values == ("far",) * 8 + ("near", "far")


def test_without_a_step_the_end_decides():
    rules = compile_here(book(rule("A", eventually(Q))))
    trace = trace_of([place("f")] * 3)
    (violation,) = verify(trace, rules).violations
    assert violation.step is None
    assert explain(violation, trace, rules).decisive == 2


def test_the_bound_objects_and_their_stretch():
    rules = compile_here(
        book(rule("A", always(implies(near("x"), no(far("y")))), "x: car", "y: car"))
    )
    states = [{"place": {"car1": "near", "car2": "far"}, "q": False}] * 4
    trace = Trace("t", 1.0, CARS, tuple(states), {"car2": (1, 2)})
    (violation,) = verify(trace, rules).violations
    explained = explain(violation, trace, rules)
    assert explained.states == (1, 2)
    assert [fact.text for fact in explained.facts] == ["place(car1)", "place(car2)"]


def measured(formula, states, *variables, **more):
    """The explanation of the only violation, by a rule over quantities."""
    rules = compile_here(Rulebook("test", MEASURED, (rule("A", formula, *variables),)))
    objects = {name: "car" for state in states for name in state.get("place", state.get("gap", {}))}
    trace = Trace("t", 1.0, objects, tuple(states), **more)
    violation = verify(trace, rules).violations[0]
    return explain(violation, trace, rules)


def test_a_number_is_shown_with_its_unit_and_the_comparison_with_its_value():
    found = measured(
        always(no(closer("v", "1.5"))), [{"gap": {"a": n}} for n in (3, 2.5, 1.4)], "v: car"
    )
    (fact,) = found.facts
    assert (fact.text, fact.unit, fact.values, fact.objects) == ("gap(a)", "m", (3, 2.5, 1.4), None)
    assert [part.text for part in found.parts][-1] == "gap(v) < 1.5 m"
    assert found.parts[-1].values == (False, False, True)


def test_a_number_stands_out_when_it_passes_a_limit_not_whenever_it_changes():
    """The speed changes too, and the rule does not mind; at the gap it does."""
    rising = number("speed > 30 km/h", ">", 30, (1, SPEED))
    states = [{"gap": {"a": n}, "speed": 40 + n} for n in (3, 2.5, 1.4)]
    found = measured(always(no(both(closer("v", "1.5"), rising))), states, "v: car")
    assert {fact.text: fact.changed for fact in found.facts} == {"gap(a)": True, "speed": False}
    assert {part.text: part.changed for part in found.parts[-2:]} == {
        "gap(v) < 1.5 m": True,
        "speed > 30 km/h": False,
    }
    wide = report.TableOptions(width=100)
    rows = [line.split() for line in unstyle(report.as_text(found, wide)).splitlines()]
    assert ["gap(a)", "in", "m", "3", "2.5", "1.4*"] in rows
    assert ["speed", "in", "km/h", "43", "42.5", "41.4"] in rows
    data = as_builtins(explanation_data(found))
    assert data["facts"][0] == {
        "reads": "gap(a)",
        "values": [3, 2.5, 1.4],
        "changed": True,
        "decides": True,
        "unit": "m",
    }
    assert data["parts"][-2]["changed"] is True
    assert data["parts"][-2]["decides"] is True


def test_what_makes_no_difference_does_not_decide():
    """Who is closer than 1.5 m has lost, however fast."""
    fast = number("speed > 30 km/h", ">", 30, (1, SPEED))
    either = Binary(BinaryOperator.OR, closer("v", "1.5"), fast)
    found = measured(always(no(either)), [{"gap": {"a": 1}, "speed": 40}], "v: car")
    assert {fact.text: fact.decides for fact in found.facts} == {"gap(a)": True, "speed": False}
    assert [part.text for part in found.parts if not part.decides] == ["speed > 30 km/h"]


def test_a_sum_shows_its_numbers():
    mixed = number("gap(v) < speed", "<", 0, (1, gap("v")), (-1, SPEED))
    found = measured(always(no(mixed)), [{"gap": {"a": 60}}, {"gap": {"a": 49.5}}], "v: car")
    assert [(fact.text, fact.values) for fact in found.facts] == [
        ("gap(a)", (60, 49.5)),
        ("speed", (50.0, 50.0)),
    ]


def test_a_count_says_whom_it_counts():
    crowd = number("count x: car (…) >= 2", ">=", 2, (1, others_near("v")))
    places = [{"a": "near"}, {"a": "near", "b": "near", "c": "far"}, dict.fromkeys("abc", "near")]
    found = measured(
        always(no(crowd)),
        [{"place": one} for one in places],
        "v: car",
        present={"b": (1, 2), "c": (1, 2)},
    )
    (fact,) = found.facts
    assert fact.text == "count x: car (near(x) and not x = v)"
    assert fact.values == (0, 1, 2)
    assert fact.objects == ((), ("b",), ("b", "c"))
    assert fact.changed
    text = unstyle(report.as_text(found))
    assert "2: b, c*" in text
    assert as_builtins(explanation_data(found))["facts"][0]["objects"] == ((), ("b",), ("b", "c"))


def test_many_names_are_cut():
    crowd = number("count x: car (…) >= 2", ">=", 2, (1, others_near("v")))
    places = {f"vehicle{n}": "near" for n in range(12)}
    text = report.as_text(measured(always(no(crowd)), [{"place": places}], "v: car"))
    assert "11: vehicle1, vehic…" in text


def test_bounds_in_seconds_are_those_of_the_trace():
    soon = Unary(UnaryOperator.EVENTUALLY, Q, Bound(Fraction(0), Fraction(1), "s"))
    rulebook = book(rule("A", always(implies(P, soon))))
    rules = compile_here(rulebook, Fraction(1, 2))
    states = [{"p": n == 1, "q": n == 4} for n in range(5)]
    trace = Trace("t", 0.5, {}, tuple(states))
    (violation,) = verify(trace, rules).violations
    found = explain(violation, trace, rules)
    values = {part.text: part.values for part in found.parts}
    assert found.decisive == 3
    assert values["eventually[<= 1 s] q"] == (False, False, True, True, True)


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (0.1, "0.1"),
        (5.0, "5"),
        (-0.0, "0"),
        (1.4999999999, "1.4999999999"),
        (1e300, "1.00000000000e+300"),
        (10**400, "1.00000000000e+400"),
        (5e-324, "4.94065645841e-324"),
    ],
)
def test_numbers_are_shown_so_that_they_can_be_told_from_the_limit(value, shown):
    assert report.shown(value) == shown


def test_a_number_that_passes_one_of_its_limits_has_changed():
    text = (
        "rulebook r quantity gap in m hard rule r { require always (gap < 5 m implies gap > 1 m) }"
    )
    rules = compile_rulebook(parse_rulebook(text))
    trace = Trace("t", 1.0, {}, ({"gap": 3}, {"gap": 0.5}))
    (violation,) = verify(trace, rules).violations
    (gap,) = explain(violation, trace, rules).facts
    assert gap.changed


@pytest.mark.parametrize(
    ("body", "places", "lasts"),
    [
        # Near from the third state on, and at its end far: it began when it was far last
        ("far(x) then near(x) then far(x)", "fffnnnff", (2, 6)),
        # So did what has to last for two seconds, those of states 3 and 4, though it goes on
        ("true then near(x) then[>= 2 s] true", "fffnnnnn", (2, 4)),
        # What has no phases is broken for as long as it holds
        ("near(x)", "fffnnnff", (3, 5)),
    ],
)
def test_what_takes_its_course_lasts_from_where_it_begins(body, places, lasts):
    text = (
        "rulebook b\ntype car\nplace(x: car) is one of near, far default far\n"
        f"hard rule A (x: car) {{ require never ({body}) }}\n"
    )
    rules = compile_rulebook(parse_rulebook(text))
    states = tuple({"place": {"car1": {"n": "near", "f": "far"}[one]}} for one in places)
    trace = Trace("t", 1.0, {"car1": "car"}, states)
    (violation,) = verify(trace, rules).violations
    explained = explain(violation, trace, rules)
    assert explained.lasts == lasts
    assert explained.lasts[0] <= explained.decisive == violation.step
