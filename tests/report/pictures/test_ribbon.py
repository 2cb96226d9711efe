"""A trace as a ribbon: its rows, and violations at the state that decides them."""

import pytest

from rulec import compile_rulebook
from rulec.monitoring.batch.verify import verify
from rulec.report.pictures.drawing.canvas import Area, LabelText, Polyline
from rulec.report.pictures.trace_picture import ribbon_entries, ribbon_picture
from rulec.report.pictures.trace_ribbon import ValueRun, ribbon, value_style
from rulec.trace import Trace
from rulec.vocabulary.partial_values import Interval


@pytest.fixture(scope="module")
def rules():
    return compile_rulebook("esterle2019")


def trace(states, objects, **more):
    return Trace("t", 0.5, objects, tuple(states), **more)


OVERTAKEN = trace(
    [{"position": {"v": letter, "w": "b"}, "surface": "R_cw"} for letter in "brrf"],
    {"v": "vehicle", "w": "vehicle"},
    present={"w": (1, 2)},
)


def test_rows(rules):
    found = ribbon(OVERTAKEN, rules, verify(OVERTAKEN, rules), every_row=True)
    rows = {row.title: row.runs for row in found.rows}
    assert found.left_out == 0
    assert list(rows) == ["CONGESTED", "surface", "position(v)", "position(w)"]
    assert rows["CONGESTED"] == (ValueRun(0, 3, value=False),)
    assert rows["position(v)"] == (ValueRun(0, 0, "b"), ValueRun(1, 2, "r"), ValueRun(3, 3, "f"))
    assert rows["position(w)"] == (ValueRun(0, 0, None), ValueRun(1, 2, "b"), ValueRun(3, 3, None))


def test_only_what_violated_rules_read_of_the_objects_in_question(rules):
    """R1 is violated for v; it reads no surface."""
    found = ribbon(OVERTAKEN, rules, verify(OVERTAKEN, rules))
    assert [row.title for row in found.rows] == ["CONGESTED", "position(v)"]
    assert found.left_out == 2


def test_a_number_within_bounds_is_said_with_them(tmp_path):
    source = tmp_path / "s.rules"
    source.write_text("rulebook s\nquantity gap in m\nhard rule A { require always gap > 3 m }\n")
    rules = compile_rulebook(source)
    gaps = (Interval(4.0, 1000.0), Interval(501.5, 502.5), 502.0)
    here = trace([{"gap": gap} for gap in gaps], {})
    (row,) = ribbon(here, rules, verify(here, rules)).rows
    # All have the same middle; what is said of it differs
    assert row.runs == (
        ValueRun(0, 0, 502.0, bounds="4 to 1000"),
        ValueRun(1, 1, 502.0, bounds="502.0±0.5"),
        ValueRun(2, 2, 502.0),
    )


def test_colours_mean_something(tmp_path):
    """True, false, words and unknown have styles that differ, whatever the row."""
    (tmp_path / "w.rules").write_text(
        "vocabulary w {\n  type car\n  signal near(a: car)\n  near_light is one of red_light, off\n"
        "  quantity gap(a: car) in m\n}\n"
    )
    source = tmp_path / "s.rules"
    source.write_text(
        "rulebook s\nuse w\nhard rule A (a: car) "
        "{ require always (near(a) implies off and gap(a) > 3 m) }\n"
    )
    rules = compile_rulebook(source)
    states = [
        {"near": {"a": value}, "near_light": light, "gap": {"a": 1.0}}
        for value, light in ((False, "off"), (True, "off"), (True, "red_light"))
    ]
    here = trace(states, {"a": "car"})
    verdict = verify(here, rules)
    # What a state does not say is unknown where there is no default.
    rows = {
        row.title: row for row in ribbon(trace([*states, {}], here.objects), rules, verdict).rows
    }
    styles = {
        title: [value_style(row, run.value) for run in row.runs]
        for title, row in rows.items()
        if row.values
    }
    assert styles == {
        "near_light": ["word1", "red", "unknown"],
        "near(a)": ["off", "true", "unknown"],
    }
    assert rows["gap(a) in m"].runs == (ValueRun(0, 2, 1.0), ValueRun(3, 3, None, unknown=True))
    hatched = ribbon_picture(ribbon(trace([*states, {}], here.objects), rules, verdict), rules)
    assert sum(mark.style == "unknown" for mark in hatched.marks) == 3
    legend = ribbon_entries(ribbon(here, rules, verdict))
    assert [text for _, text in legend] == [
        "true",
        "false",
        "other colours: a word each",
        "a number, from its least to its greatest value",
        "a violation is decided",
    ]


def test_rows_of_some_objects(rules):
    verdict = verify(OVERTAKEN, rules)
    assert [one.binding for one in verdict.violations] == [{"v": "v"}]
    found = ribbon(OVERTAKEN, rules, verdict, ["w"])
    # What is not said of the road does not matter without the violation.
    assert [row.title for row in found.rows] == ["surface", "position(w)"]
    assert found.violations == ()
    assert ribbon(OVERTAKEN, rules, verdict, ["v"]).violations == verdict.violations


def test_what_is_only_a_default_matters_if_a_violated_rule_reads_it(rules):
    """R1 reads CONGESTED and positions; the surface is read by the other two."""
    here = trace([{"position": {"v": letter}} for letter in "brrf"], {"v": "vehicle"})
    found = ribbon(here, rules, verify(here, rules))
    assert [one.rule for one in found.violations] == ["R1"]
    assert [row.title for row in found.rows] == ["CONGESTED", "position(v)"]
    assert found.left_out == 1


def test_a_violation_is_marked_where_it_is_decided(rules):
    """Passing on the right is done with the state in which v is behind: the last of four."""
    found = ribbon(OVERTAKEN, rules, verify(OVERTAKEN, rules))
    picture = ribbon_picture(found, rules)
    moment, mark = (
        one
        for one in picture.marks
        if isinstance(one, Polyline) and one.style in ("moment", "violation")
    )
    last = next(one for one in picture.marks if isinstance(one, Area) and "f, 1.5" in one.tip)
    assert {x for x, _ in moment.points + mark.points} == {min(x for x, _ in last.rings[0])}
    # The thick part is in the row of v.
    (top, bottom), ys = sorted(y for _, y in mark.points), [y for _, y in last.rings[0]]
    assert top < min(ys) < max(ys) < bottom
    assert bottom - top < 30
    words = [one.text for one in picture.marks if isinstance(one, LabelText)]
    title = (
        "hard rule R1 [Article 11.1, 11.6] for v = v: "
        "cannot be kept any more after state 3, at 1.5 s"
    )
    assert title in words
    assert "1" in words


def test_a_violation_that_the_end_decides_stands_at_the_end(tmp_path):
    source = tmp_path / "late.rules"
    source.write_text(
        "rulebook late\nuse paper\nhard rule A (v: vehicle) { require eventually f(v) }\n"
    )
    rules = compile_rulebook(source)
    here = trace([{"position": {"v": "b"}}] * 2, {"v": "vehicle"})
    found = ribbon(here, rules, verify(here, rules))
    (violation,) = found.violations
    assert (violation.step, found.decisive(violation)) == (None, 2)
    picture = ribbon_picture(found, rules)
    assert any(
        "not fulfilled when the trace ends" in one.text
        for one in picture.marks
        if isinstance(one, LabelText)
    )


def test_quantities_and_pairs(tmp_path):
    (tmp_path / "v.rules").write_text(
        "vocabulary v {\n  type car\n  quantity gap(a: car, b: car) in m\n"
        "  quantity speed(a: car) in m/s\n}\n"
    )
    source = tmp_path / "far.rules"
    source.write_text(
        "rulebook far\nuse v\nhard rule A (a: car, b: car) "
        "{ require always (speed(a) > 3 m/s implies gap(a, b) > 5 m) }\n"
    )
    rules = compile_rulebook(source)
    states = [
        {"speed": {"a": n, "b": 0}, "gap": {"a": {"b": 9 - n}, "b": {"a": 9 - n}}} for n in range(3)
    ]
    here = trace(states, {"a": "car", "b": "car"})
    found = ribbon(here, rules, verify(here, rules))
    assert [row.title for row in found.rows] == [
        "speed(a) in m/s",
        "speed(b) in m/s",
        "gap(a, b) in m",
        "gap(b, a) in m",
    ]
    picture = ribbon_picture(found, rules)
    curves = [one for one in picture.marks if isinstance(one, Polyline) and one.style == "curve"]
    rising, still, falling, _ = ([y for _, y in one.points] for one in curves)
    titles = [
        one.text for one in picture.marks if isinstance(one, LabelText) and one.anchor == "end"
    ]
    assert titles[:3] == ["speed(a) in m/s: 0 to 2", "speed(b) in m/s: 0", "gap(a, b) in m: 7 to 9"]
    # Downwards is more y.
    assert rising == sorted(rising, reverse=True)
    assert rising[0] > rising[-1]
    assert len(set(still)) == 1
    assert falling == sorted(falling)
