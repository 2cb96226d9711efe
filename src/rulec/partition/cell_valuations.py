"""Valuations of cells, which make a navigation graph a trace graph."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from math import lcm

from rulec.partition.cell_graph import CellGraph
from rulec.partition.cells.cell_model import Cell
from rulec.partition.cells.regions import LATERAL_OF, STATION_OF
from rulec.partition.time_margin import Margins
from rulec.scenario import Obstacle
from rulec.trace.trace_model import State, TraceGraph, Value

Said = Value | Mapping[str, Value]
"""What a state says of a name."""

PAPER_SURFACE = {"carriageway": "R_cw", "crossing": "R_pc"}


def trace_graph(graph: CellGraph) -> TraceGraph:
    """The graph's cells as states.

    With the partition ``paper``: ``position`` (object -> b, f, l, r) and ``surface`` (R_cw, R_pc).
    With ``fine``: ``station``, ``lateral`` and ``surface``. The scenario's signals are added. An
    object that is not on the road in a layer is missing from its states.

    A change costs 1 / margin, in 1/s. To be added exactly it is counted in ``cost_unit``, of which
    every such cost is a whole multiple.
    """
    whole = lcm(*range(1, len(graph.layers) + 1))
    last = len(graph.layers) - 1
    return TraceGraph(
        step_s=graph.step_s,
        objects={name: obstacle.type for name, obstacle in graph.objects.items()},
        present={
            name: graph.present[name] for name in graph.objects if graph.present[name] != (0, last)
        },
        states=tuple(_states(graph, p) for p in range(len(graph.layers))),
        successors=graph.successors,
        weights=tuple(_weights(margins, whole) for margins in graph.margins),
        margins=graph.margins,
        cost_unit=Fraction(1) / (whole * graph.step),
        start=graph.start,
        goals=graph.goals,
    )


def _states(graph: CellGraph, layer: int) -> tuple[State, ...]:
    here = graph.layers[layer]
    signals = signals_of(graph, {name: graph.objects[name] for name in here.objects})
    return tuple({**relations(cell, here.objects, cell.code), **signals} for cell in here.cells)


def relations(cell: Cell, names: Sequence[str], code: bytes) -> dict[str, Said]:
    """Surface and relations of a cell, as bytes.

    One byte for the surface, then those of each object's code.
    """
    if cell.partition == "paper":
        return {
            "position": dict(zip(names, code.decode("ascii"), strict=False)),
            "surface": PAPER_SURFACE[cell.surface],
        }
    return {
        "station": dict(zip(names, map(STATION_OF.__getitem__, code), strict=False)),
        "lateral": dict(zip(names, map(LATERAL_OF.__getitem__, code), strict=False)),
        "surface": cell.surface,
    }


def signals_of(graph: CellGraph, objects: Mapping[str, Obstacle]) -> dict[str, Said]:
    """Signals of a scenario and of some objects, constant over time."""
    signals: dict[str, dict[str, Value]] = {}
    for name, obstacle in objects.items():
        for signal, value in obstacle.signals.items():
            signals.setdefault(signal, {})[name] = value
    return {**graph.scenario.signals, **signals}


def _weights(margins: Margins, whole: int) -> tuple[tuple[int, ...], ...]:
    return tuple(
        tuple(0 if margin is None else whole // margin for margin in row) for row in margins
    )
