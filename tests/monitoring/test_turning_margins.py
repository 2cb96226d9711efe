"""The margin that an explanation gives: had it been closed, the rule would have been kept there."""

from dataclasses import replace

import pytest

from rulec import Verdict, compile_rulebook, explain, load_rulebook, verify, verify_many
from rulec.book_tests.example_runs import example_trace
from rulec.logic import formula as ltl
from rulec.trace import Trace

BOOKS = [
    *("de", "us-ca", "jp"),
    *(pytest.param(name, marks=pytest.mark.long) for name in ("vienna", "fr", "au")),
]


def closed(trace, part, about, states):
    """The trace with the quantity of a part's comparison just beyond its limit in some states."""
    ((_, term),) = part.formula.terms
    margin, _ = part.measured
    number = margin.limit + (-1e-6 if margin.relation in (">", ">=", "=") else 1e-6)
    changed = [dict(own) for own in trace.states]
    for state in states:
        if term.arguments:
            item = about[term.arguments[0]]
            changed[state][term.name] = {**changed[state].get(term.name, {}), item: number}
        else:
            changed[state][term.name] = number
    return replace(trace, states=tuple(changed))


def compared(explanation):
    """The parts whose margins are given, of those that compare one quantity with a number."""
    given = [margin.text for margin in explanation.margins()]
    return [
        part
        for part in explanation.parts
        if part.measured and part.measured[0].text in given and (part.turns or part.decides)
        if len(part.formula.terms) == 1 and isinstance(part.formula.terms[0][1], ltl.QuantityTerm)
    ]


def violations_of(rule, compiled):
    """The rule alone, and each violation in its examples that give all that it reads."""
    alone = replace(compiled, rules=tuple(own for own in compiled.rules if own.name == rule.name))
    for example in rule.examples:
        trace = example_trace(rule, example)
        (answer,) = verify_many([trace], alone)
        if not example.accepts and isinstance(answer, Verdict):
            yield from ((trace, alone, violation) for violation in answer.violations)


@pytest.mark.parametrize("name", BOOKS)
def test_a_closed_margin_keeps_the_rule_where_it_was_lost(name):
    """Where it decides; of several margins, one is enough."""
    compiled, seen = compile_rulebook(name), 0
    for rule in load_rulebook(name).rules:
        for trace, alone, violation in violations_of(rule, compiled):
            explanation = explain(violation, trace, alone)
            parts = compared(explanation)
            every = range(len(trace.states))
            others = [
                closed(trace, part, violation.binding, [part.measured[1]] if part.turns else every)
                for part in parts
            ]
            found = [answer.violations for answer in verify_many(others, alone)]
            seen += bool(found)
            assert not found or any(violation not in own for own in found), (rule.name, trace.id)
    assert seen > 5


def test_a_stop_sign_is_about_how_slow_ego_was():
    """Not about how fast it may creep after a stop that it never made."""
    rules = compile_rulebook("de")
    speeds = [30.0, 20.0, 10.0, 6.0, 4.0, 6.0, 9.0, 15.0, 20.0]
    states = tuple(
        {
            "stop_sign": True,
            "crosses_stop_line": k > 6,
            "speed": speed,
            "distance_to_stop_line": 1.0,
        }
        for k, speed in enumerate(speeds)
    )
    trace = Trace("t", 0.5, {}, states)
    (violation,) = (x for x in verify(trace, rules).violations if x.rule == "stop_sign")
    (margin,) = explain(violation, trace, rules).margins()
    assert (margin.text, margin.value, margin.relation) == ("speed", 4.0, ">=")
    assert margin.limit < 4.0
