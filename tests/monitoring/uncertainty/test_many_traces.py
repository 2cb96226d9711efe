"""Many traces of which not all is known get the verdicts that they get one by one."""

from copy import deepcopy
from dataclasses import replace
from fractions import Fraction

import pytest
from hypothesis import Phase, given, settings

import rulec
from rulec.diagnostics import RulecError
from rulec.logic.free_names import names_in
from rulec.monitoring.batch.batch_verify import verify_many
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.trace import Trace
from rulec.vocabulary.partial_values import UNKNOWN, Interval
from support.builders.rulebooks import compile_here
from support.engines.trace_engines import first_part, with_own_names
from support.generators.blurred_traces import blurred
from support.generators.constant_values import steady, with_some_constant, with_unknown_constants
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds

COPIES = 5
"""Of one shape, and of states of their own, so many are judged together."""


def with_own_states(trace, number):
    return replace(trace, states=tuple(deepcopy(trace.states)))


def in_common_names(answer):
    if isinstance(answer, NotJudged):
        return answer.error.diagnostics[0].code
    violations, doubtful = (
        tuple(
            replace(one, binding={name: first_part(x) for name, x in one.binding.items()})
            for one in found
        )
        for found in (answer.violations, answer.open)
    )
    return replace(answer, violations=violations, open=doubtful)


def seen(chance, trace, names):
    """Perhaps cut out of something longer, perhaps from a source that cannot tell all."""
    told = None
    if chance.random() < 0.4:
        told = frozenset(name for name in names if chance.random() < 0.7)
    return replace(trace, ends="cut" if chance.random() < 0.3 else "complete", told=told)


@given(seeds)
@settings(phases=[Phase.generate])
def test_together_they_get_the_verdicts_of_each(chance):
    book = with_some_constant(chance, rulebook(chance, Fraction(1)))
    compiled, constants = compile_here(book, Fraction(1)), book.vocabulary.constants
    names = {n for x in (*book.rules, *book.axioms) for n in names_in(x.formula)}
    every = []
    for whole in traces(chance, Fraction(1))[:3]:
        dark = blurred(chance, whole, names - set(constants), most=12)
        dark = with_unknown_constants(chance, steady(dark, constants), constants)
        every.append(seen(chance, dark, book.vocabulary.declarations))
    for copied in (lambda trace, _: trace, with_own_states, with_own_names):
        many = [copied(trace, number) for number in range(COPIES) for trace in every]
        answers = list(map(in_common_names, verify_many(many, compiled)))
        for trace, answer in zip(many, answers, strict=True):
            assert answer == in_common_names(verify_or_reason(trace, compiled)), trace


BOOK = """\
rulebook many
type car
signal clear default true
quantity speed in m/s default 0
signal parked(c: car) default false
quantity limit in m/s default 10
hard rule slow { require always (speed <= limit) }
hard rule between { require always (speed - limit <= 3 m/s or clear) }
hard rule one_parked { require always (count c: car (parked(c)) <= 1) }
hard rule other_parked (v: car) { require always not some c: car (c = v and parked(c)) }
"""
OBJECTS = {"a": "car", "b": "car", "c": "car"}


@pytest.mark.parametrize(
    ("state", "violated", "undecided"),
    [
        ({"speed": UNKNOWN}, [], ["slow"]),
        ({"speed": Interval(11, 12)}, ["slow"], []),
        ({"speed": Interval(9, 12), "clear": UNKNOWN}, [], ["slow"]),
        ({"speed": Interval(9, 14), "clear": False}, [], ["slow", "between"]),
        ({"speed": UNKNOWN, "limit": UNKNOWN, "clear": UNKNOWN}, [], ["slow", "between"]),
        ({"parked": {"a": UNKNOWN}}, [], ["other_parked"]),
        ({"parked": {"a": UNKNOWN, "b": True}}, ["other_parked"], ["one_parked", "other_parked"]),
        ({"parked": UNKNOWN}, [], ["one_parked", *["other_parked"] * 3]),
        (
            {"parked": {"a": True, "b": True, "c": UNKNOWN}},
            ["one_parked", "other_parked", "other_parked"],
            ["other_parked"],
        ),
    ],
)
def test_letters_of_sums_and_counts(state, violated, undecided):
    compiled = rulec.compile(rulec.parse_rulebook(BOOK))
    several = [Trace(str(n), 1.0, OBJECTS, ({}, deepcopy(state))) for n in range(COPIES)]
    for answer in verify_many(several, compiled):
        assert isinstance(answer, Verdict)
        assert [one.rule for one in answer.violations] == violated
        assert [one.rule for one in answer.open] == undecided


def test_what_open_verdicts_depend_on_is_found_later():
    compiled = rulec.compile(rulec.parse_rulebook(BOOK))
    several = [Trace(str(n), 1.0, {}, ({"speed": UNKNOWN},)) for n in range(COPIES)]
    (verdict, *_) = verify_many(several, compiled)
    (slow,) = verdict.open
    assert (slow.depends_on, slow.because, slow.exact) == (("speed",), ("not told",), True)


def test_a_missing_value_is_an_error_beside_unknown_ones():
    text = "rulebook r signal p, q hard rule r { require always (p implies q) }"
    compiled = rulec.compile(rulec.parse_rulebook(text))
    several = [Trace(str(n), 1.0, {}, ({"p": UNKNOWN, "q": True},)) for n in range(COPIES)]
    several.append(Trace("lacks", 1.0, {}, ({"p": UNKNOWN},)))
    *judged, lacking = verify_many(several, compiled)
    assert all(answer.satisfied for answer in judged)
    assert isinstance(lacking, NotJudged)
    assert isinstance(lacking.error, RulecError)


NEAR = """\
rulebook near
type car
signal clear default false
quantity gap(c: car) in m default 9
hard rule few { require always (count c: car (gap(c) < 5 m and not clear) <= 1 or clear) }
hard rule all { require always (count c: car (gap(c) = 5 m or clear) >= 1) }
hard rule own (v: car) { require always not some c: car (c = v and (gap(c) > 5 m or clear)) }
"""
GAPS = (3, 3.5, 5, 7, 7.25, UNKNOWN, Interval(3, 4), Interval(4, 6), Interval(5, 8))


@given(seeds)
@settings(phases=[Phase.generate])
def test_what_is_alike_is_found_again_in_later_traces(chance):
    compiled = rulec.compile(rulec.parse_rulebook(NEAR))
    for _ in range(3):
        # Some say nothing of one name, and of nobody else's numbers there are as many regions
        names = chance.sample(["clear", "gap"], chance.randint(1, 2))
        objects = dict(list(OBJECTS.items())[: chance.randint(1, 3)])
        several = [
            Trace(
                *(str(n), 1.0, objects),
                tuple(
                    {
                        name: chance.choice([False, True, UNKNOWN])
                        if name == "clear"
                        else {item: chance.choice(GAPS) for item in objects}
                        for name in names
                    }
                    for _ in range(2)
                ),
            )
            for n in range(COPIES)
        ]
        for trace, answer in zip(several, verify_many(several, compiled), strict=True):
            assert answer == verify_or_reason(trace, compiled), trace
