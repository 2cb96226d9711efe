"""Cells around obstacles, layer by layer, and the navigation graph that links them.

scenario -> occupancy -> regions -> cells -> adjacency, continuation -> edges and margins
"""

from rulec.partition.adjacency import AdjacencyName
from rulec.partition.envelope import Envelope, envelope
from rulec.partition.graph import GraphOptions, NavigationGraph, navigation_graph
from rulec.partition.model import Cell, Layer
from rulec.partition.regions import ExtentName, PartitionName

__all__ = [
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
