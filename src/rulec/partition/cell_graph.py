"""The navigation graph as data, and as a trace graph."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import lcm
from typing import TYPE_CHECKING

from rulec.partition.cells.cell_links import AdjacencyName
from rulec.partition.cells.cell_model import Cell, Layer, Reach, passes_only
from rulec.partition.cells.occupancy import Predicted
from rulec.partition.cells.regions import LATERAL_OF, STATION_OF, ExtentName, PartitionName
from rulec.scenario import MotionBounds, Obstacle, Scenario
from rulec.scenario.paper_words import PAPER_SURFACE
from rulec.trace import State, TraceGraph
from rulec.value_display import short_repr
from rulec.vocabulary.partial_values import PartialValue

if TYPE_CHECKING:
    import networkx

_FINER = 1000
"""The cost unit is divided by this where driving costs are added."""

Edges = tuple[tuple[int, ...], ...]
Margins = tuple[tuple[int | None, ...], ...]


@dataclass(frozen=True)
class NavigationGraph:
    """Layered directed graph whose paths from start to goals are maneuvers.

    ``successors[p][i]`` are the cells of layer p + 1 that follow cell i of layer p, in ascending
    order; ``margins[p][i]`` their time margins in layers, None for staying. ``objects`` are those
    on the road at some time, ``alternatives`` those by less likely predictions, and ``present`` the
    first and last layer of each. With ``bounds`` of ego's motion, the graph has only cells and
    edges that can be driven, ``reach[p][i]`` bounds ego's place and speed in cell i, and
    ``driving[p][i]`` is the least that the cell adds to a path's cost.
    """

    __repr__ = short_repr

    scenario: Scenario
    partition: PartitionName
    adjacency: AdjacencyName
    extent: ExtentName
    step: Fraction
    objects: Mapping[str, Obstacle]
    alternatives: Mapping[str, Predicted]
    present: Mapping[str, tuple[int, int]]
    layers: tuple[Layer, ...]
    successors: tuple[Edges, ...]
    margins: tuple[Margins, ...]
    start: int
    goals: tuple[int, ...]
    bounds: MotionBounds | None = None
    reach: tuple[tuple[Reach | None, ...], ...] = ()
    driving: tuple[tuple[float, ...], ...] = ()

    @property
    def last_layer(self) -> int:
        """The last layer that a path from the start reaches."""
        return len(self.reached) - 1

    @property
    def leads_to_a_goal(self) -> bool:
        """Whether there is a path from the start to a goal."""
        reached = self.reached
        return len(reached) == len(self.layers) and not reached[-1].isdisjoint(self.goals)

    @property
    def reached(self) -> list[set[int]]:
        """The cells that paths from the start lead to, layer by layer up to the last reached."""
        reached = [{self.start}]
        for edges in self.successors:
            onward = {after for cell in reached[-1] for after in edges[cell]}
            if not onward:
                break
            reached.append(onward)
        return reached

    @property
    def step_s(self) -> float:
        """The planning interval in seconds."""
        return float(self.step)

    @property
    def nodes(self) -> int:
        """The number of cells in all layers."""
        return sum(len(layer.cells) for layer in self.layers)

    @property
    def edges(self) -> int:
        """The number of edges, including those for staying."""
        return sum(len(followers) for layer in self.successors for followers in layer)

    def at_times(self, names: Mapping[str, str]) -> dict[str, tuple[int, int]]:
        """The first and last layer of objects that are not always present, by their new names."""
        always = (0, len(self.layers) - 1)
        spans = {new: self.present[name] for name, new in names.items()}
        return {new: span for new, span in spans.items() if span != always}

    def trace_graph(self) -> TraceGraph:
        """The cells as states and costs as whole numbers, without geometry.

        With the partition ``paper``: ``position`` (object -> b, f, l, r) and ``surface`` (R_cw,
        R_pc). With ``fine``: ``station``, ``lateral`` and ``surface``. The scenario's signals are
        added. An object that is not on the road in a layer is missing from its states.

        A change costs 1 / margin, in 1/s. For exact sums it is counted in ``cost_unit``, of which
        every such cost is a whole multiple. With bounds of ego's motion each cell adds its least
        driving cost, rounded down.
        """
        whole = lcm(*range(1, len(self.layers) + 1))
        # With bounds, driving costs need a finer unit.
        whole = whole if self.bounds is None else whole * _FINER
        unit = Fraction(1) / (whole * self.step)
        return TraceGraph(
            step_s=self.step_s,
            objects={name: obstacle.type for name, obstacle in self.objects.items()},
            present=self.at_times({name: name for name in self.objects}),
            states=tuple(map(self._states, self.layers)),
            successors=self.successors,
            weights=self._weights(whole, unit),
            margins=self.margins,
            cost_unit=unit,
            start=self.start,
            goals=self.goals,
        )

    def _weights(self, whole: int, unit: Fraction) -> tuple[tuple[tuple[int, ...], ...], ...]:
        """The edges' costs: changes of cell by their margins, plus the cells' driving costs."""
        rows = tuple(_weights(margins, whole) for margins in self.margins)
        if self.bounds is None:
            return rows
        least = [[int(Fraction(cost) / unit) for cost in row] for row in self.driving]
        return tuple(
            tuple(
                tuple(
                    least[p + 1][j] + (0 if weight and self.costs_nothing(p, i, j) else weight)
                    for weight, j in zip(row, onward, strict=True)
                )
                for i, (row, onward) in enumerate(zip(weights, followers, strict=True))
            )
            for p, (weights, followers) in enumerate(zip(rows, self.successors, strict=True))
        )

    def costs_nothing(self, p: int, i: int, j: int) -> bool:
        """Whether moving from cell i of layer p to cell j of the next layer costs nothing.

        True if only the surface differs, or only ego's station relative to objects that stay in
        other lanes on the same side.
        """
        return passes_only(self.layers[p].cells[i], self.layers[p + 1].cells[j])

    def _states(self, layer: Layer) -> tuple[State, ...]:
        signals = self.signals_of({name: self.objects[name] for name in layer.objects})
        return tuple(
            {**valuation(cell, layer.objects, cell.code), **signals} for cell in layer.cells
        )

    def signals_of(self, objects: Mapping[str, Obstacle]) -> State:
        """Signals of the scenario and of the given objects, constant over time."""
        signals: dict[str, dict[str, PartialValue]] = {}
        for name, obstacle in objects.items():
            for signal, value in obstacle.signals.items():
                signals.setdefault(signal, {})[name] = value
        return {**self.scenario.signals, **signals}

    def to_networkx(self) -> networkx.DiGraph:
        """The graph for networkx, with nodes ``(layer, cell index)``.

        Node attributes: ``cell``, ``state`` (the valuation), ``polygon`` (shapely, in metres of s
        and d), ``start`` and ``goal`` (bool); edge attributes: ``margin_s`` (seconds; None for
        staying), ``weight`` (int, in ``cost_unit``) and ``cost`` (1/s); graph attributes:
        ``step_s`` and ``cost_unit`` (Fraction, 1/s).
        """
        import networkx  # imported late: 0.1 s, rarely needed

        traces = self.trace_graph()
        graph = networkx.DiGraph(step_s=self.step_s, cost_unit=traces.cost_unit)
        last = len(self.layers) - 1
        for p, layer in enumerate(self.layers):
            for i, cell in enumerate(layer.cells):
                graph.add_node(
                    (p, i),
                    cell=cell,
                    state=traces.states[p][i],
                    polygon=cell.polygon,
                    start=p == 0 and i == self.start,
                    goal=p == last and i in self.goals,
                )
        for p, rows in enumerate(zip(self.successors, self.margins, traces.weights, strict=True)):
            for i, (followers, margins, weights) in enumerate(zip(*rows, strict=True)):
                for j, margin, weight in zip(followers, margins, weights, strict=True):
                    graph.add_edge(
                        (p, i),
                        (p + 1, j),
                        margin_s=None if margin is None else float(margin * self.step),
                        weight=weight,
                        cost=float(weight * traces.cost_unit),
                    )
        return graph


def valuation(cell: Cell, names: Sequence[str], code: bytes) -> State:
    """Surface and relations of a cell; ``code`` has one byte for each name."""
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


def _weights(margins: Margins, whole: int) -> tuple[tuple[int, ...], ...]:
    return tuple(
        tuple(0 if margin is None else whole // margin for margin in row) for row in margins
    )
