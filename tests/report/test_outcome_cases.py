"""How an open verdict comes out is said in few cases, which say the same as all."""

from itertools import product

from hypothesis import given
from hypothesis import strategies as st

from rulec.monitoring.verdict import ConditionalOutcome
from rulec.report.verdicts.verdict_report import fewest_cases

VALUES = {"a": (True, False), "b": (True, False), "c": (True, False), "light": ("red", "green")}
EVERY = [dict(zip(VALUES, values, strict=True)) for values in product(*VALUES.values())]


def outcomes(violated):
    """All cases, of which those at these places are violations."""
    return [
        ConditionalOutcome(when, "violated" if place in violated else "kept")
        for place, when in enumerate(EVERY)
    ]


@given(st.sets(st.integers(0, len(EVERY) - 1)))
def test_each_case_has_its_outcome_and_no_other(violated):
    given_cases = outcomes(violated)
    fewest = fewest_cases(given_cases)
    for case in given_cases:
        said = {one.outcome for one in fewest if one.when.items() <= case.when.items()}
        assert said == {case.outcome}
    assert len(fewest) <= len(given_cases)


def test_what_does_not_matter_is_left_out_and_what_breaks_the_rule_comes_first():
    violated = {
        place
        for place, when in enumerate(EVERY)
        if when["a"] and not when["b"] and when["light"] == "red"
    }
    first, *others = fewest_cases(outcomes(violated))
    assert first == ConditionalOutcome({"a": True, "b": False, "light": "red"}, "violated")
    conditions = sorted(tuple(one.when.items()) for one in others)
    assert conditions == [(("a", False),), (("b", True),), (("light", "green"),)]


def test_nothing_is_said_of_nothing():
    assert fewest_cases([]) == []
