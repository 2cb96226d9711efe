"""Picture of the navigation graph: cells in layer columns, steps between."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

from rulec.partition import NavigationGraph
from rulec.planning.product.accepted_edges import AcceptedEdges
from rulec.planning.ranking.cheapest import Maneuver
from rulec.report.pictures.cell_signatures import MOST_SPELLED, in_full, in_letters, meaning
from rulec.report.pictures.drawing.marks import (
    LINE_HEIGHT,
    MARGIN,
    WIDTH,
    Area,
    LabelText,
    Mark,
    Picture,
    Point,
    Polyline,
    rectangle,
    stacked,
)
from rulec.report.pictures.drawing.text_metrics import text_width
from rulec.report.pictures.legend import LegendEntry, legend

_ROW = 34.0
_TALLEST = 720.0
_ORDER = ("unused", "rejected", "satisfying", "way")


@dataclass(frozen=True, slots=True)
class _Columns:
    """Positions of nodes: a layer's above each other, left lane on top."""

    sizes: tuple[int, ...]
    labels: tuple[tuple[str, ...], ...]
    top: float

    @property
    def row(self) -> float:
        """From one node of a column to the next, in px."""
        return min(_ROW, _TALLEST / max(self.sizes))

    @property
    def bottom(self) -> float:
        return self.top + self.row * max(self.sizes)

    @property
    def column(self) -> float:
        """From one column to the next, in px."""
        return (WIDTH - 2 * MARGIN) / len(self.sizes)

    @property
    def legible(self) -> bool:
        """Sufficient room for labels."""
        return self.row >= LINE_HEIGHT and self.half_width * 2 <= self.column * 0.75

    @property
    def half_width(self) -> float:
        return text_width([label for layer in self.labels for label in layer]) / 2 + 5

    def at(self, layer: int, node: int) -> Point:
        count = self.sizes[layer]
        middle = (self.top + self.bottom) / 2
        return (
            MARGIN + self.column * (layer + 0.5),
            middle + self.row * ((count - 1) / 2 - node),
        )

    def extent(self) -> tuple[float, float]:
        """Half the width and half the height of a node."""
        if self.legible:
            return self.half_width, LINE_HEIGHT / 2 + 1
        return min(5.0, self.column / 8), min(5.0, self.row * 0.35)


def graph_picture(
    graph: NavigationGraph,
    accepted_edges: AcceptedEdges,
    maneuver: Maneuver | None,
    *,
    judged: bool,
) -> Picture:
    """The picture; ``judged``: do rules tell satisfying maneuvers from others?"""
    columns = _columns(graph)
    marks: list[Mark] = [*_edges(graph, columns, accepted_edges, maneuver)]
    marks += _nodes(graph, columns, accepted_edges, maneuver)
    marks += _times(graph, columns)
    below = legend(
        list(_entries(graph, accepted_edges, maneuver, judged=judged)),
        list(_remarks(graph, columns)),
        WIDTH,
        MARGIN,
    )
    title = f"{graph.scenario.name}, the navigation graph"
    return stacked(title, [Picture(title, WIDTH, columns.bottom, tuple(marks)), below])


def _columns(graph: NavigationGraph) -> _Columns:
    sizes = tuple(len(layer.cells) for layer in graph.layers)
    top = 2 * LINE_HEIGHT
    letters, numbers = (
        _Columns(
            sizes,
            tuple(
                tuple(
                    f"{i} {in_letters(cell)}".strip() if long else str(i)
                    for i, cell in enumerate(layer.cells)
                )
                for layer in graph.layers
            ),
            top,
        )
        for long in (True, False)
    )
    return letters if letters.legible else numbers


def _edges(
    graph: NavigationGraph,
    columns: _Columns,
    accepted_edges: AcceptedEdges,
    maneuver: Maneuver | None,
) -> list[Polyline]:
    """Every step once, those that matter more above the others."""
    half = columns.extent()[0]
    way = set(enumerate(pairwise(maneuver.nodes))) if maneuver else set()
    lines = []
    for p, successors in enumerate(graph.successors):
        for node, followers in enumerate(successors):
            for target in followers:
                (x0, y0), (x1, y1) = columns.at(p, node), columns.at(p + 1, target)
                here = (p, (node, target)) in way
                style = "way" if here else _fate(accepted_edges, p, node, target)
                lines.append(Polyline(((x0 + half, y0), (x1 - half, y1)), style))
    return sorted(lines, key=lambda line: _ORDER.index(line.style))


def _fate(accepted_edges: AcceptedEdges, layer: int, node: int, target: int) -> str:
    if (node, target) in accepted_edges.accepted[layer]:
        return "satisfying"
    return "rejected" if (node, target) in accepted_edges.possible[layer] else "unused"


def _nodes(
    graph: NavigationGraph,
    columns: _Columns,
    accepted_edges: AcceptedEdges,
    maneuver: Maneuver | None,
) -> Iterator[Mark]:
    wide, high = columns.extent()
    for p, layer in enumerate(graph.layers):
        for node, cell in enumerate(layer.cells):
            x, y = columns.at(p, node)
            style = (
                "chosen"
                if maneuver and maneuver.nodes[p] == node
                else "node"
                if node in accepted_edges.accepted_nodes[p]
                else "violated"
                if node in accepted_edges.possible_nodes[p]
                else "off"
            )
            shape = rectangle(x - wide, y - high, x + wide, y + high)
            yield Area((shape,), style, f"{layer.start_s:g} s, cell {node}: {in_full(cell)}")
            if columns.legible:
                ink = "faint" if style == "off" else "ink"
                yield LabelText(columns.labels[p][node], (x, y), "middle", ink)


def _times(graph: NavigationGraph, columns: _Columns) -> Iterator[LabelText]:
    wanted = text_width([f"{graph.layers[-1].start_s:g} s  "])
    every = max(1, -int(-wanted // columns.column))
    for p, layer in enumerate(graph.layers):
        if p % every == 0:
            x, _ = columns.at(p, 0)
            at = (x, columns.top - LINE_HEIGHT + 2)
            yield LabelText(f"{layer.start_s:g} s", at, "middle", "faint")


def _entries(
    graph: NavigationGraph,
    accepted_edges: AcceptedEdges,
    maneuver: Maneuver | None,
    *,
    judged: bool,
) -> Iterator[LegendEntry]:
    accepted, possible = (
        sum(map(len, edges)) for edges in (accepted_edges.accepted, accepted_edges.possible)
    )
    if maneuver:
        yield LegendEntry("way", "the maneuver shown")
    if judged:
        yield LegendEntry("satisfying", f"{accepted:,} steps of satisfying maneuvers")
        yield LegendEntry("rejected", f"{possible - accepted:,} steps of rejected ones alone")
        if any(
            there - kept
            for there, kept in zip(
                accepted_edges.possible_nodes, accepted_edges.accepted_nodes, strict=True
            )
        ):
            yield LegendEntry("violated", "a cell of rejected ones alone")
    else:
        yield LegendEntry("satisfying", f"{possible:,} steps of maneuvers")
    if graph.edges > possible:
        yield LegendEntry("unused", f"{graph.edges - possible:,} steps of no maneuver")


def _remarks(graph: NavigationGraph, columns: _Columns) -> Iterator[str]:
    if not columns.legible:
        yield "one mark a cell, numbered from below"
    elif 0 < len(graph.objects) <= MOST_SPELLED and " " in columns.labels[0][0]:
        yield f"a cell's number and signature: {meaning(graph)}"
    else:
        yield "the numbers of cells as in JSON"
