"""Picture of the navigation graph: cells in layer columns, steps between."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.partition import NavigationGraph
from rulec.planning.product.graph_product import AcceptedEdges
from rulec.planning.ranking.cheapest import Maneuver
from rulec.report.pictures import picture_captions as captions
from rulec.report.pictures.drawing import canvas
from rulec.report.pictures.drawing.canvas import LabelText, Mark, Picture, Point, Polyline

_ROW = 34.0
_TALLEST = 720.0
_TOP = 2 * canvas.LINE_HEIGHT
_ORDER = ("unused", "rejected", "satisfying", "way")


class _Columns:
    """Positions of nodes, given their labels: a layer's nodes in a column, the left lane on top."""

    def __init__(self, labels: Sequence[Sequence[str]]) -> None:
        self.labels = labels
        tallest = max(map(len, labels))
        self.row = min(_ROW, _TALLEST / tallest)
        self.column = canvas.TEXT_WIDTH / len(labels)
        self.bottom = _TOP + self.row * tallest
        half = canvas.text_width(label for layer in labels for label in layer) / 2 + 5
        self.legible = self.row >= canvas.LINE_HEIGHT and half * 2 <= self.column * 0.75
        # Half the width and half the height of a node.
        self.extent = (
            (half, canvas.LINE_HEIGHT / 2 + 1)
            if self.legible
            else (min(5.0, self.column / 8), min(5.0, self.row * 0.35))
        )

    def at(self, layer: int, node: int) -> Point:
        middle = (_TOP + self.bottom) / 2
        above = (len(self.labels[layer]) - 1) / 2 - node
        return canvas.MARGIN + self.column * (layer + 0.5), middle + self.row * above


def graph_picture(
    graph: NavigationGraph, edges: AcceptedEdges, maneuver: Maneuver | None, *, judged: bool
) -> Picture:
    """The picture; ``judged``: whether rules separate satisfying maneuvers from others."""
    cells = [list(enumerate(layer.cells)) for layer in graph.layers]
    columns = _Columns(
        [[f"{i} {captions.in_letters(cell)}".strip() for i, cell in row] for row in cells]
    )
    if not columns.legible:
        columns = _Columns([[str(i) for i, _ in row] for row in cells])
    marks: tuple[Mark, ...] = (
        *_edges(graph, columns, edges, maneuver),
        *_nodes(graph, columns, edges, maneuver),
        *_times(graph, columns),
    )
    below = captions.legend(
        list(_entries(graph, edges, maneuver, judged=judged)),
        [_note(graph, columns), *captions.mirrored(graph)],
    )
    title = f"{graph.scenario.name}, the navigation graph"
    return canvas.stacked(title, [Picture(title, canvas.WIDTH, columns.bottom, marks), below])


def _edges(
    graph: NavigationGraph, columns: _Columns, edges: AcceptedEdges, maneuver: Maneuver | None
) -> list[Polyline]:
    half, _ = columns.extent
    lines = []
    for p, successors in enumerate(graph.successors):
        way = {maneuver.nodes[p : p + 2]} if maneuver else set()
        kinds = {"way": way, "satisfying": edges.accepted[p], "rejected": edges.possible[p]}
        for node, followers in enumerate(successors):
            for target in followers:
                (x0, y0), (x1, y1) = columns.at(p, node), columns.at(p + 1, target)
                step = (node, target)
                style = next((kind for kind, steps in kinds.items() if step in steps), "unused")
                lines.append(Polyline(((x0 + half, y0), (x1 - half, y1)), style))
    return sorted(lines, key=lambda line: _ORDER.index(line.style))


def _nodes(
    graph: NavigationGraph, columns: _Columns, edges: AcceptedEdges, maneuver: Maneuver | None
) -> Iterator[Mark]:
    for p, layer in enumerate(graph.layers):
        way = {maneuver.nodes[p]} if maneuver else set()
        kept, there = edges.accepted_nodes[p], edges.possible_nodes[p]
        kinds = {"chosen": way, "node": kept, "violated": there}
        for node, cell in enumerate(layer.cells):
            middle = columns.at(p, node)
            style = next((kind for kind, nodes in kinds.items() if node in nodes), "off")
            tip = f"{layer.start_s:g} s, cell {node}: {captions.in_full(cell)}"
            yield canvas.filled(canvas.centred(middle, *columns.extent), style, tip)
            if columns.legible:
                ink = "faint" if style == "off" else "ink"
                yield LabelText(columns.labels[p][node], middle, "middle", ink)


def _times(graph: NavigationGraph, columns: _Columns) -> Iterator[LabelText]:
    needed = canvas.text_width([f"{graph.layers[-1].start_s:g} s  "])
    every = max(1, -int(-needed // columns.column))
    for p, layer in list(enumerate(graph.layers))[::every]:
        at = (columns.at(p, 0)[0], _TOP - canvas.LINE_HEIGHT + 2)
        yield LabelText(f"{layer.start_s:g} s", at, "middle", "faint")


def _entries(
    graph: NavigationGraph, edges: AcceptedEdges, maneuver: Maneuver | None, *, judged: bool
) -> Iterator[tuple[str, str]]:
    accepted, possible = (sum(map(len, steps)) for steps in (edges.accepted, edges.possible))
    if maneuver:
        yield "way", "the maneuver shown"
    if judged:
        yield "satisfying", f"{accepted:,} steps of satisfying maneuvers"
        yield "rejected", f"{possible - accepted:,} steps of rejected ones alone"
        nodes = zip(edges.possible_nodes, edges.accepted_nodes, strict=True)
        if any(there - kept for there, kept in nodes):
            yield "violated", "a cell of rejected ones alone"
    else:
        yield "satisfying", f"{possible:,} steps of maneuvers"
    if graph.edges > possible:
        yield "unused", f"{graph.edges - possible:,} steps of no maneuver"


def _note(graph: NavigationGraph, columns: _Columns) -> str:
    if not columns.legible:
        return "one mark a cell, numbered from below"
    if 0 < len(graph.objects) <= captions.MOST_SPELLED and " " in columns.labels[0][0]:
        return f"a cell's number and signature: {captions.meaning(graph)}"
    return "the numbers of cells as in JSON"
