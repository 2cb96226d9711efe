"""The navigation graph: the cells of every layer, and the edges between them.

Definitions: Esterle, Aravantinos, Knoll, IV 2019, "Free Space-Time Partitioning"; where that leaves
one open, ours is in ``docs/scenarios.md``.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from types import ModuleType
from typing import TYPE_CHECKING, NamedTuple, TypedDict, get_args

from rulec.diagnostics import SourceLocation, did_you_mean, named
from rulec.diagnostics.argument_kinds import checked_kinds
from rulec.partition.cell_graph import Edges, Margins, NavigationGraph
from rulec.partition.cells import cell_links
from rulec.partition.cells.cell_model import Layer, Plane
from rulec.partition.cells.cell_plane import plane
from rulec.partition.cells.occupancy import Occupancy, scene
from rulec.partition.cells.regions import ExtentName, PartitionName
from rulec.partition.cells.roadway import snapped
from rulec.partition.graph_edges import cells_after, edges
from rulec.partition.partition_messages import UNKNOWN_PARTITION
from rulec.partition.start_cell import start_cell, step_that_leaves_room
from rulec.resource_limits import PLACES
from rulec.scenario import MotionBounds, Scenario
from rulec.scenario.motion_bounds import read_bounds
from rulec.scenario.time_grid import Timing, timing, whole_steps

if TYPE_CHECKING:
    from typing_extensions import Unpack

FINEST_S = Fraction(1, 20)
"""The step of a recorded scene is halved down to this (s) where no path is left."""

GENTLE, COMFORTABLE = 2.0, 4.0
"""The step is also halved where no path is left within these accelerations and brakings (m/s²)."""

COMFORTABLE_S = Fraction(1, 8)
"""The shortest such step (s). The longest with a gentle path is used, else with a comfortable."""

MOST_BORDERS = 4
"""The most borders between the cells of `fine` that ego crosses in a step, within its bounds."""


class GraphOptions(TypedDict, total=False):
    """The options of ``navigation_graph``; None is the same as leaving one out."""

    partition: PartitionName | None
    adjacency: cell_links.AdjacencyName
    extent: ExtentName | None
    step_s: float | None
    horizon_s: float | None
    bounds: MotionBounds | str | None


@checked_kinds
def navigation_graph(
    scenario: Scenario,
    *,
    partition: PartitionName | None = None,
    adjacency: cell_links.AdjacencyName = "touch",
    extent: ExtentName | None = None,
    step_s: float | None = None,
    horizon_s: float | None = None,
    bounds: MotionBounds | str | None = None,
) -> NavigationGraph:
    """Partition a scenario's free space over time and link the cells.

    ``partition`` is ``paper`` (behind, in front, left, right; the default) or ``fine`` (station and
    lateral). ``adjacency`` defines when two cells are next to each other: ``touch``, ``edge`` or
    ``forward``. ``extent`` is the width of obstacles: ``lane`` (all lanes that they touch),
    ``clearance`` (without the part in which ego can pass beside them) or ``body``; the default is
    ``clearance`` in a recorded scene with bounds, else ``lane``. Step and horizon (s) are by
    default the scenario's. In a recorded scene the default step is the longest one up to the
    scenario's that leaves ego a place to start; it is halved, repeatedly, while no gentle path is
    left. Within ``bounds`` of ego's motion, by default the scenario's, only what ego can drive is
    kept; a text is parsed by ``read_bounds``, and ``none`` keeps everything.

    Raises RulecError R0606 if horizon and step do not fit together, R0607 if ego has no start cell,
    R0608 for an unknown partition, adjacency or extent, R0770 for invalid bounds, R0718 for too
    many obstacles and layers.
    """
    options: GraphOptions = {"partition": partition, "adjacency": adjacency, "extent": extent}
    options |= {"step_s": step_s, "horizon_s": horizon_s, "bounds": bounds}
    plan, times = _planned(scenario, options)
    if step_s is not None or scenario.account is None:
        return _cut(plan, times)
    free = step_that_leaves_room(plan.scenario, times, plan.partition, plan.extent)
    if free is not None:
        times = _in_steps_of(free.step, times)
    graphs: list[NavigationGraph] = []
    for most, finest in ((GENTLE, COMFORTABLE_S), (COMFORTABLE, COMFORTABLE_S), (None, FINEST_S)):
        for number, halved in enumerate(_halved(times, finest)):
            if number == len(graphs):
                graphs.append(_cut(plan, halved))
            graph = graphs[number]
            if graph.leads_to_a_goal and (most is None or _has_way_with(most, graph)):
                return graph
    return graphs[0] if graphs else _cut(plan, times)


def _halved(times: Timing, finest: Fraction) -> Iterator[Timing]:
    """The same horizon with this step, half of it, and so on down to ``finest``."""
    while times.step >= finest:
        yield times
        times = _in_steps_of(times.step / 2, times)


def has_way(scenario: Scenario, **options: Unpack[GraphOptions]) -> bool:
    """Whether the graph with these options has a path; the default step is the scenario's.

    Only cells on paths from the start are computed, and no margins. Raises RulecError as
    ``navigation_graph`` does.
    """
    plan, times = _planned(scenario, options)
    graph = _reached(plan, times)
    return graph is not None and (plan.bounds is None or has_way_within(graph, plan.bounds))


def has_way_within(graph: NavigationGraph, bounds: MotionBounds) -> bool:
    """Whether a path of a graph remains within bounds of motion that are no wider than its own."""
    return within(graph, bounds).leads_to_a_goal


def within(graph: NavigationGraph, bounds: MotionBounds) -> NavigationGraph:
    """The part of a graph that ego can drive within bounds of motion."""
    kept: NavigationGraph = _motion().reachable(graph, bounds)
    return kept


def _motion() -> ModuleType:
    """What bounds of motion need: NumPy, 0.1 s, which graphs without bounds do not."""
    from rulec.partition.motion import reachable_graph

    return reachable_graph


def _has_way_with(most: float, graph: NavigationGraph) -> bool:
    """Whether a path needs at most ``most`` m/s²; true if ego's motion has no bounds."""
    own = graph.bounds
    if own is None:
        return True
    limits = replace(
        own,
        acceleration=min(own.acceleration, most),
        braking=min(own.braking, most),
    )
    return has_way_within(graph, limits)


@dataclass(frozen=True, slots=True)
class _Plan:
    """The scenario and the options of a graph, except its layers."""

    scenario: Scenario
    partition: PartitionName
    adjacency: cell_links.AdjacencyName
    extent: ExtentName
    bounds: MotionBounds | None

    @property
    def borders(self) -> int:
        """How many borders of cells ego may cross in a step."""
        return MOST_BORDERS if self.partition == "fine" and self.bounds is not None else 1


def _planned(scenario: Scenario, options: GraphOptions) -> tuple[_Plan, Timing]:
    own, given = scenario.ego.bounds, options.get("bounds")
    bounds = read_bounds(given, own) if isinstance(given, str) else given or own
    partition, adjacency = options.get("partition") or "paper", options.get("adjacency", "touch")
    extent, step_s = options.get("extent"), options.get("step_s")
    if extent is None:
        extent = "clearance" if bounds is not None and scenario.account is not None else "lane"
    if bounds not in (None, own):
        scenario = replace(scenario, ego=replace(scenario.ego, bounds=bounds))
    for what, name, names_type in (
        ("partition", partition, PartitionName),
        ("adjacency", adjacency, cell_links.AdjacencyName),
        ("extent", extent, ExtentName),
    ):
        if name not in (known := get_args(names_type)):
            raise UNKNOWN_PARTITION.error(
                None,
                f"there is no {what} `{name}`",
                expected=f"expected one of {named(known)}",
                help=did_you_mean(str(name), known),
            )
    step_s = scenario.step_s if step_s is None else step_s
    horizon_s = options.get("horizon_s")
    if horizon_s is None:
        horizon_s = scenario.horizon_s
        if scenario.account is not None and scenario.account.map_ends:
            horizon_s = whole_steps(horizon_s, step_s)
    times = timing(horizon_s, step_s)
    return _Plan(scenario, partition, adjacency, extent, bounds), times


def _in_steps_of(step: Fraction, times: Timing) -> Timing:
    """The same horizon with another step."""
    return Timing(step, int((times.layers - 1) * times.step / step) + 1)


def _cut(plan: _Plan, times: Timing) -> NavigationGraph:
    places = _places(plan, times)
    first, *rest = _layers(plan, times, places)
    start = _start(plan, times, places, first.flat)
    layers = (first.layer, *(layer.layer for layer in rest))
    onward = [layer.links for layer in rest]
    if plan.bounds is None:
        steps = edges(layers, onward)
        return _graph(plan, times, places, start=start, layers=layers, steps=steps)
    ego, step_s = plan.scenario.ego, float(times.step)
    near = _motion().cells_within_reach(layers, ego, plan.bounds, step_s)
    steps = edges(layers, onward, plan.borders, near)
    graph = _graph(plan, times, places, start=start, layers=layers, steps=steps)
    return within(graph, plan.bounds)


def _reached(plan: _Plan, times: Timing) -> NavigationGraph | None:
    """The graph without bounds and margins, with only the edges on paths from the start.

    None if no path leads to a goal.
    """
    places = _places(plan, times)
    cut = _layers(plan, times, places)
    first = next(cut)
    start = _start(plan, times, places, first.flat)
    layers, successors, reached = [first.layer], [], {start}
    for _, layer, links in cut:
        rows = {cell: cells_after(cell, layers[-1], links, layer, plan.borders) for cell in reached}
        reached = {after for row in rows.values() for after in row}
        successors.append(tuple([tuple(sorted(rows.get(cell, ()))) for cell in range(len(links))]))
        layers.append(layer)
        if not reached:
            return None
    margins = [tuple([(None,) * len(row) for row in rows]) for rows in successors]
    steps = successors, margins
    graph = _graph(plan, times, places, start=start, layers=layers, steps=steps)
    return None if reached.isdisjoint(graph.goals) else graph


def _places(plan: _Plan, times: Timing) -> Occupancy:
    taken = len(plan.scenario.obstacles) * times.layers
    PLACES.within(taken, SourceLocation(plan.scenario.name))
    return scene(plan.scenario, times, plan.partition, plan.extent)


def _start(plan: _Plan, times: Timing, places: Occupancy, first: Plane) -> int:
    return start_cell(
        first, places, plan.scenario, times, partition=plan.partition, extent=plan.extent
    )


class _CutLayer(NamedTuple):
    """The road as cut in a layer, its cells, and the continuations that lead to them."""

    flat: Plane
    layer: Layer
    links: cell_links.Links


def _layers(plan: _Plan, times: Timing, places: Occupancy) -> Iterator[_CutLayer]:
    """The layers in order; the first has no continuations."""
    before: Plane | None = None
    for p, (regions, names, others) in enumerate(
        zip(places.swept, places.names, places.others, strict=True)
    ):
        flat = plane(places.roadway, regions, plan.partition, names)
        links: cell_links.Links = ()
        if before is not None:
            meanwhile = places.instants[p - 1]
            obstacles = [str(region.obstacle) for region in meanwhile]
            instant = plane(places.roadway, meanwhile, plan.partition, obstacles)
            links = cell_links.continuations(before, instant, flat)
        beside = cell_links.neighbours(flat, plan.adjacency)
        yield _CutLayer(flat, Layer(times.start(p), names, flat.cells, beside, others), links)
        before = flat


def _graph(
    plan: _Plan,
    times: Timing,
    places: Occupancy,
    *,
    start: int,
    layers: Sequence[Layer],
    steps: tuple[Sequence[Edges], Sequence[Margins]],
) -> NavigationGraph:
    """The graph with these edges and margins, without bounds of ego's motion."""
    predictions = places.predicted_of.items()
    goal = plan.scenario.goal
    goal = None if goal is None else snapped(goal, places.s, places.d)
    return NavigationGraph(
        scenario=plan.scenario,
        partition=plan.partition,
        adjacency=plan.adjacency,
        extent=plan.extent,
        step=times.step,
        objects={
            name: prediction.obstacle for name, prediction in predictions if not prediction.number
        },
        alternatives={name: prediction for name, prediction in predictions if prediction.number},
        present=places.present,
        layers=tuple(layers),
        successors=tuple(steps[0]),
        margins=tuple(steps[1]),
        start=start,
        goals=tuple(
            i for i, cell in enumerate(layers[-1].cells) if goal is None or cell.meets(goal)
        ),
    )
