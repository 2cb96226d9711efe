"""A monitor: at every moment it says of a running trace what all ways to go on say of it."""

import json
from itertools import product

import msgspec
import pytest
from hypothesis import given
from hypothesis import strategies as st

from rulec.api.named_monitor import Monitor
from rulec.diagnostics import RulecError
from rulec.logic.semantics import holds
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.monitoring.uncertainty.known_words import KnownLetters
from rulec.monitoring.verdict import NotJudged
from rulec.rulebook.rulebook_model import Rulebook
from rulec.trace import Trace
from support.builders.rulebooks import compile_here, rule
from support.builders.state_traces import as_trace
from support.generators.random_formulas import VOCABULARY, formulas, letters, words
from support.generators.random_records import OBJECTS, rulebooks, states

CAR1 = {"car1": "car"}
EVERY_STATE = [
    {"place": {"car1": place}, "light": light, "p": p, "q": q}
    for place, light, p, q in product(
        ["near", "far", "gone"], ["red", "green"], [False, True], [False, True]
    )
]


def compiled(formula, semantics="stutter", variables=("x: thing",)):
    return compile_here(
        Rulebook("b", VOCABULARY, (rule("r", formula, *variables),), semantics=semantics)
    )


def steps(rules, word, objects=CAR1):
    monitor = Monitor(rules)
    return [monitor.step(state, objects) for state in word]


semantics = st.sampled_from(["stutter", "finite"])


@given(formulas, semantics, words)
def test_verdicts_are_those_of_all_continuations(formula, ends, word):
    """By walking through the machine, behind every prefix, with every state that there could be."""
    rules = compiled(formula, ends)
    machine = rules.rules[0].machine
    columns = KnownLetters(Trace("t", 1.0, CAR1, (*EVERY_STATE, *word)), rules)
    symbols = columns.word(rules.rules[0], {"x": "car1"}, 0, len(EVERY_STATE) + len(word) - 1)
    possible = set(symbols[: len(EVERY_STATE)])
    state, expected = 0, []
    for symbol in symbols[len(EVERY_STATE) :]:
        outcomes = {machine.outputs[state][symbol]}
        if_it_ended_here = machine.outputs[state][symbol]
        state = machine.successors[state][symbol]
        outcomes |= outcomes_from(machine, state, possible)
        expected.append(
            {(True,): "satisfied", (False,): "violated"}.get(
                tuple(outcomes), "holds so far" if if_it_ended_here else "pending"
            )
        )
    monitor = Monitor(rules)
    found = []
    for one in word:
        monitor.step(one, CAR1)
        found.append(monitor.snapshot()["rules"][0]["bindings"][0]["verdict"])
    assert found == expected


def outcomes_from(machine, state, possible):
    """The verdicts on all non-empty words of possible letters, read from a state."""
    seen, waiting, outcomes = {state}, [state], set()
    while waiting:
        here = waiting.pop()
        for symbol in possible:
            outcomes.add(machine.outputs[here][symbol])
            after = machine.successors[here][symbol]
            if after not in seen:
                seen.add(after)
                waiting.append(after)
    return outcomes


@given(formulas, words, st.lists(st.sampled_from(EVERY_STATE), max_size=3))
def test_verdicts_are_those_of_direct_evaluation(formula, word, rest):
    found = steps(compiled(formula), word)[-1].rules["r"]
    now, later = holds(formula, letters(word)), holds(formula, letters([*word, *rest]))
    assert now == (found in ("satisfied", "holds so far"))
    if found in ("satisfied", "violated"):
        assert later == now


@st.composite
def journeys(draw, odd=False):
    """States, each with the objects that are there; these come, go and come back."""
    found = []
    for _ in range(draw(st.integers(1, 6))):
        names = sorted(draw(st.sets(st.sampled_from("abc"))))
        if found and draw(st.booleans()):
            names = list(found[-1][1])
        objects = {name: OBJECTS[name] for name in names}
        found.append((draw(states(objects, odd)), objects))
    return found


def listed(violations):
    return sorted(
        (one.rule, one.strength, [name.split()[0] for name in one.binding.values()], str(one.step))
        for one in violations
    )


def violations_if_it_ended(monitor):
    """Those for good, and those of the bindings that are pending."""
    pending = [
        (
            about["rule"],
            next(one.strength for one in monitor.rulebook.rules if one.name == about["rule"]),
            list(one["objects"]),
            "None",
        )
        for about in monitor.snapshot()["rules"]
        for one in about["bindings"]
        if one["verdict"] == "pending"
    ]
    return sorted(listed(monitor.violations) + pending)


@given(rulebooks(), journeys())
def test_at_the_end_it_says_what_verify_says(rulebook, journey):
    rules = compile_here(rulebook)
    monitor = Monitor(rules)
    for number, (state, objects) in enumerate(journey, 1):
        expected = verify_or_reason(as_trace(journey[:number]), rules)
        if isinstance(expected, NotJudged):
            with pytest.raises(RulecError) as refused:
                monitor.step(state, objects)
            assert codes(refused.value) == codes(expected.error)
            return
        found = monitor.step(state, objects)
        assert violations_if_it_ended(monitor) == listed(expected.violations)
        assert expected.satisfied == (found.verdict in ("satisfied", "holds so far"))


def codes(error):
    return [one.code for one in error.diagnostics]


@given(rulebooks(), journeys(odd=True))
def test_a_state_that_is_refused_leaves_no_trace(rulebook, journey):
    rules = compile_here(rulebook)
    monitor, taken = Monitor(rules), []
    for state, objects in journey:
        before = monitor.snapshot()
        try:
            monitor.step(state, objects)
            taken.append((state, objects))
        except RulecError:
            assert monitor.snapshot() == before
    again = Monitor(rules)
    for state, objects in taken:
        again.step(state, objects)
    assert monitor.snapshot() == again.snapshot()


@given(rulebooks(), journeys(odd=True))
def test_what_is_refused_and_why_is_what_verify_says(rulebook, journey):
    """Of the whole trace of the states that were taken and this one, word by word."""
    rules = compile_here(rulebook)
    objects = journey[0][1]
    monitor, taken = Monitor(rules), []
    for state, there in journey:
        if there != objects:
            continue
        answer = verify_or_reason(Trace("t", 1.0, objects, (*taken, state)), rules)
        if isinstance(answer, NotJudged):
            with pytest.raises(RulecError) as refused:
                monitor.step(state, objects)
            assert refused.value.diagnostics == answer.error.diagnostics
        else:
            monitor.step(state, objects)
            taken.append(state)


@given(rulebooks(), journeys(odd=True), st.integers(0, 6))
def test_restored_anywhere_it_has_the_same_future(rulebook, journey, at):
    rules = compile_here(rulebook)
    one, other = Monitor(rules), Monitor(rules)
    for number, (state, objects) in enumerate(journey):
        if number == at:
            other = Monitor.restore(rules, json.loads(json.dumps(other.snapshot())))
            assert other.so_far == msgspec.structs.replace(one.so_far, changes=())
            assert other.violations == one.violations
        assert answer(one, state, objects) == answer(other, state, objects)
    assert one.snapshot() == other.snapshot()


def answer(monitor, state, objects):
    try:
        return monitor.step(state, objects)
    except RulecError as refused:
        return refused.diagnostics


@given(rulebooks(), journeys())
def test_what_it_has_learnt_can_be_forgotten_at_any_time(rulebook, journey):
    rules = compile_here(rulebook)
    one, other = Monitor(rules), Monitor(rules)
    for state, objects in journey:
        with pytest.MonkeyPatch.context() as patched:
            patched.setattr("rulec.monitoring.online.running_monitor.MOST_CACHED", 0)
            patched.setattr("rulec.monitoring.online.group_letters.MOST", 1)
            forgetful = answer(one, state, objects)
        assert forgetful == answer(other, state, objects)
    assert one.snapshot() == other.snapshot()


@given(rulebooks(), journeys())
def test_changes_tell_every_verdict(rulebook, journey):
    """Who begins from `holds so far` and notes the changes knows what is the case."""
    rules = compile_here(rulebook)
    monitor = Monitor(rules)
    known, before = {}, {}
    for state, objects in journey:
        try:
            found = monitor.step(state, objects)
        except RulecError:
            return
        stayed = {name for name in before if name in objects}
        known = {
            key: value for key, value in known.items() if stayed.issuperset(key[1]) or not key[1]
        }
        before = objects
        for change in found.changes:
            key = (change.rule, tuple(change.binding.values()))
            if not change.ended:
                assert known.get(key, start_of(rules, change.rule)) == change.before
                known[key] = change.verdict
        for about in monitor.snapshot()["rules"]:
            for one in about["bindings"]:
                key = (about["rule"], tuple(one["objects"]))
                assert known.get(key, start_of(rules, about["rule"])) == one["verdict"]


def start_of(rules, name):
    machine = next(one.machine for one in rules.rules if one.name == name)
    return "satisfied" if machine.accepting_sink == 0 else "holds so far"
