"""The margin that an explanation gives: had it been closed, the rule would have been kept there."""

from dataclasses import replace

import pytest

from rulec import compile_rulebook, explain, load_rulebook, verify
from rulec.book_tests.example_runs import example_trace
from rulec.logic import formula as ltl
from rulec.trace import Trace

BOOKS = ("vienna", "de", "fr", "us-ca", "jp", "au")


def closed(trace, part, about, margin, state):
    """The trace with the quantity of a part's comparison on the other side of its limit."""
    ((_, term),) = part.formula.terms
    beyond = 1e-6 * (-1 if margin.value > margin.limit else 1)
    number = margin.limit + (0.0 if part.formula.relation == "=" else beyond)
    states = [dict(own) for own in trace.states]
    for name in term.arguments[:1]:
        states[state][term.name] = {**states[state].get(term.name, {}), about[name]: number}
    if not term.arguments:
        states[state][term.name] = number
    return replace(trace, states=tuple(states))


@pytest.mark.parametrize("name", BOOKS)
def test_a_closed_margin_keeps_the_rule_where_it_was_lost(name):
    book, rules = load_rulebook(name), compile_rulebook(name)
    turned = 0
    for rule in book.rules:
        for example in rule.examples:
            if example.accepts:
                continue
            trace = example_trace(rule, example)
            for violation in verify(trace, rules).violations:
                if violation.rule != rule.name:
                    continue
                explanation = explain(violation, trace, rules)
                for part in explanation.parts:
                    if not part.turns or len(part.formula.terms) > 1:
                        continue
                    if not isinstance(part.formula.terms[0][1], ltl.QuantityTerm):
                        continue
                    margin, state = part.measured
                    turned += 1
                    other = closed(trace, part, violation.binding, margin, state)
                    assert violation not in verify(other, rules).violations, (rule.name, margin)
    assert turned or name == "vienna"


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
