"""Many traces together: every answer is the one that the trace gets alone."""

from contextlib import suppress
from dataclasses import replace
from fractions import Fraction
from functools import cache
from random import Random

import numpy as np
import pytest
from hypothesis import example, given, settings
from hypothesis import strategies as st

from rulec.automata.mealy_monitor import NumberRead, Threshold
from rulec.automata.thresholds import exact, scale
from rulec.diagnostics import Diagnostic, RulecError
from rulec.logic.formula import Comparison, Count, QuantityTerm, Same
from rulec.monitoring.batch import batch_verify
from rulec.monitoring.batch.batch_verify import verify_chunk, verify_columns, verify_many
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.monitoring.batch.cell_verdicts import verify_cells
from rulec.monitoring.batch.columns import column_states
from rulec.monitoring.batch.columns.column_numbers import digits_of
from rulec.monitoring.batch.columns.column_states import shared_states
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.limits import MonitoringLimits
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.rulebook.loader import parse_rulebook
from rulec.rulebook.rulebook_model import Rulebook
from rulec.trace import Trace
from rulec.trace.trace_columns import TraceColumns, layout_of
from rulec.trace.trace_model import present_in
from support.builders.rulebooks import (
    always,
    both,
    compile_here,
    eventually,
    far,
    implies,
    near,
    no,
    rule,
)
from support.builders.trace_columns import columnize, group_traces
from support.generators.random_records import chunks, rulebooks, told
from support.generators.timed_formulas import TIMED_VOCABULARY
from support.oracles.bits.bit_verdicts import verify_on_bits
from support.oracles.bits.column_reading import NotGivenError


@given(rulebooks(), chunks())
@settings(max_examples=settings.default.max_examples // 2)
def test_answers_are_those_of_the_traces_alone(rulebook, traces):
    compiled = compile_here(rulebook)
    alone = [told(verify_or_reason(trace, compiled)) for trace in traces]
    assert [told(one) for one in verify_chunk(traces, compiled)] == alone


@given(rulebooks(), chunks())
@settings(max_examples=settings.default.max_examples // 2)
def test_cells_and_columns_say_the_same(rulebook, traces):
    """Whether states are told apart as a whole, or by what is read of them."""
    compiled = compile_here(rulebook)
    sound = [one for one in traces if isinstance(verify_or_reason(one, compiled), Verdict)]
    sound = [one for one in sound if one.objects == sound[0].objects]
    sound = [one for one in sound if one.present == sound[0].present]
    if not sound:
        return
    group = group_traces(sound)
    expected = violations(verify(sound[place], compiled) for place in group.order)
    assert listed(verify_cells(group.cells, compiled), sound) == expected
    with suppress(UnencodableError, NotGivenError):
        columns = columnize(group.cells, TIMED_VOCABULARY)
        assert violations(verify_columns(columns, compiled)) == expected
        assert lost_on_bits(columns, compiled) == bindings_in(expected)


def listed(judged, traces):
    found = [[] for _ in traces]
    for one in judged:
        assert not len(one.unread)
        for trace, step in zip(one.violated, one.lost_at(), strict=True):
            step = None if step < 0 else step
            found[trace].append((one.task.rule.name, one.task.objects, step))
    return found


def lost_on_bits(columns, compiled):
    found = [[] for _ in range(columns.layout.n_traces)]
    for task, accepted in verify_on_bits(columns, compiled):
        for place in np.flatnonzero(~accepted).tolist():
            found[place].append((task.rule.name, task.objects))
    return found


def bindings_in(lost):
    return [[(name, binding) for name, binding, _ in one] for one in lost]


def violations(verdicts):
    return [[(v.rule, v.binding, v.step) for v in one.violations] for one in verdicts]


def times(factor, quantity, *variables):
    return Fraction(factor), QuantityTerm(quantity, variables)


def number(relation, limit, *terms):
    return Comparison(terms, relation, Fraction(limit), f"{terms} {relation} {limit}")


def count(variable, kind, body):
    return Fraction(1), Count(variable, kind, body)


CLOSE = number("<", Fraction(3, 10), times(1, "gap", "x"), times(-1, "gap", "y"))
OTHERS = both(near("x"), no(Same("x", "v")))
NESTED = number(">=", 1, count("y", "thing", both(no(Same("x", "y")), CLOSE)))
CROWDED = Rulebook(
    "crowded",
    TIMED_VOCABULARY,
    (
        rule("apart", always(implies(near("v"), no(far("w")))), "v: car", "w: car"),
        rule("pass", eventually(both(far("v"), near("w"))), "v: car", "w: thing"),
        rule("others", always(number("<", 2, count("x", "car", OTHERS))), "v: car"),
        rule("nobody", eventually(number("=", 0, count("x", "thing", near("x"))))),
        rule("nested", always(number("<", 3, count("x", "car", NESTED)))),
        rule("slow", always(number("<=", Fraction(3, 10), times(1, "speed")))),
    ),
)


@cache
def crowded(semantics):
    return compile_here(replace(CROWDED, semantics=semantics))


def state_of(chance, names):
    tenths = (0.1, 0.2, 0.3, 0.30000000000000004, 0.5, 0.6000000000000001, 2)
    return {
        "place": {name: chance.choice(["near", "far", "gone"]) for name in names},
        "gap": {name: chance.choice(tenths) for name in names},
        "q": chance.random() < 0.5,
        "speed": chance.choice(tenths),
    }


@pytest.mark.parametrize("semantics", ["stutter", "finite"])
@given(st.randoms(use_true_random=False), st.integers(0, 5))
def test_objects_that_come_late_and_leave_early(semantics, chance, n_objects):
    """In a state, values are given of those that are there."""
    objects = {f"o{n}": chance.choice(["car", "thing"]) for n in range(n_objects)}
    present = {}
    for name in chance.sample(list(objects), n_objects // 2):
        first = chance.randint(0, 2)
        present[name] = (first, chance.randint(first, 3))
    shortest = max([1, *(last + 1 for _, last in present.values())])
    pools = [
        [state_of(chance, present_in(step, objects, present)) for _ in range(3)]
        for step in range(shortest + 3)
    ]
    traces = []
    for place in range(30):
        pool = pools[: chance.randint(shortest, shortest + 3)]
        states = tuple(chance.choice(choice) for choice in pool)
        traces.append(Trace(str(place), 1.0, objects, states, present))
    compiled = crowded(semantics)
    alone = [verify(trace, compiled) for trace in traces]
    assert verify_chunk(traces, compiled) == alone
    group = group_traces(traces)
    expected = violations(alone[place] for place in group.order)
    assert listed(verify_cells(group.cells, compiled), traces) == expected
    columns = columnize(group.cells, TIMED_VOCABULARY)
    assert violations(verify_columns(columns, compiled)) == expected
    assert lost_on_bits(columns, compiled) == bindings_in(expected)


@pytest.mark.long
def test_three_hundred_objects():
    chance = Random(300)
    objects = {f"o{n}": "car" for n in range(300)}
    rules = tuple(one for one in CROWDED.rules if len(one.variables) < 2 and one.name != "nested")
    compiled = compile_here(replace(CROWDED, rules=rules))
    pool = [state_of(chance, objects) for _ in range(2)]
    traces = [
        Trace(str(n), 1.0, objects, tuple(chance.choices(pool, k=chance.randint(1, 3))))
        for n in range(4)
    ]
    alone = [verify(trace, compiled) for trace in traces]
    assert sum(len(one.violations) for one in alone) > 300
    assert verify_chunk(traces, compiled) == alone
    columns = columnize(group_traces(traces).cells, TIMED_VOCABULARY)
    expected = violations(alone[place] for place in group_traces(traces).order)
    assert violations(verify_columns(columns, compiled)) == expected
    assert lost_on_bits(columns, compiled) == bindings_in(expected)


def test_any_number_of_traces_and_what_is_none(monkeypatch):
    monkeypatch.setattr(batch_verify, "LIMITS", MonitoringLimits(states_together=1000))
    compiled = crowded("stutter")
    broken = RulecError(Diagnostic("R0501", "this is not a trace"))
    states = tuple(state_of(Random(1), ()) for _ in range(3))
    traces = [Trace(str(n), 1.0, {}, states[: 1 + n % 3]) for n in range(2000)]
    waiting = iter([broken, *traces])
    answers = verify_many(waiting, compiled)
    assert next(answers) == NotJudged(None, broken)
    # Three states a trace, or two, or one; and one more for the trace itself.
    assert len(list(waiting)) == 2000 - 333
    traces = traces[:333]
    assert list(answers) == [verify(trace, compiled) for trace in traces]


PLAIN = """rulebook plain
type car
signal p(v: car)
hard rule kept (v: car) { require always p(v) }"""


def test_a_value_that_one_state_lacks_is_missing_as_in_its_trace_alone():
    rules = compile_here(parse_rulebook(PLAIN))
    # Each state is an object of its own, so that all are turned into columns.
    words = [[{"p": {"c": True}} for _ in range(3)] for _ in range(8)]
    words[5][1] = {}
    traces = [Trace(str(n), 1.0, {"c": "car"}, tuple(word)) for n, word in enumerate(words)]
    assert_only_one_is_refused(traces, 5, rules)


def assert_only_one_is_refused(traces, refused, rules):
    answers = list(verify_many(traces, rules))
    assert list(map(told, answers)) == [told(verify_or_reason(trace, rules)) for trace in traces]
    codes = [one.error.diagnostics[0].code for one in answers if isinstance(one, NotJudged)]
    assert codes == ["R0504"]
    assert isinstance(answers[refused], NotJudged)


def test_the_last_value_before_an_object_leaves_is_needed_in_shared_states():
    rules = compile_here(parse_rulebook(PLAIN))
    both, lacking, alone = ({"p": {"a": True, "b": True}}, {"p": {"a": True}}, {"p": {"a": True}})
    words = [(both, both, alone)] * 5 + [(both, lacking, alone)] + [(both, both, alone)] * 2
    objects, present = {"a": "car", "b": "car"}, {"b": (0, 1)}
    traces = [Trace(str(n), 1.0, objects, word, present) for n, word in enumerate(words)]
    assert_only_one_is_refused(traces, 5, rules)


def test_what_can_be_no_trace_is_not_judged():
    compiled = crowded("stutter")
    bad = [
        Trace("a", 1.0, {}, ()),
        Trace("b", 0.0, {}, ({"speed": 1.0},)),
        Trace("c", 1.0, {"o": "plane"}, ({"speed": 1.0},)),
        Trace("d", 1.0, {}, ({"speed": 1.0},), {"o": (0, 0)}),
        Trace("e", 1.0, {}, ("speed",)),
    ]
    for one in bad:
        answers = verify_chunk([one] * 5, compiled)
        assert [told(answer) for answer in answers] == [told(verify_or_reason(one, compiled))] * 5
        assert isinstance(answers[0], NotJudged)


@pytest.mark.parametrize("most_codes", [1, 1 << 16])
def test_states_that_are_equal_or_not_looked_for(monkeypatch, most_codes):
    """Few states, judged once each; or the same ones, judged as they come."""
    monkeypatch.setattr(column_states, "MOST_CODES", most_codes)
    chance = Random(most_codes)
    objects = {"a": "car", "b": "thing", "c": "car"}
    pool = [{**state_of(chance, objects), "speed": 0.3, "gap": 0.5} for _ in range(6)]
    for state in pool:
        state["gap"] = dict.fromkeys(objects, 0.5)
    traces = [
        Trace(str(n), 1.0, objects, tuple(dict(chance.choice(pool)) for _ in range(n % 3 + 1)))
        for n in range(40)
    ]
    compiled = crowded("stutter")
    alone = [verify(trace, compiled) for trace in traces]
    assert verify_chunk(traces, compiled) == alone
    group = group_traces(traces)
    columns = columnize(group.cells, TIMED_VOCABULARY)
    assert (shared_states(columns, TIMED_VOCABULARY) is None) == (most_codes == 1)
    judged = verify_columns(columns, compiled)
    assert violations(judged) == violations(alone[place] for place in group.order)


def test_columns_of_which_something_is_unknown():
    rules = compile_here(parse_rulebook(PLAIN))
    columns = TraceColumns(
        layout_of([2, 2]),
        {("p", ("c",)): np.array([True, False, True, True])},
        {"c": "car"},
        unknown={("p", ("c",)): np.array([False, False, True, False])},
    )
    doubtful, lost = verify_columns(columns, rules)
    assert (doubtful.trace, doubtful.violations) == ("0", ())
    assert [one.depends_on for one in doubtful.open] == [("p",)]
    assert [one.step for one in lost.violations] == [0]


def test_columns_that_lack_what_a_rule_needs():
    (answer,) = verify_columns(
        TraceColumns(layout_of([1]), {}, {"c": "car"}), compile_here(parse_rulebook(PLAIN))
    )
    assert [one.code for one in answer.error.diagnostics] == ["R0504"]


@pytest.mark.parametrize(
    ("key", "values", "said"),
    [
        (("place", ("c",)), [0, 3], "`place` of `c` has place 3, of 3 values"),
        (("place", ("c",)), [0, -1], "`place` of `c` has place -1, of 3 values"),
        (("place", ("c",)), [0], "has 1 entries, for 2 states"),
        (("place", ()), [0, 0], "`place` is about 0 objects, not 1"),
        (("plaice", ("c",)), [0, 0], "`plaice` of `c` is of no name that "),
    ],
)
def test_an_array_that_does_not_fit(key, values, said):
    columns = TraceColumns(layout_of([2]), {key: np.array(values)}, {"c": "car"})
    with pytest.raises(ValueError, match=said):
        verify_columns(columns, crowded("stutter"))


THRESHOLDS = (
    Threshold(Fraction(3, 10), inclusive=True),
    Threshold(Fraction(3, 10), inclusive=False),
)
SUM = NumberRead((times(1, "gap", "x"), times(Fraction(1, 3), "speed")), THRESHOLDS)
floats = st.floats(allow_nan=False, allow_infinity=False) | st.sampled_from(
    [0.1, 0.2, 0.3, 0.6, 0.9, 0.30000000000000004, 5e-324, -5e-324, 1.7e308, 0.0, -0.0]
)


@given(st.lists(st.tuples(floats, floats), min_size=1))
@example([(0.1, 0.6), (0.2, 0.3), (0.3, 0.0), (0.3, 5e-324), (0.3, -5e-324), (1.7e308, 1.7e308)])
@example([(123456789.3, -370370367.0)])
@example([(-1.7e308, 1.7e308), (0.30000000000000004, 0.0), (0.29999999999999999, 0.0)])
def test_sums_are_exact(pairs):
    """0.1 and a third of 0.6 are 0.3, whatever floats make of it."""
    ones, others = (np.array(column) for column in zip(*pairs, strict=True))
    found = digits_of(scale(SUM), [(Fraction(1), ones), (Fraction(1, 3), others)])
    assert found.tolist() == [SUM.digit(exact(one) + exact(other) / 3) for one, other in pairs]


QUEUE = """rulebook queue
type car
signal loud(v: car) default false
signal horn
quantity speed(v: car) in km/h default 0
fact loud(v) implies horn
fact speed(v) <= 120 km/h
hard rule calm (v: car) { require always (loud(v) implies speed(v) <= 100 km/h) }
soft rule fast (v: car) { require never (speed(v) > 50 km/h and next speed(v) > 60 km/h) }
"""


@cache
def queue(more):
    return compile_here(parse_rulebook(QUEUE + more, "queue.rules"))


@pytest.mark.parametrize("more", ["", "fact count c: car (loud(c)) <= 1"])
@pytest.mark.parametrize("n_states", [2, 40])
@given(chance=st.randoms(use_true_random=False))
def test_states_that_cannot_be(more, n_states, chance):
    """Few states that are met again and again, or as many as there are."""
    objects = {"a": "car", "b": "car"}

    def state():
        return {
            "horn": chance.random() < 0.8,
            "loud": {name: chance.random() < 0.4 for name in objects},
            "speed": {name: chance.choice([40, 55.5, 61, 99, 120, 120.5]) for name in objects},
        }

    pool = [state() for _ in range(n_states)]
    traces = [
        Trace(str(n), 1.0, objects, tuple(chance.choices(pool, k=chance.randint(1, 3))))
        for n in range(20)
    ]
    alone = [told(verify_or_reason(trace, queue(more))) for trace in traces]
    assert [told(one) for one in verify_chunk(traces, queue(more))] == alone


PATIENT = """rulebook patient
signal asked
signal told
quantity speed in m/s
fact not (asked and told)
hard rule answer { require always (asked implies eventually[<= 100 steps] told) }
"""


def test_a_large_machine_and_states_that_cannot_be_and_are_not_met():
    """As many states as steps that are left; those of the traces are all different."""
    compiled = compile_here(parse_rulebook(PATIENT, "patient.rules"))
    assert len(compiled.rules[0].machine.successors) > 100
    said, traces = [(True, False), (False, True), (False, False)], []
    for n in range(20):
        words = [said[(n + step) % 3] for step in range(1 + n % 4)]
        states = [
            {"asked": asks, "told": tells, "speed": n + step / 8}
            for step, (asks, tells) in enumerate(words)
        ]
        traces.append(Trace(str(n), 1.0, {}, tuple(states)))
    # Who is asked at last is never told: the last state is repeated for ever.
    unanswered = [one.id for one in traces if one.states[-1]["asked"]]
    found = verify_chunk(traces, compiled)
    assert [one.trace for one in found if one.violations] == unanswered


@pytest.mark.parametrize("count", [255, 256, 300])
def test_a_number_may_pass_more_thresholds_than_a_byte_counts(count):
    passed = tuple(Threshold(Fraction(n), inclusive=True) for n in range(count))
    terms = tuple((Fraction(1), QuantityTerm(name)) for name in ("speed", "limit"))
    speeds, limits = np.array([-1.0, 0.0, 200.0, 400.0]), np.array([0.0, 0.0, 54.5, 0.0])
    sums = [(Fraction(1), speeds), (Fraction(1), limits)]
    found = digits_of(scale(NumberRead(terms, passed)), sums)
    assert found.tolist() == [0, 1, 255, count]
    counting = NumberRead(((Fraction(1), Count("v", "vehicle", near("v"))),), passed)
    objects = np.array([0, 254, 400])
    assert digits_of(scale(counting), [(Fraction(1), objects)]).tolist() == [1, 255, count]
