"""The navigation graph: cells of every layer, and the steps between them.

Definitions: Esterle, Aravantinos, Knoll, IV 2019, "Free Space-Time Partitioning"; where that leaves
one open, ours is in ``docs/scenarios.md``.

An edge from A at layer p to B at p + 1: A continues as some A', B continues some B°, A and B° are
adjacent or the same at p, A' and B at p + 1. If B continues A it is staying. Else it is a change,
and it stays open as long as the two remain adjacent: the longest run of layers back from (A, B°)
and on from (A', B), following continuations. The 2019 paper names the quantity; this reading of it
is ours.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise, product
from typing import TypedDict, get_args

from rulec.diagnostics import SourceLocation, did_you_mean, named
from rulec.partition.cell_graph import Edges, Margins, NavigationGraph
from rulec.partition.cells import cell_links
from rulec.partition.cells.cell_model import Layer
from rulec.partition.cells.cell_plane import plane
from rulec.partition.cells.occupancy import scene
from rulec.partition.cells.regions import ExtentName, PartitionName
from rulec.partition.cells.roadway import snapped
from rulec.partition.partition_messages import UNKNOWN_PARTITION
from rulec.partition.start_cell import start_cell, step_that_leaves_room
from rulec.resource_limits import PLACES
from rulec.scenario import MotionBounds, Scenario
from rulec.scenario.motion_bounds import read_bounds
from rulec.scenario.time_grid import Timing, timing

FINEST_S = Fraction(1, 20)
"""Where no path is left the step of a recorded scene is halved, down to this (s)."""


COMFORTABLE = 4.0
"""And where no path is left that takes no more acceleration and braking than this (m/s²),"""

COMFORTABLE_S = Fraction(1, 8)
"""down to this (s)."""


class GraphOptions(TypedDict, total=False):
    """The options of ``navigation_graph``; None is as if there were none."""

    partition: PartitionName | None
    adjacency: cell_links.AdjacencyName
    extent: ExtentName
    step_s: float | None
    horizon_s: float | None
    bounds: MotionBounds | str | None


def navigation_graph(
    scenario: Scenario,
    *,
    partition: PartitionName | None = None,
    adjacency: cell_links.AdjacencyName = "touch",
    extent: ExtentName = "lane",
    step_s: float | None = None,
    horizon_s: float | None = None,
    bounds: MotionBounds | str | None = None,
) -> NavigationGraph:
    """Partition a scenario's free space over time and link the cells.

    ``partition`` is ``paper`` (behind, in front, left, right; if none is given) or ``fine``
    (station and lateral); ``adjacency``, when two cells are next to each other, ``touch``, ``edge``
    or ``forward``; ``extent``, how wide obstacles are, ``lane`` (all lanes that they touch) or
    ``body``. Planning interval and horizon (s) are the scenario's unless given; in a recorded scene
    the interval is then the longest one up to that which leaves ego a place to start, or half of
    that, and so on, where no path would be left. Within
    ``bounds`` of ego's motion, the scenario's unless given, only what ego can drive is kept; a text
    is read as ``read_bounds`` does, and ``none`` keeps everything.

    Raises RulecError R0606 if horizon and step do not fit together, R0607 if ego has no start cell,
    R0608 for an unknown partition, adjacency or extent, R0770 for bounds that make no sense, R0718
    for too many obstacles and layers.
    """
    own = scenario.ego.bounds
    bounds = read_bounds(bounds, own) if isinstance(bounds, str) else bounds or own
    partition = partition or "paper"
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
    times = timing(
        scenario.horizon_s if horizon_s is None else horizon_s,
        scenario.step_s if step_s is None else step_s,
    )
    plan = _Plan(scenario, partition, adjacency, extent, bounds)
    if step_s is not None or scenario.account is None:
        return _cut(plan, times)
    free = step_that_leaves_room(scenario, times, partition, extent)
    if free is not None:
        times = _in_steps_of(free.step, times)
    first = alive = None
    while times.step >= FINEST_S:
        graph = _cut(plan, times)
        first = first or graph
        if graph.leads_to_a_goal:
            alive = alive or graph
            if times.step < COMFORTABLE_S or _comfortable(plan, times):
                return graph if times.step >= COMFORTABLE_S else alive
        times = _in_steps_of(times.step / 2, times)
    return alive or first or _cut(plan, times)


def _comfortable(plan: _Plan, times: Timing) -> bool:
    """Whether, if ego's motion has bounds, some way takes no more than ``COMFORTABLE``."""
    own = plan.bounds
    if own is None:
        return True
    limits = replace(
        own,
        acceleration=min(own.acceleration, COMFORTABLE),
        braking=min(own.braking, COMFORTABLE),
    )
    return _cut(replace(plan, bounds=limits), times).leads_to_a_goal


@dataclass(frozen=True, slots=True)
class _Plan:
    """What a graph is made of, and how, but for its layers."""

    scenario: Scenario
    partition: PartitionName
    adjacency: cell_links.AdjacencyName
    extent: ExtentName
    bounds: MotionBounds | None


def _in_steps_of(step: Fraction, times: Timing) -> Timing:
    """The same horizon in other steps."""
    return Timing(step, int((times.layers - 1) * times.step / step) + 1)


def _cut(plan: _Plan, times: Timing) -> NavigationGraph:
    scenario, partition, extent = plan.scenario, plan.partition, plan.extent
    taken = len(scenario.obstacles) * times.layers
    PLACES.within(taken, SourceLocation(scenario.name))
    places = scene(scenario, times, partition, extent)
    planes = [
        plane(places.roadway, regions, partition, names)
        for regions, names in zip(places.swept, places.names, strict=True)
    ]
    start = start_cell(planes[0], places, scenario, times, partition=partition, extent=extent)
    onward = []
    for (before, after), regions in zip(pairwise(planes), places.instants, strict=True):
        obstacles = [str(region.obstacle) for region in regions]
        instant = plane(places.roadway, regions, partition, obstacles)
        onward.append(cell_links.continuations(before, instant, after))
    layers = tuple(
        Layer(
            times.start(p), names, flat.cells, cell_links.neighbours(flat, plan.adjacency), others
        )
        for p, (flat, names, others) in enumerate(
            zip(planes, places.names, places.others, strict=True)
        )
    )
    successors, margins = edges(layers, onward)
    predictions = places.predicted_of.items()
    goal = None if scenario.goal is None else snapped(scenario.goal, places.s, places.d)
    graph = NavigationGraph(
        scenario=scenario,
        partition=partition,
        adjacency=plan.adjacency,
        extent=extent,
        step=times.step,
        objects={
            name: prediction.obstacle for name, prediction in predictions if not prediction.number
        },
        alternatives={name: prediction for name, prediction in predictions if prediction.number},
        present=places.present,
        layers=layers,
        successors=successors,
        margins=margins,
        start=start,
        goals=tuple(
            i for i, cell in enumerate(layers[-1].cells) if goal is None or cell.meets(goal)
        ),
    )
    if plan.bounds is None:
        return graph
    from rulec.partition.motion.reachable_graph import reachable  # NumPy, only where it is needed

    return reachable(graph, plan.bounds)


_Runs = dict[tuple[int, int], int]


def edges(
    layers: Sequence[Layer], onward: Sequence[cell_links.Links]
) -> tuple[tuple[Edges, ...], tuple[Margins, ...]]:
    """Successors of every cell and their margins, in layers.

    ``onward[p]`` are the continuations from layer p to p + 1. The margin of staying is None.
    """
    back = [
        cell_links.inverse(links, len(after.cells))
        for links, after in zip(onward, layers[1:], strict=True)
    ]
    so_far = _runs(layers, back)
    to_come = _runs(layers[::-1], onward[::-1])[::-1]
    successors: list[Edges] = []
    margins: list[Margins] = []
    for p, links in enumerate(onward):
        now, then = layers[p].neighbours, layers[p + 1].neighbours
        rows: list[tuple[int, ...]] = []
        values: list[tuple[int | None, ...]] = []
        for a, continued in enumerate(links):
            before: dict[int, int] = {}
            for origin in now[a]:
                run = so_far[p][a, origin]
                for b in links[origin]:
                    before[b] = max(before.get(b, 0), run)
            after: dict[int, int] = {}
            for image in continued:
                for b in then[image]:
                    after[b] = max(after.get(b, 0), to_come[p + 1][image, b])
            changes = {b: before[b] + after[b] for b in before.keys() & after.keys() - continued}
            reached = sorted({*continued, *changes})
            rows.append(tuple(reached))
            values.append(tuple(changes.get(b) for b in reached))
        successors.append(tuple(rows))
        margins.append(tuple(values))
    return tuple(successors), tuple(margins)


def _runs(layers: Sequence[Layer], back: Sequence[cell_links.Links]) -> list[_Runs]:
    """Layers for which each adjacent pair has been adjacent so far.

    ``back[p]`` leads from layer p + 1 to layer p, in whichever order of time layers are given.
    """
    runs: list[_Runs] = []
    for p, layer in enumerate(layers):
        earlier = runs[-1] if runs else {}
        links = back[p - 1] if p else ()
        current: _Runs = {}
        for a, row in enumerate(layer.neighbours):
            for b in row:
                before = product(links[a], links[b]) if p else ()
                current[a, b] = 1 + max((earlier.get(pair, 0) for pair in before), default=0)
        runs.append(current)
    return runs
