"""Cells around obstacles and the navigation graph that links them.

scenario -> occupancy -> regions -> cells -> adjacency, continuation -> edges and margins
"""

from rulec.partition.cell_graph import NavigationGraph as NavigationGraph
from rulec.partition.cells.cell_links import AdjacencyName as AdjacencyName
from rulec.partition.cells.cell_model import Cell as Cell
from rulec.partition.cells.cell_model import Layer as Layer
from rulec.partition.cells.regions import ExtentName as ExtentName
from rulec.partition.cells.regions import PartitionName as PartitionName
from rulec.partition.envelope import Envelope as Envelope
from rulec.partition.envelope import envelope as envelope
from rulec.partition.navigation_graph import COMFORTABLE as COMFORTABLE
from rulec.partition.navigation_graph import GraphOptions as GraphOptions
from rulec.partition.navigation_graph import navigation_graph as navigation_graph
