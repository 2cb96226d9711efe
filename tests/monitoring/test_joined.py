"""Traces laid end to end, given by states or as columns of one shape, get the verdicts of each."""

from dataclasses import replace
from fractions import Fraction
from random import Random
from unittest.mock import patch

import pytest
from hypothesis import Phase, given, settings

import rulec
from rulec.diagnostics import RulecError
from rulec.logic.free_names import names_in
from rulec.monitoring.batch.batch_verify import verify_many
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.joined.joined_columns import joined_columns
from rulec.monitoring.batch.joined.joined_states import joined_states
from rulec.monitoring.batch.stacked import instances, stacked_rule, stacked_run
from rulec.monitoring.batch.stacked.stacked_run import StackedRun
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.rulebook_edition import edition_of
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.monitoring.verdict import NotJudged
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.rulebooks import compile_here
from support.builders.trace_columns import columnize, group_traces
from support.engines.trace_engines import renamed
from support.generators.blurred_traces import blurred
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds


def judged(joined, given_traces, compiled):
    """The verdicts of those that can be judged together."""
    found = StackedRun(joined, compiled).judged()
    return {
        number: own.findings.verdict(
            own.number, trace.id, lambda name, x=trace: any(name in state for state in x.states)
        )
        for number, (own, trace) in enumerate(zip(found, given_traces, strict=True))
        if own is not None
    }


def same_as_alone(verdicts, given_traces, compiled):
    for number, verdict in verdicts.items():
        assert verdict == verify_or_reason(given_traces[number], compiled)


@given(seeds)
@settings(phases=[Phase.generate])
def test_states_of_any_traces(chance):
    compiled = compile_here(rulebook(chance, Fraction(1)), Fraction(1))
    vocabulary = compiled.vocabulary
    names = {n for x in compiled.rules for n in names_in(x.formula)}
    ends = chance.choice(["cut", "complete"])
    own = [blurred(chance, x, names, most=12) for x in traces(chance, Fraction(1))[:5]]
    own = [replace(trace, ends=ends) for trace in own]
    try:
        told = [with_derived_values(spelled_out(x, vocabulary), vocabulary) for x in own]
        joined = joined_states(told, vocabulary)
        verdicts = judged(joined, own, compiled)
        with patch.object(instances, "FEW", -1), patch.object(stacked_rule, "FEW_WORDS", -1):
            assert judged(joined, own, compiled) == verdicts
    except (UnencodableError, RulecError):
        return
    same_as_alone(verdicts, own, compiled)


TWO = """rulebook two
type car
type bus is car
place(v: car) is one of left, right, middle
signal yields_to(v: car, w: car) default false
signal sees(v: car, w: bus)
quantity gap(v: car, w: car) in m default 50
quantity speed(v: car) in m/s
signal rain default false
fact left(v) implies speed(v) < 90 m/s
hard rule mutual (v: car, w: bus) {
  require always (yields_to(v, w) implies next (left(w) or yields_to(w, v)))
}
soft rule calm (v: car) { require never (speed(v) > 50 m/s and rain) }
hard rule seen (v: car, w: bus) { require always (gap(v, w) < 10 m implies sees(v, w)) }
hard rule apart (v: car, w: car) {
  require always (gap(v, w) + 2 * gap(w, v) > 9 m or gap(w, v) > 5 m)
}
"""


def drive(chance, number, cut):
    """Cars, and a bus that comes later; some values are unknown, some pairs are never named."""
    names = [f"{number}.{n}" for n in range(chance.randint(1, 3))]
    bus, n_states = f"{number}.bus", chance.randint(2, 7)

    def perhaps(value):
        return UNKNOWN if chance.random() < 0.1 else value

    def number_(low, high):
        low = round(chance.uniform(low, high), 1)
        return Interval(low, low + 1.0) if chance.random() < 0.1 else perhaps(low)

    def state(step):
        there = [*names, bus] if step else names
        pairs = [(v, w) for v in there for w in there if v != w]
        said = {
            "place": {v: perhaps(chance.choice(["left", "right"])) for v in there},
            "speed": {v: number_(0, 55) for v in there},
            "sees": {v: {bus: perhaps(chance.random() < 0.9)} for v in there if step},
            "yields_to": {},
            "gap": {},
            "rain": perhaps(chance.random() < 0.5),
        }
        for v, w in pairs:
            if chance.random() < 0.5:
                said["yields_to"].setdefault(v, {})[w] = perhaps(chance.random() < 0.2)
            if chance.random() < 0.5:
                said["gap"].setdefault(v, {})[w] = number_(0, 15)
        return said

    objects = dict.fromkeys(names, "car") | {bus: "bus"}
    states = tuple(state(step) for step in range(n_states))
    present = {bus: (1, n_states - 1)}
    return Trace(f"t{number}", 0.5, objects, states, present, ends="cut" if cut else "complete")


@pytest.mark.parametrize("cut", [False, True])
def test_values_of_two_objects(cut):
    """Nothing here is irregular, so all are judged together."""
    compiled, chance = compile_here(parse_rulebook(TWO)), Random(8)
    own = [drive(chance, number, cut) for number in range(150)]
    verdicts = judged(joined_states(own, compiled.vocabulary), own, compiled)
    assert len(verdicts) == len(own)
    same_as_alone(verdicts, own, compiled)
    found = [(len(one.violations), len(one.open)) for one in verdicts.values()]
    assert min(sum(n > 0 for n in kind) for kind in zip(*found, strict=True)) > 15
    assert list(verify_many(own, compiled)) == list(verdicts.values())


def test_a_value_of_two_objects_that_is_missing():
    """It has no default, so the trace gets the error that it gets alone, and no other does."""
    compiled, chance = compile_here(parse_rulebook(TWO)), Random(9)
    own = [drive(chance, number, cut=True) for number in range(20)]
    states = ({**own[4].states[0]}, *[{**state, "sees": {}} for state in own[4].states[1:]])
    own[4] = replace(own[4], states=states)
    answers = list(verify_many(own, compiled))
    assert [n for n, one in enumerate(answers) if isinstance(one, NotJudged)] == [4]
    assert "R0504" in str(answers[4].error.diagnostics[0])


def only_from_the_first(trace):
    """Nobody has a gap to others but the first car."""
    first = next(iter(trace.objects))
    states = [
        {**state, "gap": {v: of_v for v, of_v in state["gap"].items() if v == first}}
        for state in trace.states
    ]
    return replace(trace, states=tuple(states))


def in_the_names_of(first, trace):
    names = dict(zip(trace.objects, first.objects, strict=True))
    states = tuple(renamed(state, names) for state in trace.states)
    present = renamed(trace.present, names)
    return replace(trace, objects=first.objects, states=states, present=present)


@pytest.mark.parametrize("change", [lambda trace: trace, only_from_the_first])
@pytest.mark.parametrize("ends", ["cut", "complete"])
def test_columns_of_one_shape(ends, change):
    compiled, chance = compile_here(parse_rulebook(TWO)), Random(10)
    many = [drive(chance, number, ends == "cut") for number in range(400)]
    own = [change(x) for x in many if (len(x.objects), len(x.states)) == (3, 5)]
    assert len(own) > 10
    group = group_traces([in_the_names_of(own[0], trace) for trace in own])
    ordered = [own[place] for place in group.order]
    joined = joined_columns(columnize(group.cells, compiled.vocabulary), compiled.vocabulary)
    joined = replace(
        joined,
        kind=joined.kind._replace(ends=ends),
        names=[item for trace in ordered for item in trace.objects],
        trace=ordered.__getitem__,
    )
    verdicts = judged(joined, ordered, compiled)
    assert len(verdicts) == len(own)
    same_as_alone(verdicts, ordered, compiled)


THREE = """rulebook three
type car
signal between(u: car, v: car, w: car) default false
signal rain default false
hard rule dry (u: car, v: car) { require never (between(u, v, u) and rain) }
hard rule calm { require never rain }
"""


@pytest.mark.parametrize("shape", [1, 3])
def test_values_of_three_objects(shape):
    """They are judged one by one, as few books say anything of so many."""
    compiled = compile_here(parse_rulebook(THREE))
    cars = {"a": "car", "b": "car"}
    own = []
    for number in range(12):
        said = {"between": {"a": {"b": {"a": UNKNOWN if number % 2 else number > 6}}}, "rain": True}
        states = (said,) * (1 + number % shape)
        own.append(Trace(f"t{number}", 0.5, cars, states, ends="cut"))
    assert list(verify_many(own, compiled)) == [verify_or_reason(one, compiled) for one in own]


@pytest.mark.parametrize("n_states", [63, 64, 200])
def test_a_long_trace_alone(n_states):
    """Whoever asks about one trace gets what its states say, in arrays or not."""
    book = compile_here(parse_rulebook(TWO))
    chance = Random(n_states)
    for number in range(4):
        parts = [drive(chance, number, cut=True) for _ in range(n_states)]
        states = tuple(chance.choice(one.states[1:]) for one in parts if len(one.objects) == 3)
        own = Trace("t", 0.5, dict(next(x for x in parts if len(x.objects) == 3).objects), states)
        own = replace(own, states=(states * n_states)[:n_states], ends="cut")
        assert rulec.verify(own, book) == replace(verify(own, book), law=edition_of(book))


@pytest.mark.parametrize("most", [0, 50, 1 << 20])
def test_traces_that_contradict_facts(most):
    """Whether they are examined together, or by their states, they get the same answers."""
    compiled, chance = compile_here(parse_rulebook(TWO)), Random(11)
    own = [drive(chance, number, cut=True) for number in range(40)]
    for number in range(0, 40, 3):
        fast = dict.fromkeys(own[number].states[0]["place"], 95.0)
        state = {**own[number].states[0], "speed": fast, "place": dict.fromkeys(fast, "left")}
        own[number] = replace(own[number], states=(state, *own[number].states[1:]))
    with patch.object(stacked_run, "_MOST_EXAMINED", most):
        answers = list(verify_many(own, compiled))
    assert answers == [verify_or_reason(one, compiled) for one in own]
    assert any(answer.violations for answer in answers if not isinstance(answer, NotJudged))


KINDS = """rulebook kinds
type car
type person
signal lit(v: car)
signal waits(p: person)
signal sees(v: car, p: person)
hard rule light (v: car) { require always lit(v) }
hard rule patient (p: person) { require always waits(p) }
hard rule seen (v: car, p: person) { require always sees(v, p) }
"""


def test_values_that_objects_of_other_types_cannot_have_are_not_missing():
    compiled = compile_here(parse_rulebook(KINDS))
    state = {"lit": {"c": True}, "waits": {"p": False}, "sees": {"c": {"p": True}}}
    own = [Trace("t", 1.0, {"c": "car", "p": "person"}, (state, state))]
    verdicts = judged(joined_states(own, compiled.vocabulary), own, compiled)
    assert [one.rule for one in verdicts[0].violations] == ["patient"]
    same_as_alone(verdicts, own, compiled)
