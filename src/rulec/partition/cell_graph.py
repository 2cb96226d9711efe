"""Layered graph of cells, as data."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction

from rulec.partition.cells.adjacency import AdjacencyName
from rulec.partition.cells.cell_model import Layer
from rulec.partition.cells.predicted_occupancy import Predicted
from rulec.partition.cells.regions import ExtentName, PartitionName
from rulec.partition.time_margin import Edges, Margins
from rulec.scenario import Obstacle, Scenario


@dataclass(frozen=True)
class CellGraph:
    """Layered directed graph whose paths from start to goals are maneuvers.

    ``successors[p][i]`` are the cells of layer p + 1 that follow cell i of layer p, in ascending
    order; ``margins[p][i]`` their time margins in layers, None for staying. ``objects`` are those
    that are on the road at some time, ``alternatives`` as less likely predictions have them, and
    ``present`` the first and last layer of each.
    """

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

    @property
    def step_s(self) -> float:
        """The planning interval in seconds."""
        return float(self.step)

    @property
    def nodes(self) -> int:
        """Number of cells of all layers."""
        return sum(len(layer.cells) for layer in self.layers)

    @property
    def edges(self) -> int:
        """Number of edges, staying included."""
        return sum(len(followers) for layer in self.successors for followers in layer)
