"""Margins: both sides of a comparison, in one unit, with as many decimals as tell them apart."""

import pytest

from rulec import compile_rulebook
from rulec.monitoring.explain.explanation import explain
from rulec.monitoring.explain.margins import Margin
from rulec.monitoring.verify import verify
from rulec.report.verdicts import violation_table
from rulec.trace import Trace


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
    assert [str(one) for one in margins] == ["limit 50.000 km/h < speed 50.002 km/h"]


def test_a_count_is_no_measure(rules):
    margins, table = explained(rules, "few", (24.0, 50.0, 50.0))
    assert margins == []
    assert "1 <" not in table


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
