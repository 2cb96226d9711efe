"""Traces in arrays, judged together whatever their objects, get the verdicts of each."""

import gc
import itertools
import weakref
from dataclasses import replace
from fractions import Fraction
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import Phase, given, settings

import rulec
from rulec.extraction.recording_verdicts import some_rules
from rulec.logic.free_names import names_in
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.monitoring.batch.stacked import instances, stacked_rule
from rulec.monitoring.batch.stacked import stacked_run as judging
from rulec.monitoring.batch.stacked.stack import Stack
from rulec.monitoring.batch.verify_arrays import verify_arrays
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.trace import Trace
from rulec.trace.trace_arrays import TraceArrays, stretches_of
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.array_traces import CannotSayError, in_arrays
from support.builders.rulebooks import compile_here
from support.generators.blurred_traces import blurred
from support.generators.constant_values import steady, with_some_constant, with_unknown_constants
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds


def without_pairs(trace, vocabulary):
    """No array says anything of two objects."""
    names = {name for name, own in vocabulary.declarations.items() if len(own.parameters) < 2}
    states = [{x: value for x, value in state.items() if x in names} for state in trace.states]
    return replace(trace, states=tuple(states))


def seen(chance, trace, names):
    """Perhaps cut out of something longer, perhaps from a source that cannot tell all."""
    told = None
    if chance.random() < 0.5:
        said = set().union(*trace.states)
        told = frozenset(x for x in names if x in said or chance.random() < 0.5)
    return replace(trace, ends="cut" if chance.random() < 0.3 else "complete", told=told)


def in_plain_words(answer):
    return str(answer.error) if isinstance(answer, NotJudged) else answer


@given(seeds)
@settings(phases=[Phase.generate], max_examples=settings().max_examples // 2)
def test_together_they_get_the_verdicts_of_each(chance):
    book = with_some_constant(chance, rulebook(chance, Fraction(1)))
    compiled, constants = compile_here(book, Fraction(1)), book.vocabulary.constants
    names = {n for x in (*book.rules, *book.axioms) for n in names_in(x.formula)}
    arrays = []
    for whole in traces(chance, Fraction(1))[:5]:
        plain = without_pairs(whole, book.vocabulary)
        dark = blurred(chance, plain, names - set(constants), most=12)
        dark = with_unknown_constants(chance, steady(dark, constants), constants)
        own = seen(chance, without_pairs(dark, book.vocabulary), book.vocabulary.declarations)
        try:
            arrays.append(in_arrays(own, book.vocabulary))
        except CannotSayError:
            continue
    expected = [in_plain_words(verify_or_reason(own.trace(), compiled)) for own in arrays]
    answers = verify_arrays(arrays, compiled)
    # As if they were long, and their words many
    with patch.object(instances, "FEW", -1), patch.object(stacked_rule, "FEW_WORDS", -1):
        among_many = verify_arrays(arrays, compiled)
    assert [in_plain_words(answer) for answer in among_many] == expected
    some = frozenset(name for name in names if chance.random() < 0.8)
    for verdict in answers:
        for one in () if isinstance(verdict, NotJudged) else verdict.open:
            # Asked before the names themselves are known
            others = one.depends_beyond(some)
            assert others == set(one.depends_on) - some
    assert [in_plain_words(answer) for answer in answers] == expected


@given(seeds)
@settings(phases=[Phase.generate], max_examples=settings().max_examples // 4)
def test_a_rule_comes_to_the_same_without_others_and_what_these_read(chance):
    book = rulebook(chance, Fraction(1))
    compiled = compile_here(book, Fraction(1))
    chosen = frozenset(rule.name for rule in compiled.rules if chance.random() < 0.5)
    smaller, names = some_rules(chosen, compiled)
    read = {n for x in (*book.rules, *book.axioms) for n in names_in(x.formula)}
    for whole in traces(chance, Fraction(1))[:3]:
        dark = blurred(chance, without_pairs(whole, book.vocabulary), read, most=12)
        own = seen(chance, without_pairs(dark, book.vocabulary), book.vocabulary.declarations)
        try:
            arrays = in_arrays(own, book.vocabulary)
        except CannotSayError:
            continue
        part = stretches_of([arrays], [range(arrays.n_states)], names)
        answers = verify_arrays([arrays], compiled) + verify_arrays(part, smaller)
        if not isinstance(answers[0], NotJudged):
            every, some = answers
            assert some.violations == tuple(x for x in every.violations if x.rule in chosen)
            assert some.open == tuple(x for x in every.open if x.rule in chosen)
            assert some.not_judged == tuple(x for x in every.not_judged if x.rule in chosen)


@pytest.mark.parametrize("count", [1, 3])
def test_a_rule_that_reads_nothing_may_be_open(count):
    """Whether another state comes is not known of what has been cut out."""
    book = rulec.compile(
        rulec.parse_rulebook("rulebook b semantics finite hard rule r { require next true }")
    )
    trace = Trace("t", 0.5, {}, ({},) * count, ends="cut")
    (verdict,) = verify_arrays([in_arrays(trace, book.vocabulary)], book)
    assert verdict == verify_or_reason(trace, book)
    assert [one.because for one in verdict.open] == [("not over",)] * (count == 1)


def test_arrays_say_what_the_states_say():
    book = rulec.compile(rulec.parse_rulebook(BOOK))
    states = (
        {"speed": Interval(1, 2), "light": "red"},
        {"speed": 3.0, "light": UNKNOWN, "parked": {"a": True, "b": UNKNOWN}},
        {"speed": UNKNOWN, "parked": {"a": False}, "far": {"a": 1.5}},
    )
    trace = Trace("t", 0.5, {"a": "car", "b": "car"}, states, {"b": (0, 1)}, ends="cut")
    assert in_arrays(trace, book.vocabulary).trace() == trace


def test_columns_are_let_go_with_the_verdicts_that_need_them(monkeypatch):
    """In a circle they would stay until somebody looks for circles, which takes long."""
    stacks = []

    def noted(*given):
        stack = Stack(*given)
        stacks.append(weakref.ref(stack))
        return stack

    monkeypatch.setattr(judging, "Stack", noted)
    book = rulec.compile(rulec.parse_rulebook(BOOK))
    states = ({"speed": 3.0, "parked": {"a": UNKNOWN, "b": True}},) * 2
    trace = Trace("t", 0.5, {"a": "car", "b": "car"}, states, ends="cut")
    gc.disable()
    try:
        answers = verify_arrays([in_arrays(trace, book.vocabulary)], book)
        assert answers[0].open
        assert [stack() is not None for stack in stacks] == [True]
        del answers
        assert [stack() for stack in stacks] == [None]
    finally:
        gc.enable()


BOOK = """\
rulebook many
type car
type truck is car
signal clear default true
light is one of red, green default green
quantity speed in m/s default 0
quantity far(c: car) in m default 0
quantity limit in m/s default 10
quantity reach in m default 10
signal parked(c: car) default false
signal ahead(c: car) default false
hard rule slow { require always (speed <= limit) }
hard rule between (c: car) { require always (far(c) - reach <= 3 m or clear) }
hard rule one_parked { require always (count c: car (parked(c)) <= 1) }
hard rule other_parked (v: car) { require always not some c: car (c = v and parked(c)) }
hard rule one_away { require always (count c: car (far(c) - reach > 5 m) <= 1) }
hard rule no_truck (v: car) { require always (clear or not some t: truck (t = v)) }
hard rule in_turn (v: car, w: car) { require always (parked(v) implies not ahead(w)) }
hard rule calm { require always (speed <= 30 m/s) }
hard rule near (v: car) { require always (far(v) <= 20 m) }
hard rule go { require never red }
hard rule once_only (v: car) { require always (ahead(v) implies next always not ahead(v)) }
"""
"""What is read: the world, one object, both, two of them, whom a rule is about, and others."""

FOUR = {"a": "car", "b": "car", "c": "car", "d": "truck"}


def found(answer):
    assert isinstance(answer, Verdict)
    of_violations = [(one.rule, *one.binding.values(), one.step) for one in answer.violations]
    return of_violations, [(one.rule, *one.binding.values()) for one in answer.open]


@pytest.mark.parametrize(
    ("state", "violated", "undecided"),
    [
        ({"speed": 10}, [], []),
        ({"speed": Interval(10.01, 12)}, [("slow", 1)], []),
        ({"speed": UNKNOWN}, [], [("slow",), ("calm",)]),
        ({"speed": Interval(9, 31)}, [], [("slow",), ("calm",)]),
        ({"speed": 31}, [("slow", 1), ("calm", 1)], []),
        ({"far": {"a": 20, "b": 15}}, [], []),
        ({"far": {"a": 21, "b": 15}}, [("near", "a", 1)], []),
        ({"far": {"a": UNKNOWN}}, [], [("near", "a")]),
        ({"far": {"b": Interval(1, 21)}}, [], [("near", "b")]),
        ({"light": "red"}, [("go", 1)], []),
        ({"light": UNKNOWN}, [], [("go",)]),
        (
            {"clear": False, "far": {"b": 13.0, "c": 13.01}},
            [("between", "c", 1), ("no_truck", "d", 1)],
            [],
        ),
        ({"clear": UNKNOWN, "far": {"c": 13.01}}, [], [("between", "c"), ("no_truck", "d")]),
        (
            {"parked": {"a": True, "c": True}},
            [("one_parked", 1), ("other_parked", "a", 1), ("other_parked", "c", 1)],
            [],
        ),
        ({"far": {"a": 16, "b": Interval(15.01, 17)}}, [("one_away", 1)], []),
        ({"far": {"a": 16, "b": Interval(14, 17)}}, [], [("one_away",)]),
        ({"far": {"a": 16, "b": Interval(14, 15)}}, [], []),
        ({"clear": False}, [("no_truck", "d", 1)], []),
        ({"ahead": {"a": True, "b": True}}, [], []),
        (
            {"parked": {"b": True}, "ahead": {"a": True, "b": True}},
            [("other_parked", "b", 1), ("in_turn", "b", "a", 1)],
            [],
        ),
        (
            {"parked": {"b": UNKNOWN}, "ahead": {"c": True}},
            [],
            [("other_parked", "b"), ("in_turn", "b", "c")],
        ),
    ],
)
def test_one_state_of_four_cars(state, violated, undecided):
    compiled = rulec.compile(rulec.parse_rulebook(BOOK))
    own = in_arrays(Trace("own", 1.0, FOUR, ({}, state, {})), compiled.vocabulary)
    calm = in_arrays(Trace("calm", 1.0, {"z": "car"}, ({}, {}, {})), compiled.vocabulary)
    assert [found(x) for x in verify_arrays([calm, own, calm], compiled)] == [
        ([], []),
        (violated, undecided),
        ([], []),
    ]


def test_objects_that_never_meet_are_no_pair():
    compiled = rulec.compile(rulec.parse_rulebook(BOOK))
    states = ({"parked": {"a": True}}, {"ahead": {"b": True}}, {})
    apart = Trace("apart", 1.0, {"a": "car", "b": "car"}, states, {"a": (0, 0), "b": (1, 2)})
    (answer,) = verify_arrays([in_arrays(apart, compiled.vocabulary)], compiled)
    assert found(answer) == ([("other_parked", "a", 0)], [])


def test_a_state_counts_from_the_beginning_of_the_trace():
    compiled = rulec.compile(rulec.parse_rulebook(BOOK))
    states = ({}, {}, {"ahead": {"b": True}}, {}, {"ahead": {"b": True}}, {})
    late = Trace("late", 1.0, {"a": "car", "b": "car"}, states, {"b": (1, 5)})
    answers = verify_arrays([in_arrays(late, compiled.vocabulary)] * 2, compiled)
    assert [found(answer) for answer in answers] == [([("once_only", "b", 4)], [])] * 2


@pytest.mark.parametrize(
    ("arrays", "message"),
    [
        ({"world": {"fast": np.array([True])}}, "`fast`, which `many`"),
        ({"objects": {"a": "bus"}, "spans": np.array([[0, 0]])}, "type `bus`"),
    ],
)
def test_what_is_odd_is_refused_as_states_are(arrays, message):
    compiled = rulec.compile(rulec.parse_rulebook(BOOK))
    (answer,) = verify_arrays([TraceArrays("odd", 1.0, 1, **arrays)], compiled)
    assert isinstance(answer, NotJudged)
    assert message in str(answer.error)


CROWDED = """\
rulebook crowded
type car
type truck is car
signal clear default true
signal near(c: car) default false
signal awake(c: car) default true
fact near(c) implies awake(c)
hard rule whatever { require always (clear or not some c: car (near(c) and clear)) }
hard rule alone { require always (clear or not some c: car (near(c) and not clear)) }
hard rule trucks { require always (clear or count c: truck (near(c) and not clear) <= 1) }
"""
"""Counts that read what their rule reads beside them: no two of them are looked at apart."""


@pytest.mark.parametrize(
    ("near", "violated", "undecided"),
    [
        ({}, [], []),
        ({"a1": True}, [], [("alone",)]),
        (dict.fromkeys(["a1", "b1", "b2"], True), [], [("alone",), ("trucks",)]),
        ({f"a{n}": UNKNOWN for n in range(30)}, [], [("alone",)]),
        ({f"b{n}": UNKNOWN for n in range(30)}, [], [("alone",), ("trucks",)]),
        ({"a1": UNKNOWN, "b1": UNKNOWN}, [], [("alone",)]),
    ],
)
def test_of_a_crowd_of_whom_the_same_is_said_all_is_known(near, violated, undecided):
    compiled = rulec.compile(rulec.parse_rulebook(CROWDED))
    crowd = {f"a{n}": "car" for n in range(30)} | {f"b{n}": "truck" for n in range(30)}
    trace = Trace("crowd", 1.0, crowd, ({}, {"clear": UNKNOWN, "near": near}, {}))
    (together,) = verify_arrays([in_arrays(trace, compiled.vocabulary)], compiled)
    assert found(together) == (violated, undecided)
    assert all(one.exact for one in together.open)
    assert together == verify_or_reason(trace, compiled)


@pytest.mark.parametrize(
    ("awake", "undecided"),
    [((), []), (("a0",), [("alone",)]), (("a7", "b7"), [("alone",)]),
     (("b0", "b7"), [("alone",), ("trucks",)])],
)  # fmt: skip
def test_a_fact_says_of_each_of_a_crowd_whether_it_may_count(awake, undecided):
    compiled = rulec.compile(rulec.parse_rulebook(CROWDED))
    crowd = {f"a{n}": "car" for n in range(30)} | {f"b{n}": "truck" for n in range(30)}
    state = {
        "clear": UNKNOWN,
        "near": dict.fromkeys(crowd, UNKNOWN),
        "awake": {item: item in awake for item in crowd},
    }
    trace = Trace("crowd", 1.0, crowd, ({}, state, {}))
    (together,) = verify_arrays([in_arrays(trace, compiled.vocabulary)], compiled)
    assert found(together) == ([], undecided)
    assert together == verify_or_reason(trace, compiled)


@pytest.mark.parametrize("near", [{"a1": True}, {"b2": True, "b3": UNKNOWN}])
def test_a_state_that_contradicts_a_fact_is_refused_as_by_itself(near):
    asleep = "hard rule asleep (v: car) { require never (clear and near(v) and not awake(v)) }"
    compiled = rulec.compile(rulec.parse_rulebook(CROWDED + asleep))
    crowd = {"a1": "car", "b2": "truck", "b3": "truck"}
    state = {"clear": False, "near": near, "awake": dict.fromkeys(crowd, False)}
    traces = [Trace(str(n), 1.0, crowd, own) for n, own in enumerate([({},), ({}, state)])]
    calm, refused = verify_arrays([in_arrays(x, compiled.vocabulary) for x in traces], compiled)
    assert found(calm) == ([], [])
    assert isinstance(refused, NotJudged)
    assert "state 1 cannot be: `near(" in str(refused.error)
    assert str(refused.error) == str(verify_or_reason(traces[1], compiled).error)


WEATHER = """\
rulebook weather
light is one of dry_road, wet_road, icy_road default dry_road
signal raining default false
signal fog default false
fact raining implies not dry_road
hard rule careful { require never (wet_road and fog) }
hard rule slow { require never (raining and (icy_road or dry_road and not fog)) }
"""


def test_whatever_was_asked_before_facts_are_contradicted_by_what_is_said_everywhere():
    compiled = rulec.compile(rulec.parse_rulebook(WEATHER))
    some = (None, True, False, UNKNOWN)
    lights, refused = (None, "dry_road", "wet_road", UNKNOWN), 0
    for light, raining, fog, changes in itertools.product(lights, some, some, (False, True)):
        said = {"light": light, "raining": raining, "fog": fog}
        first = {name: value for name, value in said.items() if value is not None}
        last = first | {"light": "icy_road"} if changes else first
        trace = Trace("rain", 1.0, {}, (first, last), told=frozenset(first | last))
        (own,) = verify_arrays([in_arrays(trace, compiled.vocabulary)], compiled)
        assert in_plain_words(own) == in_plain_words(verify_or_reason(trace, compiled))
        refused += isinstance(own, NotJudged)
    assert refused
