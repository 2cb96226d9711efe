"""Opportunities one by one: by hand, and on random rulebooks as parts of the verdict."""

from fractions import Fraction

from hypothesis import Phase, given, settings

from rulec.diagnostics import RulecError
from rulec.logic.free_names import names_in
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.moments.drive_facts import facts_of
from rulec.monitoring.moments.opportunity_outcomes import opportunities_of
from rulec.monitoring.verdict import rule_for
from rulec.rulebook.loader import parse_rulebook
from rulec.trace import Trace
from support.builders.rulebooks import compile_here
from support.builders.short_states import state_of
from support.generators.blurred_traces import blurred
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds

HEAD = """
rulebook counted
type vehicle
signal red, go default false
signal beside(v: vehicle), close(v: vehicle) default false
"""

WORST = ("kept", "open", "violated")


def told(rule, *states, objects=("a", "b")):
    """Each opportunity of a trace as the objects, its states and what became of it."""
    compiled = compile_here(parse_rulebook(HEAD + rule), Fraction(1))
    every = dict.fromkeys(objects, "vehicle")
    trace = Trace("t", 1.0, every, tuple(map(state_of, states)))
    found = opportunities_of(trace, compiled, verify(trace, compiled))
    return [
        ("".join(own.binding.values()), own.first, own.last, own.outcome, own.certain)
        for own in found
    ]


def test_one_after_the_other():
    rule = "hard rule r { require always (red implies not go) }"
    assert told(rule, "", "red", "red", "go", "red go", "") == [
        ("", 1, 2, "kept", True),
        ("", 4, 4, "violated", True),
    ]


def test_each_choice_of_objects_has_its_own():
    rule = "hard rule r (v: vehicle) { require always (beside(v) implies not close(v)) }"
    assert told(rule, "beside(a)", "beside(a) close(a) beside(b)", "", "beside(b)") == [
        ("a", 0, 1, "violated", True),
        ("b", 1, 1, "kept", True),
        ("b", 3, 3, "kept", True),
    ]


def test_one_unknown_state_leaves_one_of_them_open():
    rule = "hard rule r { require always (red implies not go) }"
    assert told(rule, "red", "", "red ?go", "", "red", "?red") == [
        ("", 0, 0, "kept", True),
        ("", 2, 2, "open", True),
        ("", 4, 5, "kept", True),
    ]
    assert told(rule, "?red ?go") == [("", 0, 0, "open", False)]


def test_a_rule_without_a_trigger_has_the_whole_trace():
    rule = "hard rule r { require always not go }"
    assert told(rule, "red", "go") == [("", 0, 1, "violated", True)]


def parts_of(verdict):
    """What a verdict says of the objects of each rule that it does not keep."""
    decided = {rule_for(one): "open" for one in verdict.open}
    return decided | {rule_for(one): "violated" for one in verdict.violations}


@given(seeds)
@settings(phases=[Phase.generate], max_examples=30)
def test_the_verdict_is_their_sum(chance):
    book = rulebook(chance, Fraction(1))
    compiled = compile_here(book, Fraction(1))
    names = {name for rule in book.rules for name in names_in(rule.formula)}
    for whole in traces(chance, Fraction(1)):
        for trace in (whole, blurred(chance, whole, names)):
            try:
                verdict = verify(trace, compiled)
            except RulecError:
                continue
            outcomes = {}
            for own in opportunities_of(trace, compiled, verdict):
                assert 0 <= own.first <= own.last < len(trace.states)
                about = own.rule, tuple(own.binding.values())
                outcomes.setdefault(about, []).append(own.outcome)
            worst = {about: max(those, key=WORST.index) for about, those in outcomes.items()}
            assert {about: what for about, what in worst.items() if what != "kept"} == parts_of(
                verdict
            )
            for name, own in facts_of(trace, compiled, verdict).exposure.items():
                number = sum(len(those) for (rule, _), those in outcomes.items() if rule == name)
                assert own.opportunities <= number
                assert (number == 0) == (own.perhaps_opportunities == 0)
