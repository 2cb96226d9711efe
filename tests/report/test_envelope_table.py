"""Envelopes as columns: every stretch of every cell, in three formats that agree."""

import csv
import io
import json
from itertools import pairwise

import pytest
from hypothesis import assume, given

from rulec import find_maneuvers
from rulec.diagnostics import RulecError
from rulec.partition import envelope, navigation_graph
from rulec.report.maneuvers.envelope_table import COLUMNS, stretches, write_envelopes
from support.generators.random_scenarios import scenarios


@given(scenarios())
def test_stretches_cover_a_cell_and_agree_with_its_bounds(scenario):
    try:
        graph = navigation_graph(scenario)
    except RulecError:
        assume(False)
    (bounds,) = envelope(graph, [graph.start])
    found = list(stretches(bounds))
    assert (found[0][0], found[-1][1]) == (bounds.s_min, bounds.s_max)
    assert all(one[1] == other[0] for one, other in pairwise(found))
    assert all(start < end for start, end, _, _ in found)
    for start, _, right, left in found:
        for profile, d in ((bounds.d_right, right), (bounds.d_left, left)):
            assert [there for s, there in profile if s <= start][-1] == d


def table(form, number):
    found = find_maneuvers("s2", "esterle2019")
    stream = io.BytesIO()
    write_envelopes(found.graph, found.cheapest(number), stream, "f", form)
    return stream.getvalue()


def test_the_cheapest_stays_behind():
    """Behind o1, whose rear is at 22.5 + 8 t - t^2 as each second begins; it costs nothing."""
    data = table("jsonl", 1)
    rows = [json.loads(line) for line in data.splitlines()]
    assert [list(row) for row in rows] == [["version", *COLUMNS]] * 5
    rears = (22.5, 29.5, 34.5, 37.5, 38.5)
    for layer, (row, rear) in enumerate(zip(rows, rears, strict=True)):
        assert row == {
            "version": 1,
            "maneuver": 1,
            "cost": 0.0,
            "margin_s": None,
            "layer": layer,
            "start_s": layer,
            "end_s": layer + 1,
            "cell": 0,
            "surface": "carriageway",
            "s_min": -60,
            "s_max": rear,
            "d_right": -1.75,
            "d_left": 1.75,
        }


def test_the_formats_agree():
    parquet = pytest.importorskip("pyarrow.parquet")
    lines = table("jsonl", 20)
    expected = [json.loads(line) for line in lines.splitlines()]
    assert {row.pop("version") for row in expected} == {1}
    assert {row["maneuver"] for row in expected} == set(range(1, 21))
    arrow = parquet.read_table(io.BytesIO(table("parquet", 20)))
    assert arrow.to_pylist() == expected
    comma = csv.DictReader(io.StringIO(table("csv", 20).decode()))
    read = [
        {name: COLUMNS[name](cell) if cell else None for name, cell in row.items()} for row in comma
    ]
    assert read == expected
