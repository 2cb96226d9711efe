"""Numbers known within bounds: in margins, in tables, and in JSON."""

import json

import pytest

from rulec import compile_rulebook
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.explain.explanation import explain
from rulec.monitoring.explain.margins import number_with_error
from rulec.monitoring.verdict import ConditionalOutcome, OpenVerdict
from rulec.report.verdicts import verdict_json, violation_table
from rulec.report.verdicts.verdict_report import open_in_words
from rulec.trace import Trace
from rulec.vocabulary.partial_values import UNKNOWN, Interval


@pytest.fixture(scope="module")
def rules(tmp_path_factory):
    folder = tmp_path_factory.mktemp("near")
    (folder / "v.rules").write_text(
        "vocabulary v {\n  type car\n  quantity gap(a: car) in m\n"
        "  quantity speed in km/h\n  signal wet\n}\n"
    )
    source = folder / "near.rules"
    source.write_text(
        "rulebook near\nuse v\n"
        "hard rule half (a: car) { require always (gap(a) >= 1.8 s * speed or wet) }\n"
        "hard rule slow { require always speed <= 50 km/h }\n"
        "hard rule alone { require never some a: car (gap(a) < 10 m) }\n"
    )
    return compile_rulebook(source)


def judged(rules, *states):
    """The trace, and its verdict; each state is a gap, a speed and whether it is wet."""
    named = [{"gap": {"c": gap}, "speed": speed, "wet": wet} for gap, speed, wet in states]
    trace = Trace("t", 1.0, {"c": "car"}, tuple(named))
    return trace, verify(trace, rules)


def outcomes(verdict):
    found = {violation.rule: "violated" for violation in verdict.violations}
    return found | {one.rule: one.because for one in verdict.open}


def test_a_comparison_is_sure_if_it_is_for_all_numbers_within_bounds(rules):
    # 1.8 s at 50 km/h are 25 m
    near, far = Interval(24.0, 24.9), Interval(25.1, 26.0)
    assert outcomes(judged(rules, (near, 50.0, False))[1]) == {"half": "violated"}
    assert outcomes(judged(rules, (far, 50.0, False))[1]) == {}
    assert outcomes(judged(rules, (30.0, Interval(50.1, 51.0), False))[1]) == {"slow": "violated"}
    assert outcomes(judged(rules, (30.0, Interval(49.0, 50.0), False))[1]) == {}
    across = Interval(24.0, 26.0)
    assert outcomes(judged(rules, (across, 50.0, False))[1]) == {"half": ("tolerance",)}
    assert outcomes(judged(rules, (across, 50.0, UNKNOWN))[1]) == {
        "half": ("not told", "tolerance")
    }
    # Of a count, too
    assert "alone" not in outcomes(judged(rules, (Interval(10.0, 11.0), 1.0, False))[1])
    assert "alone" in outcomes(judged(rules, (Interval(9.0, 9.9), 1.0, False))[1])


def test_an_open_verdict_says_that_the_limit_is_within_the_tolerance(rules):
    _, verdict = judged(rules, (30.0, Interval(49.5, 50.5), False))
    (result,) = verdict.open
    assert (result.depends_on, result.because) == (("speed",), ("tolerance",))
    assert open_in_words(result) == (
        "open, depends on speed; a limit is within the tolerance of what was measured: "
        "violated if speed > 50, kept if speed <= 50"
    )


def test_values_that_decide_only_by_changing_are_said_to():
    """Each of them kept all the time keeps the rule, and yet it is open."""
    cases = tuple(ConditionalOutcome({"slow": value}, "kept") for value in (True, False))
    result = OpenVerdict("half", "hard", {}, ("not told",), ("slow",), cases)
    assert open_in_words(result) == "open, depends on slow: kept if none of them changes"


def test_sides_have_errors_and_what_is_sure_is_said(rules):
    """24 to 24.4 m are at least 0.4 m short of 1.8 s at 49.6 to 50.4 km/h, 24.8 to 25.2 m."""
    trace, verdict = judged(rules, (Interval(24.0, 24.4), Interval(49.6, 50.4), False))
    (violation,) = verdict.violations
    explanation = explain(violation, trace, rules)
    (margin,) = explanation.margins()
    assert str(margin) == "gap(c) 24.2±0.2 m < 25.0±0.2 m, by at least 0.40 m"
    assert (margin.by, margin.at_least) == (pytest.approx(0.8), pytest.approx(0.4))
    assert "F 24.2±0.2 < 25.0±0.2" in violation_table.as_text(explanation)
    assert "gap(c) in m" in violation_table.as_text(explanation)
    facts = json.loads(verdict_json.as_json(verdict, rules, [explanation]))["violations"][0]
    values = {fact["reads"]: fact["values"] for fact in facts["explanation"]["facts"]}
    assert values["gap(c)"] == [{"from": 24.0, "to": 24.4}]
    assert values["speed"] == [{"from": 49.6, "to": 50.4}]


def test_what_does_not_hinge_on_a_number_is_not_by_any_amount(rules):
    near = Interval(24.0, 26.5)
    trace, verdict = judged(rules, (20.0, 40.0, False), (near, 50.0, UNKNOWN), (24.0, 50.0, False))
    (violation,) = [one for one in verdict.violations if one.rule == "half"]
    (margin,) = explain(violation, trace, rules).margins()
    assert (margin.at_least, str(margin)) == (1.0, "gap(c) 24 m < 25 m")


@pytest.mark.parametrize(
    ("value", "error", "text"),
    [
        (36.0, 1.08, "36.0±1.1"),
        (26.0, 0.3, "26.0±0.3"),
        (50.112, 0.018, "50.11±0.02"),
        (21.32, 0.316, "21.3±0.4"),
        (100.0, 20.0, "100±20"),
        (-3.0, 0.5, "-3.0±0.5"),
        # More than half of it: both bounds
        (502.0, 498.1, "3.9 to 1000.1"),
        (0.2, 0.3, "-0.1 to 0.5"),
        (0.0, 0.25, "-0.25 to 0.25"),
    ],
)
def test_as_many_decimals_as_the_error_has(value, error, text):
    assert number_with_error(value, error) == text


def test_the_middle_of_bounds():
    assert (Interval(25.7, 26.3).middle, Interval(25.7, 26.3).error) == (26.0, pytest.approx(0.3))
    tiny = Interval(1e-12, 3e-12)
    assert tiny.low <= tiny.middle <= tiny.high
