"""A table of maneuvers' envelopes, for trajectory planners that read columns."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import pairwise
from typing import IO, Any

from rulec.partition import Envelope, NavigationGraph, envelope
from rulec.planning.ranking.cheapest import Maneuver
from rulec.report.json_document import JsonDocument, as_line
from rulec.scenario.scenario_model import Surface
from rulec.trace import Value
from rulec.trace.formats.arrow.parquet import write_parquet
from rulec.trace.formats.csv_table import write_csv
from rulec.trace.formats.trace_files import Format


class EnvelopeLine(JsonDocument, frozen=True, kw_only=True):
    """A stretch of a maneuver's layer with constant bounds (m, s)."""

    maneuver: int
    cost: float
    margin_s: float | None
    layer: int
    start_s: float
    end_s: float
    cell: int
    surface: Surface
    s_min: float
    s_max: float
    d_right: float
    d_left: float


_TYPES = {"maneuver": int, "layer": int, "cell": int, "surface": str}

COLUMNS = {name: _TYPES.get(name, float) for name in EnvelopeLine.__struct_fields__[1:]}
"""The columns with their values' types; the first three are equal in all rows of a maneuver."""


def write_envelopes(
    graph: NavigationGraph,
    maneuvers: Iterable[Maneuver],
    stream: IO[bytes],
    file: str,
    form: Format,
) -> None:
    """Write the envelopes of maneuvers, numbered from 1.

    Raises RulecError: R0706 if Parquet is not available.
    """
    rows = _rows(graph, maneuvers)
    if form == "csv":
        write_csv(rows, list(COLUMNS), stream)
    elif form == "parquet":
        write_parquet(rows, list(COLUMNS.items()), stream, file)
    else:
        for row in rows:
            values: dict[str, Any] = dict(zip(COLUMNS, row, strict=True))
            stream.write(f"{as_line(EnvelopeLine(**values))}\n".encode())


def _rows(
    graph: NavigationGraph, maneuvers: Iterable[Maneuver]
) -> Iterator[tuple[Value | None, ...]]:
    for number, maneuver in enumerate(maneuvers, 1):
        envelopes = envelope(graph, maneuver.nodes)
        for layer, (cell, bounds) in enumerate(zip(maneuver.nodes, envelopes, strict=True)):
            here = graph.layers[layer]
            when = (layer, float(here.start_s), float(here.start_s + graph.step_s))
            for stretch in stretches(bounds):
                yield (
                    number,
                    maneuver.cost,
                    maneuver.margin_s,
                    *when,
                    cell,
                    here.cells[cell].surface,
                    *map(float, stretch),
                )


def stretches(bounds: Envelope) -> Iterator[tuple[float, float, float, float]]:
    """Stretches with constant bounds: s from, s to, d right, d left (m)."""
    right, left = dict(bounds.d_right), dict(bounds.d_left)
    low = high = 0.0
    for start, end in pairwise([*sorted({*right, *left}), bounds.s_max]):
        low, high = right.get(start, low), left.get(start, high)
        yield start, end, low, high
