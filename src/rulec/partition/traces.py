"""The navigation graph as valuations: what every cell says about the objects and the road."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from math import lcm

from rulec.partition.graph import NavigationGraph
from rulec.partition.margin import Margins
from rulec.partition.model import Cell
from rulec.partition.regions import LATERAL_OF, STATION_OF
from rulec.scenario import Obstacle
from rulec.trace.model import State, TraceGraph, Value

PAPER_SURFACE = {"carriageway": "R_cw", "crossing": "R_pc"}


def trace_graph(graph: NavigationGraph) -> TraceGraph:
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
        present={name: there for name, there in graph.present.items() if there != (0, last)},
        states=tuple(_states(graph, p) for p in range(len(graph.layers))),
        successors=graph.successors,
        weights=tuple(_weights(margins, whole) for margins in graph.margins),
        margins=graph.margins,
        cost_unit=Fraction(1) / (whole * graph.step),
        start=graph.start,
        goals=graph.goals,
    )


def _states(graph: NavigationGraph, layer: int) -> tuple[State, ...]:
    here = graph.layers[layer]
    signals: dict[str, Value | dict[str, Value]] = dict(graph.scenario.signals)
    signals.update(_object_signals((name, graph.objects[name]) for name in here.objects))
    return tuple({**_relations(cell), **signals} for cell in here.cells)


def _relations(cell: Cell) -> dict[str, Value | dict[str, Value]]:
    if cell.partition == "paper":
        letters = cell.code.decode("ascii")
        return {
            "position": dict(zip(cell.objects, letters, strict=True)),
            "surface": PAPER_SURFACE[cell.surface],
        }
    return {
        "station": dict(zip(cell.objects, map(STATION_OF.__getitem__, cell.code), strict=True)),
        "lateral": dict(zip(cell.objects, map(LATERAL_OF.__getitem__, cell.code), strict=True)),
        "surface": cell.surface,
    }


def _object_signals(objects: Iterable[tuple[str, Obstacle]]) -> dict[str, dict[str, Value]]:
    signals: dict[str, dict[str, Value]] = {}
    for name, obstacle in objects:
        for signal, value in obstacle.signals.items():
            signals.setdefault(signal, {})[name] = value
    return signals


def _weights(margins: Margins, whole: int) -> tuple[tuple[int, ...], ...]:
    return tuple(
        tuple(0 if margin is None else whole // margin for margin in row) for row in margins
    )
