"""Messages about navigation graphs and their paths."""

from __future__ import annotations

from rulec.diagnostics.code import Code

_ROAD = "[road]\ns = [0.0, 100.0]\nlanes = [-1.75, 1.75]\n\n"
_GOOD = f"{_ROAD}[ego]\ns = 10.0\nd = 0.0\n"
_CAR = '[[obstacle]]\nid = "car"\ntype = "vehicle"\nlength = 5.0\nwidth = 1.8\n'
NO_START_CELL = Code(
    "R0607",
    title="ego has no free cell to start from",
    why="An obstacle occupies ego's place within the first step, so no maneuver can begin there "
    "without a collision. Move one of them, or use a shorter step.",
    bad=f"{_GOOD}\n{_CAR}s = 0.0\nd = 0.0\nspeed = 20.0\n",
    good=f"{_GOOD}\n{_CAR}s = 20.0\nd = 0.0\nspeed = 20.0\n",
    kind="scenario",
)

UNKNOWN_PARTITION = Code(
    "R0608",
    title="a partition, an adjacency or an extent is unknown",
    why="The partitions are `paper` and `fine`, the adjacencies `touch`, `edge` and `forward`, the "
    "extents `lane`, `clearance` and `body`.",
    bad='import rulec\n\nrulec.navigation_graph("s1", partition="papre")\n',
    good='import rulec\n\nrulec.navigation_graph("s1", partition="paper")\n',
    kind="python",
)

NOT_A_PATH = Code(
    "R0609",
    title="a path does not follow the navigation graph",
    why="A path has one cell for each layer, starting with the first one, and an edge from each "
    "cell to the next. Paths come from `Maneuvers.cheapest`, or from following `successors`.",
    bad="import rulec\n\n"
    'graph = rulec.navigation_graph("s1")\nrulec.envelope(graph, [graph.start, 999])\n',
    good="import rulec\n\n"
    'graph = rulec.navigation_graph("s1")\n'
    "rulec.envelope(graph, [graph.start, graph.successors[0][graph.start][0]])\n",
    kind="python",
)
