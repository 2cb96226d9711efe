"""Margins: both sides of a comparison, in one unit, with as many decimals as tell them apart."""

import pytest

from rulec import compile_rulebook
from rulec.monitoring.batch.verify import verify
from rulec.monitoring.explain.explanation import explain
from rulec.monitoring.explain.margins import Margin
from rulec.report.verdicts import violation_table
from rulec.trace import Trace
from rulec.vocabulary.partial_values import UNKNOWN


@pytest.fixture(scope="module")
def rules(tmp_path_factory):
    folder = tmp_path_factory.mktemp("margins")
    (folder / "v.rules").write_text(
        "vocabulary v {\n  type car\n  quantity gap(a: car) in m\n  quantity speed in km/h\n"
        "  quantity limit in km/h\n}\n"
    )
    source = folder / "far.rules"
    source.write_text(
        "rulebook far\nuse v\n"
        "hard rule half (a: car) { require always gap(a) >= 1.8 s * speed }\n"
        "hard rule slow { require always speed <= limit }\n"
        "hard rule signed { require always speed <= (limit if limit < 1000 km/h else 130 km/h) }\n"
        "hard rule few { require always (count a: car (gap(a) < 30 m)) < 1 }\n"
    )
    return compile_rulebook(source)


def explained(rules, name, *states, width=100):
    """The margins in the decisive state, and the table's rows by their first words."""
    named = [dict(zip(("gap", "speed", "limit"), state, strict=True)) for state in states]
    trace = Trace(
        "t", 1.0, {"c": "car"}, tuple(state | {"gap": {"c": state["gap"]}} for state in named)
    )
    violation = next(one for one in verify(trace, rules).violations if one.rule == name)
    explanation = explain(violation, trace, rules)
    return explanation.margins(), violation_table.as_text(
        explanation, violation_table.TableOptions(width=width)
    )


def test_a_comparison_with_a_multiple(rules):
    """1.8 s at 50 km/h are 25 m: the gap is in m, so half the number of the speed."""
    margins, table = explained(rules, "half", (40.0, 50.0, 50.0), (24.9, 50.0, 50.0))
    assert [str(one) for one in margins] == ["gap(c) 24.9 m < 25.0 m"]
    assert "T 40 >= 25  F 24.9 < 25.0" in table


def test_both_sides_have_names_where_both_are_quantities(rules):
    margins, _ = explained(rules, "slow", (40.0, 50.002, 50.0))
    assert [str(one) for one in margins] == ["speed 50.002 km/h > limit 50.000 km/h"]


@pytest.mark.parametrize(
    ("limit", "said"),
    [(50.0, "speed 140 km/h > limit 50 km/h"), (1000.0, "speed 140 km/h > 130 km/h")],
)
def test_what_chooses_the_limit_is_no_margin(rules, limit, said):
    """That a sign says less than 1000 km/h, or none does, is not by how much ego is too fast."""
    margins, _ = explained(rules, "signed", (40.0, 140.0, limit))
    assert [str(one) for one in margins] == [said]


def test_a_count_is_no_measure(rules):
    margins, table = explained(rules, "few", (24.0, 50.0, 50.0))
    assert margins == []
    assert "1 <" not in table


def test_what_was_too_little_all_along_is_measured_while_it_counted(tmp_path):
    """Who passes has to be faster by 10 km/h while beside the other, not when it is past."""
    book = tmp_path / "passing.rules"
    book.write_text(
        "rulebook passing\nuse road\n"
        "hard rule faster (v: vehicle) {\n"
        "  require never (behind(v) then beside(v) then in_front_of(v))\n"
        "  unless beside(v) and speed_difference(v) >= 10 km/h at some point\n}\n"
    )
    rules = compile_rulebook(book)
    passing = [("behind", 12.0), ("beside", 9.0), ("beside", 9.5), ("in_front_of", 10.5)]
    states = [
        {"station": {"c": station}, "speed_difference": {"c": faster}}
        for station, faster in passing
    ]
    trace = Trace("t", 1.0, {"c": "car"}, tuple(states))
    (violation,) = verify(trace, rules).violations
    assert violation.step == 3
    (found,) = explain(violation, trace, rules).margins()
    assert str(found) == "speed_difference(c) 9.5 km/h < 10.0 km/h"


def test_what_may_have_been_broken_before_is_not_what_is_measured(tmp_path):
    """Whether both were alike at first nobody knows: that violated nothing for sure."""
    book = tmp_path / "alike.rules"
    book.write_text(
        "rulebook alike\ntype car\nsignal a\nsignal b\nquantity gap(c: car) in m\n"
        "hard rule far (c: car) { require always ((a iff b) implies gap(c) >= 15 m) }\n"
    )
    rules = compile_rulebook(book)
    said = [(UNKNOWN, False, 5.0), (True, True, 20.0), (True, True, 12.0), (True, False, 3.0)]
    states = tuple([{"a": a, "b": b, "gap": {"c": gap}} for a, b, gap in said])
    trace = Trace("t", 1.0, {"c": "car"}, states, ends="cut")
    (violation,) = verify(trace, rules).violations
    assert violation.step == 2
    explanation = explain(violation, trace, rules, repaired=False)
    assert [str(margin) for margin in explanation.margins()] == ["gap(c) 12 m < 15 m"]


def test_what_decides_in_a_state_that_is_not_shown_is_measured_there(tmp_path):
    """Beside the other ego was faster by 2 km/h, and passed it long ago."""
    book = tmp_path / "long.rules"
    book.write_text(
        "rulebook long\nuse road\n"
        "hard rule faster (v: vehicle) {\n"
        "  require never (behind(v) then beside(v) then wet)\n"
        "  unless not beside(v) or speed_difference(v) >= 10 km/h throughout\n}\n"
    )
    rules = compile_rulebook(book)
    passing = [("behind", 1.0), ("beside", 2.0)] + [("beside", 12.0)] * 30 + [("beside", 13.0)]
    states = [
        {"station": {"c": station}, "speed_difference": {"c": faster}, "wet": faster == 13.0}
        for station, faster in passing
    ]
    trace = Trace("t", 1.0, {"c": "car"}, tuple(states))
    (violation,) = verify(trace, rules).violations
    assert violation.step == len(states) - 1
    explanation = explain(violation, trace, rules)
    assert 1 not in explanation.states
    assert [str(margin) for margin in explanation.margins()] == [
        "speed_difference(c) 2 km/h < 10 km/h"
    ]


def test_numbers_are_told_apart():
    def sides(value, limit):
        return Margin("x", value, "<", limit, "").sides

    assert sides(3.0, 4.0) == "3 < 4"
    assert sides(3.25, 4.0) == "3.2 < 4.0"
    assert sides(3.9996, 4.0) == "3.9996 < 4.0000"
    assert sides(0.1 + 0.2, 0.3) == "0.3 < 0.3"


def test_the_table_takes_the_width_that_there_is(rules):
    states = [(100.0 - 7.5 * n, 50.0, 50.0) for n in range(12)]
    _, narrow = explained(rules, "half", *states, width=80)
    _, wide = explained(rules, "half", *states, width=200)
    assert max(map(len, narrow.splitlines())) <= 80
    assert 100 < max(map(len, wide.splitlines())) <= 200
    # The first state stays, however narrow.
    heads = next(line for line in narrow.splitlines() if line.lstrip().startswith("state"))
    assert heads.split()[1] == "0"


def test_what_only_says_when_the_rule_asks_is_no_margin(tmp_path):
    book = tmp_path / "kept.rules"
    book.write_text(
        "rulebook kept\nuse road\n"
        "hard rule indicator_on { require always (speed >= 1 km/h implies wet) }\n"
        "hard rule far (v: vehicle) {\n"
        "  require always (speed >= 1 km/h and wet implies gap(v) >= 15 m)\n}\n"
    )
    rules = compile_rulebook(book)
    near = {"speed": 50.0, "wet": True, "gap": {"c": 5.5}}
    trace = Trace("t", 1.0, {"c": "car"}, (near, near | {"wet": False}))
    dry, far = sorted(verify(trace, rules).violations, key=lambda one: one.rule == "far")
    assert explain(dry, trace, rules).margins() == []
    explanation = explain(far, trace, rules)
    assert [str(one) for one in explanation.margins()] == ["gap(c) 5.5 m < 15.0 m"]
    lines = str(explanation).splitlines()
    assert lines[0] == "hard rule far for v = c: violated in state 0"
    assert "  gap(c) 5.5 m < 15.0 m" in lines
    assert "  wet: true" in lines


def test_of_an_interval_there_are_bounds_and_no_middle():
    middle, half = (3.03 + 1000) / 2, (1000 - 3.03) / 2
    wide = Margin("x", middle, ">=", 3.0, "s", value_error=half, error=half)
    assert wide.value_bounds == (3.03, 1000.0)
    assert (wide.by, wide.at_least) == (0.03, 0.03)
    assert wide.rounded().value_bounds == (3.03, 1000.0)
    narrow = Margin("x", 12.3, "<", 15.5, "m", value_error=0.1, limit_error=0.1, error=0.2)
    assert narrow.value_bounds is None
    assert (narrow.by, narrow.at_least) == (3.2, 3.0)


@pytest.mark.parametrize(
    ("value", "error", "sure"),
    [(4.0, 0.0, True), (4.0, 0.9, True), (4.0, 1.0, True), (4.0, 1.1, False), (2.0, 1.1, False)],
)
def test_a_relation_is_sure_if_it_holds_for_all_within_the_errors(value, error, sure):
    relation = ">=" if value >= 3.0 else "<"
    margin = Margin("x", value, relation, 3.0, "s", value_error=error, error=error)
    assert margin.is_sure == sure
    (cell,) = violation_table._with_margins(["T"], [margin])
    assert cell == f"{'T' if sure else '?'} {margin.sides}"


def test_numbers_are_rounded_to_what_their_errors_leave():
    found = Margin(
        *("x", 15.877499999999998, "<", 31.754, "m"),
        value_error=0.34323825544364955,
        limit_error=0.0500001,
        error=0.39,
    ).rounded()
    assert (found.value, found.limit) == (15.877, 31.754)
    # Errors are rounded up
    assert (found.value_error, found.limit_error) == (0.344, 0.051)
    exact = Margin("x", 0.1 + 0.2, "<", 50.000000000001, "m").rounded()
    assert (exact.value, exact.limit) == (0.3, 50.0)
    # Numbers that differ stay apart, however large the error is
    apart = Margin("x", 14.9996, "<", 15.0, "m", value_error=0.3, error=0.3).rounded()
    assert apart.value < apart.limit
