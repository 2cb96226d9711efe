"""Cells around obstacles and the navigation graph that links them.

scenario -> occupancy -> regions -> cells -> adjacency, continuation -> edges and margins
"""

from rulec.partition.cell_graph import NavigationGraph
from rulec.partition.cells.cell_links import AdjacencyName
from rulec.partition.cells.cell_model import Cell, Layer
from rulec.partition.cells.regions import ExtentName, PartitionName
from rulec.partition.envelope import Envelope, envelope
from rulec.partition.navigation_graph import COMFORTABLE, GraphOptions, navigation_graph

__all__ = [
    "COMFORTABLE",
    "AdjacencyName",
    "Cell",
    "Envelope",
    "ExtentName",
    "GraphOptions",
    "Layer",
    "NavigationGraph",
    "PartitionName",
    "envelope",
    "navigation_graph",
]
