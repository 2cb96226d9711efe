"""The navigation graph for networkx. Nothing else needs that library."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rulec.partition.cell_graph import CellGraph
from rulec.trace.trace_model import TraceGraph

if TYPE_CHECKING:
    import networkx


def to_networkx(graph: CellGraph, traces: TraceGraph) -> networkx.DiGraph:
    """The graph with nodes ``(layer, cell index)``.

    Nodes have ``cell``, ``state`` (the valuation), ``polygon`` (shapely, in metres of s and d),
    ``start`` and ``goal`` (bool); edges ``margin_s`` (seconds; None for staying), ``weight`` (int,
    in ``cost_unit``) and ``cost`` (1/s); the graph ``step_s`` and ``cost_unit`` (Fraction, 1/s).
    """
    import networkx  # it takes 0.1 s to load, and few need it

    result = networkx.DiGraph(step_s=graph.step_s, cost_unit=traces.cost_unit)
    last = len(graph.layers) - 1
    for p, layer in enumerate(graph.layers):
        for i, cell in enumerate(layer.cells):
            result.add_node(
                (p, i),
                cell=cell,
                state=traces.states[p][i],
                polygon=cell.polygon,
                start=p == 0 and i == graph.start,
                goal=p == last and i in graph.goals,
            )
    for p, rows in enumerate(graph.successors):
        for i, followers in enumerate(rows):
            for j, margin, weight in zip(
                followers, graph.margins[p][i], traces.weights[p][i], strict=True
            ):
                result.add_edge(
                    (p, i),
                    (p + 1, j),
                    margin_s=None if margin is None else float(margin * graph.step),
                    weight=weight,
                    cost=float(weight * traces.cost_unit),
                )
    return result
