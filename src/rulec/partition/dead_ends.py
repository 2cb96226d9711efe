"""Dead ends of a scenario: the last layer reached, the obstacles that close it, and remedies."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from rulec.diagnostics import RulecError
from rulec.partition.cell_graph import NavigationGraph
from rulec.partition.navigation_graph import GraphOptions, has_way
from rulec.scenario import Box, Scenario
from rulec.scenario.motion import swept
from rulec.scenario.time_grid import MAX_LAYERS

TIMES_LONGER = 2, 4
"""The horizon is multiplied by these, in turn, to find one that leads to the goal."""

TIMES_FINER = 2, 4
"""The step is divided by these, in turn, to find one that opens a way."""

_MOST_TRIED = 12
"""With more obstacles in the way it is not tried which of them close it."""


@dataclass(frozen=True, slots=True)
class DeadEnd:
    """The last layer that a path from the start reaches, and why none goes on.

    ``closed_by`` are obstacles that in the next layer sweep lanes within the cells reached, or
    within ego's reach from there, and without which a path goes on; empty if paths reach the last
    layer but no goal, or if something else ends them, such as the road's end. ``opened_by`` are
    options of a graph, as typed on the command line, each of which alone opens a way.
    """

    layer: int
    closed_by: tuple[str, ...]
    opened_by: tuple[str, ...]


def dead_end(graph: NavigationGraph) -> DeadEnd | None:
    """Where the paths of a graph end; None if one leads to a goal."""
    if graph.leads_to_a_goal:
        return None
    layer = graph.last_layer
    is_last = layer == len(graph.layers) - 1
    closed = () if is_last else _closing(graph, layer, tuple(_in_the_way(graph, layer)))
    return DeadEnd(layer, closed, tuple(_openings(graph, short_of_goal=is_last)))


def _closing(graph: NavigationGraph, layer: int, in_the_way: Sequence[str]) -> tuple[str, ...]:
    """Those of some obstacles that close the way; none if it ends without them, too."""
    if not in_the_way or not _goes_on(graph, layer, in_the_way):
        return ()
    if not 1 < len(in_the_way) <= _MOST_TRIED:
        return tuple(in_the_way)
    # Those that have to be gone, if some may stay, and those that are enough to close the way.
    gone, enough = list(in_the_way), list(in_the_way)
    for name in in_the_way:
        if _goes_on(graph, layer, fewer := [other for other in gone if other != name]):
            gone = fewer
        fewer = [other for other in enough if other != name]
        if not _goes_on(graph, layer, [other for other in in_the_way if other not in fewer]):
            enough = fewer
    return tuple([name for name in in_the_way if name in gone or name in enough])


def _goes_on(graph: NavigationGraph, layer: int, without: Collection[str]) -> bool:
    """Whether some path goes on from a layer to the next, without some obstacles."""
    obstacles = tuple([one for one in graph.scenario.obstacles if one.id not in without])
    scenario = replace(graph.scenario, obstacles=obstacles, goal=None)
    horizon = float(graph.step * (layer + 1))
    return _opens(graph, {"horizon_s": horizon}, scenario)


def _in_the_way(graph: NavigationGraph, layer: int) -> Iterator[str]:
    """Obstacles that in the next layer sweep lanes within the cells reached, or ahead of ego."""
    lanes = graph.scenario.road.lanes
    boxes = [box for i in graph.reached[layer] for box in _onward(graph, layer, i)]
    start, end = (float(graph.step * (layer + more)) for more in (1, 2))
    for obstacle in graph.scenario.obstacles:
        body = swept(obstacle, start, end)
        if body is None:
            continue
        taken = [
            Box(body.s_min, body.s_max, right, left)
            for right, left in pairwise(lanes)
            if body.d_min < left and right < body.d_max
        ]
        if any(part.overlaps(box) for part in taken for box in boxes):
            yield obstacle.id


def _onward(graph: NavigationGraph, layer: int, cell: int) -> Iterable[Box]:
    """Where ego may be within a step from a cell; the whole cell if its motion has no bounds."""
    bounds, own = graph.bounds, graph.reach[layer][cell] if graph.reach else None
    if bounds is None or own is None:
        return graph.layers[layer].cells[cell].boxes
    step, sideways = graph.step_s, max(map(abs, own.lateral_speed))
    ahead = own.speed[1] * step + bounds.acceleration * step**2 / 2
    aside = sideways * step + bounds.lateral_acceleration * step**2 / 2
    return [Box(own.s[0], own.s[1] + ahead, own.d[0] - aside, own.d[1] + aside)]


def _openings(graph: NavigationGraph, *, short_of_goal: bool) -> Iterator[str]:
    """Options each of which alone opens a way, the smallest change first.

    ``short_of_goal``: there are ways, but none to the goal. Then bounds are not lifted: without
    them any cell that overlaps the goal is one.
    """
    steps = len(graph.layers) - 1
    for horizon in (float(graph.step * steps * n) for n in TIMES_LONGER if short_of_goal):
        if _opens(graph, {"horizon_s": horizon}):
            yield f"--horizon {horizon:g}"
            break
    for step in (float(graph.step / n) for n in TIMES_FINER if steps * n < MAX_LAYERS):
        if _opens(graph, {"step_s": step}):
            yield f"--step {step:g}"
            break
    if graph.extent != "body" and _opens(graph, {"extent": "body"}):
        yield "--extent body"
    if graph.adjacency != "touch" and _opens(graph, {"adjacency": "touch"}):
        yield "--adjacency touch"
    if graph.bounds is not None and not short_of_goal and _opens(graph, {"bounds": "none"}):
        yield "--bounds none"


def _opens(graph: NavigationGraph, change: GraphOptions, scenario: Scenario | None = None) -> bool:
    options: GraphOptions = {
        "partition": graph.partition,
        "adjacency": graph.adjacency,
        "extent": graph.extent,
        "step_s": graph.step_s,
        "horizon_s": float(graph.step * (len(graph.layers) - 1)),
        "bounds": "none" if graph.bounds is None else graph.bounds,
        **change,
    }
    try:
        return has_way(scenario or graph.scenario, **options)
    except RulecError:
        return False
