"""Verdicts on traces: bindings, stretches, defaults, and what does not fit the vocabulary."""

from dataclasses import replace

import numpy
import pytest

from rulec.api.named_monitor import Monitor
from rulec.automata.compiler import compile_rulebook
from rulec.diagnostics import RulecError, SourceLocation
from rulec.logic.formula import Atom, Constant, QuantityTerm, Unary, UnaryOperator
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.verdict import NotJudged, Verdict, Violation
from rulec.rulebook.rulebook_model import Rulebook
from rulec.trace import Trace
from rulec.vocabulary import Signal, Vocabulary
from rulec.vocabulary.partial_values import Interval
from support.builders.measured_vocabulary import MEASURED, closer, gap, number, others_near
from support.builders.rulebooks import (
    P,
    Q,
    always,
    book,
    both,
    eventually,
    far,
    implies,
    near,
    no,
    rule,
)
from support.generators.random_formulas import VOCABULARY

CARS = {"car1": "car", "car2": "car", "thing1": "thing"}


def trace(*places, objects=CARS, present=None, **constant):
    """A trace from strings such as ``"nfg"``: the place of each object, one string a state."""
    letters = {"n": "near", "f": "far", "g": "gone"}
    states = tuple(
        {
            "place": {
                name: letters[letter]
                for name, letter in zip(objects, text, strict=True)
                if letter != "."
            },
            "q": False,
            **constant,
        }
        for text in places
    )
    return Trace("t", 1.0, objects, states, present or {}, SourceLocation("t.jsonl", 3))


def violations(book_rule, judged):
    rules = compile_rulebook(book(book_rule))
    return [
        (tuple(violation.binding.values()), violation.step)
        for violation in verify(judged, rules).violations
    ]


def test_every_object_of_the_type_is_judged_by_itself():
    never_far = rule("A", always(no(far("x"))), "x: car")
    assert violations(never_far, trace("nnf", "nff", "fff")) == [(("car1",), 2), (("car2",), 1)]


def test_subtypes_count_as_their_type():
    never_far = rule("A", always(no(far("x"))), "x: thing")
    assert violations(never_far, trace("nnf")) == [(("thing1",), 0)]


def test_two_predicates_on_two_objects_are_not_conflated():
    apart = rule("A", always(implies(near("x"), no(far("y")))), "x: car", "y: car")
    # car1 near and car2 far at once: the binding (car1, car2) is hit, (car2, car1) is not.
    assert violations(apart, trace("nfn")) == [(("car1", "car2"), 0)]
    # car1 near first and car2 far later is no offence.
    assert violations(apart, trace("ngn", "gfn")) == []


def test_one_object_is_never_bound_twice():
    clash = rule("A", always(no(both(near("x"), near("y")))), "x: thing", "y: thing")
    assert violations(clash, trace("ngg")) == []
    assert violations(clash, trace("nng")) == [(("car1", "car2"), 0), (("car2", "car1"), 0)]


def test_one_object_is_never_bound_twice_to_different_types():
    clash = rule("A", always(no(both(near("x"), near("y")))), "x: car", "y: thing")
    assert violations(clash, trace("n", objects={"car1": "car"})) == []
    assert violations(clash, trace("nn", objects={"car1": "car", "thing1": "thing"})) == [
        (("car1", "thing1"), 0)
    ]


def test_a_default_holds_for_each_object():
    braking = Signal("braking", ("thing",), False)
    vocabulary = Vocabulary("brakes", VOCABULARY.types, {"braking": braking})
    never = rule("A", always(no(Atom("braking", ("x",)))), "x: car")
    rules = compile_rulebook(Rulebook("test", vocabulary, (never,)))
    objects = {"car1": "car", "car2": "car"}
    states = ({"braking": {"car2": True}}, {})
    found = verify(Trace("t", 1.0, objects, states), rules).violations
    assert [violation.binding for violation in found] == [{"x": "car2"}]


def test_a_rule_without_objects_to_bind_holds():
    never = rule("A", always(no(near("x"))), "x: car")
    assert violations(never, trace("n", objects={"thing1": "thing"})) == []


def test_ten_objects_and_more():
    objects = {f"car{i}": "car" for i in range(12)}
    never_far = rule("A", always(no(far("x"))), "x: car")
    assert violations(never_far, trace("n" * 10 + "fn", objects=objects)) == [(("car10",), 0)]


def test_only_the_end_decides_a_liveness_rule():
    assert violations(rule("A", eventually(Q)), trace("ggg", "ggg")) == [((), None)]


def test_a_rule_that_nothing_keeps_is_lost_at_once():
    assert violations(rule("A", both(P, no(P))), trace("ggg")) == [((), 0)]


def test_a_binding_is_judged_on_its_stretch():
    never_far = rule("A", always(no(far("x"))), "x: car")
    present = {"car1": (1, 2)}
    # Not there in states 0 and 3, car1 needs no value there, and what stands there does not count.
    assert violations(never_far, trace(".gg", "ngg", "fgg", "fgg", present=present)) == [
        (("car1",), 2)
    ]
    assert violations(never_far, trace("fgg", "ngg", "ngg", "fgg", present=present)) == []


def test_the_last_state_of_the_stretch_goes_on_for_ever():
    comes_near = rule("A", eventually(near("x")), "x: car")
    present = {"car1": (0, 0), "car2": (2, 2)}
    assert violations(comes_near, trace("fgg", "ngg", "gng", present=present)) == [
        (("car1",), None)
    ]


def test_the_past_begins_with_the_stretch():
    """Near from one state to the next: not for car1, which was not there in state 0."""
    before = Unary(UnaryOperator.PREVIOUSLY, near("x"))
    not_twice = rule("A", always(no(both(near("x"), before))), "x: car")
    states = ("ngg", "ngg", "fgg")
    assert violations(not_twice, trace(*states)) == [(("car1",), 1)]
    assert violations(not_twice, trace(*states, present={"car1": (1, 2)})) == []


def test_the_past_of_the_last_state_is_what_it_repeats():
    before = Unary(UnaryOperator.PREVIOUSLY, near("x"))
    not_twice = rule("A", always(no(both(near("x"), before))), "x: car")
    assert violations(not_twice, trace("fgg", "ngg")) == [(("car1",), None)]


def test_objects_that_never_meet_are_no_binding():
    never = rule("A", always(no(both(near("x"), near("y")))), "x: car", "y: car")
    present = {"car1": (0, 0), "car2": (1, 1)}
    assert violations(never, trace("nng", "nng", present=present)) == []


def test_a_finite_trace_may_end_where_it_must_not_go_on():
    """`weak next false` says that there is no further state."""
    ends = rule("A", Unary(UnaryOperator.WEAK_NEXT, Constant(False)))
    rules = compile_rulebook(replace(book(ends), semantics="finite"))
    verdicts = [verify(trace(*["ggg"] * n), rules).violations for n in (1, 2, 3)]
    assert [[one.step for one in found] for found in verdicts] == [[], [1], [1]]


def test_what_is_missing_takes_its_default():
    red = rule("A", always(no(P)))
    assert violations(red, trace("ggg")) == []
    assert violations(red, trace("ggg", p=True)) == [((), 0)]


def test_soft_rules_may_yield():
    rules = compile_rulebook(book(rule("S", P, strength="soft"), rule("H", Q)))
    verdict = verify(trace("ggg", q=True), rules)
    assert verdict == Verdict("t", (Violation("S", "soft", {}, 0),))
    assert verdict.satisfied
    assert not verify(trace("ggg"), rules).satisfied


RULES = compile_rulebook(book(rule("A", always(implies(near("x"), Q)), "x: car")))


@pytest.mark.parametrize(
    ("judged", "code", "words", "way_out"),
    [
        (trace("g", objects={"a": "cat"}), "R0505", "`a` is of type `cat`", "`car`"),
        (
            trace("g", objects={"a": "Auto"}),
            "R0505",
            "`a` is of type `Auto`",
            "did you mean `car`?",
        ),
        (trace("ggg", plase={}), "R0502", "speaks of `plase`", "`place`"),
        (trace("ggg", near=True), "R0502", "speaks of `near`", '{"place": … "near"}'),
        (trace("ggg", q=1.0), "R0503", "`q` is `1`; it is true or false", "write `true`"),
        (trace("ggg", q="true"), "R0503", '`q` is `"true"`', "write `true`"),
        (trace("ggg", q="False"), "R0503", '`q` is `"False"`', "write `false`"),
        (trace("ggg", q=2), "R0503", "`q` is `2`; it is true or false", ""),
        (trace("ggg", q=numpy.True_), "R0503", "`True (numpy.bool", "`.item()` makes a value"),
        (trace("ggg", q=None), "R0503", "`None (NoneType)`", "is `rulec.UNKNOWN`"),
        (trace("ggg", q={"car1": True}), "R0503", "gives `q` by object", '{"q": VALUE}'),
        (trace("ggg", q=Interval(1, 2)), "R0503", "`q` is from 1 to 2; it is true", ""),
        (trace("ggg", light="rad"), "R0503", "one of `red`, `green`", "`red`"),
        (trace("ggg", light="far_side_of"), "R0503", "one of `red`", "`left_of` where traffic"),
        (trace("ggg", near_side_of=True), "R0502", "`near_side_of`", "a word of formulas"),
        (trace("ggg", light=True), "R0503", "`light` is true", ""),
        (trace("ggg", place="near"), "R0503", "gives `place` one value", '{"place"'),
        (trace("ggg", place={"car3": "near"}), "R0505", "`car3`", "did you mean"),
        (trace("ggg", place={"car1": "nera"}), "R0503", "`near`, `far`, `gone`", "`near`"),
        (
            trace("g.g"),
            "R0504",
            "the `place` of `car2`, which rule `A` needs",
            "`null` where it is not known",
        ),
        (trace("ggg", q=True, place={}), "R0504", "`place`", "default"),
    ],
)
def test_what_does_not_fit_is_said(judged, code, words, way_out):
    with pytest.raises(RulecError) as caught:
        verify(judged, RULES)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == code
    assert words in diagnostic.message
    assert "state 0" in diagnostic.message or "object" in diagnostic.message
    assert way_out in diagnostic.help
    assert diagnostic.place == SourceLocation("t.jsonl", 3)


def test_what_is_told_is_declared():
    with pytest.raises(RulecError) as caught:
        verify(replace(trace("ggg"), told=frozenset({"p", "plase"})), RULES)
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "R0502"
    assert "`told` has `plase`" in diagnostic.message
    assert "`place`" in diagnostic.help
    with pytest.raises(RulecError, match="plase"):
        Monitor(RULES, told=["plase"])


def test_values_are_only_needed_where_a_rule_reads_them():
    assert verify(trace("gg.", q=True), RULES).satisfied


def test_one_bad_trace_does_not_stop_the_others():
    broken = RulecError(())
    answers = [verify_or_reason(item, RULES) for item in (trace("ggg"), broken, trace("..."))]
    assert [type(answer) for answer in answers] == [Verdict, NotJudged, NotJudged]
    assert (answers[1].trace, answers[2].trace) == (None, "t")


def test_a_refusal_keeps_nothing_of_what_was_at_hand():
    """There may be one for each row of a file of millions."""
    error = verify_or_reason(trace("..."), RULES).error
    assert (error.__traceback__, error.__context__, error.__cause__) == (None, None, None)
    with pytest.raises(RulecError, match=error.diagnostics[0].code):
        raise error


def measured(formula, state):
    rules = compile_rulebook(Rulebook("test", MEASURED, (rule("A", formula, "v: car"),)))
    cars = {"car1": "car", "car2": "car"}
    return verify(Trace("t", 1.0, cars, (state,), place=SourceLocation("t.jsonl", 3)), rules)


@pytest.mark.parametrize("value", [True, "5", None, float("nan"), float("inf"), -float("inf")])
def test_what_is_no_number_is_refused(value):
    with pytest.raises(RulecError) as caught:
        measured(always(closer("v", 5)), {"gap": {"car1": value}})
    (diagnostic,) = caught.value.diagnostics
    assert diagnostic.code == "R0503"
    assert "it is a finite number, in m" in diagnostic.message


def test_a_number_with_its_unit_is_to_be_written_alone():
    with pytest.raises(RulecError) as caught:
        measured(always(closer("v", 5)), {"gap": {"car1": "5 m"}})
    assert caught.value.diagnostics[0].help == "write the number alone, in that unit"


@pytest.mark.parametrize("value", [10**400, -(10**400), 1.7976931348623157e308, 0, -0.0])
def test_any_finite_number_is_a_number(value):
    state = {"gap": {"car1": value, "car2": value}}
    assert measured(always(closer("v", 5)), state).satisfied == (value < 5)


def test_a_huge_whole_number_for_something_else_is_refused_in_few_words():
    with pytest.raises(RulecError) as caught:
        verify(trace("ggg", q=10**5000), RULES)
    assert "`q` is `a number of many digits`" in caught.value.diagnostics[0].message


@pytest.mark.parametrize(
    ("formula", "state", "words"),
    [
        (closer("v", 5), {"gap": {"car1": 6}}, "the `gap` of `car2`"),
        (number("", "<", 1, (1, gap("v")), (2, QuantityTerm("speed"))), {}, "the `gap` of `car1`"),
        (
            number("", "<", 1, (1, others_near("v"))),
            {"place": {"car1": "near"}},
            "the `place` of `car2`",
        ),
    ],
)
def test_a_missing_number_is_named(formula, state, words):
    with pytest.raises(RulecError) as caught:
        measured(always(formula), state)
    (diagnostic,) = caught.value.diagnostics
    assert (diagnostic.code, diagnostic.place) == ("R0504", SourceLocation("t.jsonl", 3))
    assert f"state 0 does not say {words}, which rule `A` needs" in diagnostic.message


def test_who_is_not_there_is_neither_counted_nor_missed():
    alone = always(number("", "<", 1, (1, others_near("v"))))
    state = {"place": {"car1": "near"}}
    rules = compile_rulebook(Rulebook("test", MEASURED, (rule("A", alone, "v: car"),)))
    both_near = {"place": {"car1": "near", "car2": "near"}}
    states = (state, both_near, both_near)
    judged = Trace("t", 1.0, dict.fromkeys(("car1", "car2"), "car"), states, {"car2": (1, 1)})
    found = verify(judged, rules).violations
    assert [(one.binding["v"], one.step) for one in found] == [("car1", 1), ("car2", 1)]
