"""Constants are unknown once for a trace: verdicts are those of all values that they may have."""

from fractions import Fraction

import pytest
from hypothesis import Phase, given, settings

import rulec
from rulec.diagnostics import RulecError
from rulec.logic.free_names import names_in
from rulec.monitoring.batch.batch_verify import verify_many
from rulec.monitoring.batch.verify import verify
from rulec.trace import Trace
from rulec.vocabulary.partial_values import UNKNOWN
from support.builders.rulebooks import compile_here
from support.generators.blurred_traces import blurred, telling_numbers
from support.generators.constant_values import (
    steady,
    with_some_constant,
    with_unknown_constants,
)
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds
from support.oracles.completion_oracle import CompletionOracle, n_completions
from support.oracles.rulebook_oracle import Oracle, Said
from support.oracles.state_oracle import Reading

NUMBERS = telling_numbers()
MOST = 400
"""Completions that are gone through."""


@given(seeds)
@settings(phases=[Phase.generate])
def test_verdicts_are_those_of_all_values_of_constants(chance):
    book = with_some_constant(chance, rulebook(chance, Fraction(1)))
    compiled, oracle = compile_here(book, Fraction(1)), Oracle(book)
    constants = book.vocabulary.constants
    names = {n for x in (*book.rules, *book.axioms) for n in names_in(x.formula)}
    for whole in traces(chance, Fraction(1))[:3]:
        partial = steady(blurred(chance, whole, names - set(constants), most=2), constants)
        if any(
            set(state) & set(constants) != set(partial.states[0]) & set(constants)
            for state in partial.states
        ):
            continue
        partial = with_unknown_constants(chance, partial, constants)
        if n_completions(partial, book.vocabulary, NUMBERS) > MOST:
            continue
        completed = CompletionOracle(oracle, partial, NUMBERS)
        if completed.refused or not completed.answers:
            continue
        verdict = verify(partial, compiled)
        assert list(verify_many([partial] * 4, compiled)) == [verdict] * 4
        violated = {(x.rule, tuple(x.binding.values())) for x in verdict.violations}
        doubtful = {(x.rule, tuple(x.binding.values())): x for x in verdict.open}
        for rule in book.rules:
            for objects, _, _ in Reading(book, partial).choices(rule):
                key = rule.name, tuple(objects.values())
                expected = completed.verdict(*key)
                if key in doubtful and not doubtful[key].exact:
                    continue
                if isinstance(expected, Said):
                    assert key in violated, (key, partial, rule, constants)
                elif expected == "open":
                    assert key in doubtful, (key, partial, rule, constants)
                    on = doubtful[key].depends_on
                    assert on == completed.smallest(*key), (key, partial, rule, constants)
                else:
                    assert key not in violated, (key, partial, rule, constants)
                    assert key not in doubtful, (key, partial, rule, constants)


BOOK = """\
rulebook drive
type car
kind is one of a_car, a_truck, a_bus default a_car
quantity mass in t default 1.5
signal heavy(c: car) default false
signal fast default false
constant kind, mass, heavy
hard rule truck { require always (a_truck implies not fast) }
hard rule either { require (always not a_truck) or (always a_truck) }
hard rule few { require always (count c: car (heavy(c)) <= 5) }
"""


def judged(*states, objects=None, present=None, rule="truck"):
    trace = Trace("t", 1.0, objects or {}, states, present or {})
    compiled = rulec.compile(rulec.parse_rulebook(BOOK))
    (again, *_) = verify_many([trace] * 4, compiled)
    verdict = verify(trace, compiled)
    assert again == verdict
    if any(x.rule == rule for x in verdict.violations):
        return "violated", True
    return next((("open", x.exact) for x in verdict.open if x.rule == rule), ("kept", True))


def test_told_in_one_state_it_is_known_in_all():
    assert judged({"kind": UNKNOWN, "fast": True}, {"kind": "a_truck"}) == ("violated", True)
    assert judged({"fast": True}, {"kind": "a_truck"}) == ("violated", True)
    assert judged({"kind": UNKNOWN, "fast": True}, {"kind": "a_bus"}) == ("kept", True)
    assert judged({"kind": UNKNOWN, "fast": True}, {}) == ("open", True)
    assert judged({"fast": True}, {}) == ("kept", True)


def test_unknown_it_is_the_same_in_all_states():
    assert judged({"kind": UNKNOWN}, {"kind": UNKNOWN}, rule="either") == ("kept", True)


@pytest.mark.parametrize("number", [3, 6, 7])
def test_in_counts_up_to_six_objects_are_gone_through(number):
    objects = {f"c{n}": "car" for n in range(number)}
    answer = judged({"heavy": dict.fromkeys(objects, UNKNOWN)}, objects=objects, rule="few")
    assert answer == {3: ("kept", True), 6: ("open", True), 7: ("open", False)}[number]


def test_of_who_comes_later_only_its_own_states_count():
    objects, present = {f"c{n}": "car" for n in range(6)}, {"c5": (1, 1)}
    first = {"heavy": {f"c{n}": True for n in range(5)}}
    last = {"heavy": {**first["heavy"], "c5": UNKNOWN}}
    answer = judged(first, last, objects=objects, present=present, rule="few")
    assert answer == ("open", True)


@pytest.mark.parametrize("values", [("a_car", "a_bus"), (UNKNOWN, "a_car", UNKNOWN, "a_bus")])
def test_two_values_are_an_error_that_names_both_states(values):
    trace = Trace("t", 1.0, {}, tuple({"kind": value} for value in values))
    compiled = rulec.compile(rulec.parse_rulebook(BOOK))
    with pytest.raises(RulecError) as caught:
        verify(trace, compiled)
    (problem,) = caught.value.diagnostics
    assert problem.code == "R0503"
    last = len(values) - 1
    assert problem.message == (
        "`kind` cannot change in a trace: "
        f"state {last} says `a_bus`, state {last - len(values) // 2} says `a_car`"
    )
    for answer in verify_many([trace] * 4, compiled):
        assert answer.error.diagnostics == (problem,)


def test_together_too_what_counts_is_the_same_in_all_states():
    rule = "(always count c: car (heavy(c)) <= 0) or (always count c: car (heavy(c)) >= 1)"
    text = BOOK + f"hard rule same {{ require {rule} }}"
    compiled = rulec.compile(rulec.parse_rulebook(text))
    state = {"heavy": {"a": UNKNOWN, "b": UNKNOWN}}
    trace = Trace("t", 1.0, {"a": "car", "b": "car"}, (state, state))
    assert [answer.open for answer in verify_many([trace] * 4, compiled)] == [()] * 4


MANY = """\
rulebook many
kind is one of a, b, c, d, e, f, g, h, i default a
mood is one of k, l, m, n, o, p, q, r default k
signal fast default false
constant kind, mood
hard rule steady { require (always a) or (always not a) or (always (k and not fast)) }
"""


def test_each_of_many_traces_has_unknown_constants_of_its_own():
    compiled = rulec.compile(rulec.parse_rulebook(MANY))
    told = {
        "known": {"kind": "b", "mood": "l"},
        "one unknown": {"kind": UNKNOWN, "mood": "l"},
        "the other unknown": {"kind": "b", "mood": UNKNOWN},
        # They may be together what is more than is gone through
        "both unknown": {"kind": UNKNOWN, "mood": UNKNOWN},
    }
    many = [Trace(name, 1.0, {}, (state, {**state, "fast": True})) for name, state in told.items()]
    answers = list(verify_many(many, compiled))
    assert [answer.trace for answer in answers if answer.open] == ["both unknown"]
    assert answers == [verify(trace, compiled) for trace in many]
