"""Regions of the obstacles in every layer and at the instants between layers.

An obstacle is in a layer if it sweeps some area of the road there. One that leaves and comes back
counts as another object, called ``id_2``, because a rule is judged on one stretch of presence.

Cells leave out what is occupied if every obstacle does what is likeliest. Each other prediction
cuts the road too, as a further obstacle would, but the space it occupies stays road, where ego
would be hit by it.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import chain, count, pairwise

from rulec.partition.cells.regions import OCCUPIED, ExtentName, PartitionName, Region, region_of
from rulec.partition.cells.roadway import CLEARANCE_M, Roadway, Snap, roadway, snap_table, snapped
from rulec.scenario import Box, Obstacle, Scenario
from rulec.scenario.motion import swept
from rulec.scenario.time_grid import Timing

HIT = ord("x")
"""Code of a cell that an obstacle occupies by a less likely prediction, in place of a relation."""


@dataclass(frozen=True, slots=True)
class Predicted:
    """An obstacle moving by one of its predictions; ``number`` 0 is the likeliest.

    The ``id`` of ``obstacle`` is unique among all predictions; ``of`` is the id in the scenario.
    """

    obstacle: Obstacle
    of: str
    number: int


def predicted(scenario: Scenario) -> tuple[Predicted, ...]:
    """Every obstacle by its likeliest prediction, then by each further one."""
    predictions = [Predicted(obstacle, obstacle.id, 0) for obstacle in scenario.obstacles]
    taken = {obstacle.id for obstacle in scenario.obstacles}
    for obstacle in scenario.obstacles:
        for number, alternative in enumerate(obstacle.alternatives, start=1):
            name = f"{obstacle.id}~{number}"
            while name in taken:
                name += "~"
            taken.add(name)
            motion, weight = alternative.motion, alternative.weight
            moving = replace(obstacle, id=name, motion=motion, weight=weight, alternatives=())
            predictions.append(Predicted(moving, obstacle.id, number))
    return tuple(predictions)


@dataclass(frozen=True, slots=True)
class Occupancy:
    """The regions of all obstacles over time.

    ``names[p][k]`` is the name of the obstacle of ``swept[p][k]``: first those by the likeliest
    predictions, in ``names``, then those by other predictions, in ``others``. ``instants[p]`` are
    the regions at the moment between layers p and p + 1. ``s`` and ``d`` snap coordinates of ego
    and the goal.
    """

    roadway: Roadway
    swept: tuple[tuple[Region, ...], ...]
    names: tuple[tuple[str, ...], ...]
    others: tuple[tuple[str, ...], ...]
    instants: tuple[tuple[Region, ...], ...]
    predicted_of: Mapping[str, Predicted]
    present: Mapping[str, tuple[int, int]]
    s: Snap
    d: Snap


def scene(
    scenario: Scenario, timing: Timing, partition: PartitionName, extent: ExtentName = "lane"
) -> Occupancy:
    """The regions in every layer and at every instant between two layers."""
    predictions = predicted(scenario)
    obstacles = [prediction.obstacle for prediction in predictions]
    likeliest = len(scenario.obstacles)
    starts = [timing.start(p) for p in range(timing.layers + 1)]
    layers = list(pairwise(starts))
    moments = [(start, start) for start in starts[1:-1]]
    bodies = {
        (i, interval): body
        for i, obstacle in enumerate(obstacles)
        for interval in (*layers, *moments)
        if (body := swept(obstacle, *interval)) is not None
    }
    half = _half_width(scenario, extent)
    aside = half + CLEARANCE_M if extent == "clearance" else half
    wide = {key: _wider(body, aside) for key, body in bodies.items()}
    free = _narrower(scenario.road.outline, half, scenario.ego.d)
    s, d = _snaps(scenario, [*bodies.values(), *wide.values(), free])
    road = roadway(scenario.road, free, s, d)

    def regions(interval: tuple[float, float], looking: tuple[float, float]) -> Iterator[Region]:
        for i, obstacle in enumerate(obstacles):
            if (i, interval) not in bodies:
                continue
            region = region_of(
                obstacle=obstacle,
                index=i,
                body=snapped(bodies[i, interval], s, d),
                interval=looking,
                partition=partition,
                roadway=road,
                extent=extent,
                wide=snapped(wide[i, interval], s, d),
            )
            if region is not None and i >= likeliest:  # by a less likely prediction: ego may enter
                table = region.table.replace(bytes([OCCUPIED]), bytes([HIT]))
                region = replace(region, table=table)
            if region is not None:
                yield region

    layer_regions = tuple(tuple(regions(interval, interval)) for interval in layers)
    # At an instant a pedestrian faces in the direction of its next movement
    instants = tuple(
        tuple(regions(moment, upcoming))
        for moment, upcoming in zip(moments, layers[1:], strict=True)
    )
    names, index_of, present = _appearances(obstacles, layer_regions)
    return Occupancy(
        roadway=road,
        swept=layer_regions,
        names=tuple(tuple(name for name in here if index_of[name] < likeliest) for here in names),
        others=tuple(tuple(name for name in here if index_of[name] >= likeliest) for here in names),
        instants=instants,
        predicted_of={name: predictions[i] for name, i in index_of.items()},
        present=present,
        s=s,
        d=d,
    )


def _half_width(scenario: Scenario, extent: ExtentName) -> float:
    """Half of ego's width (m) where it counts; with ``clearance`` its bounds may provide it."""
    ego = scenario.ego
    width = ego.width
    if extent == "clearance" and not width and ego.bounds is not None:
        width = ego.bounds.width
    return 0.0 if extent == "lane" else width / 2


def _wider(body: Box, half: float) -> Box:
    """The region outside of which ego's centre is not beside the obstacle."""
    return Box(body.s_min, body.s_max, body.d_min - half, body.d_max + half)


def _narrower(outline: Box, half: float, start: float) -> Box:
    """The road for ego's centre: half its width from the edges, or less if it starts closer."""
    return Box(
        outline.s_min,
        outline.s_max,
        max(outline.d_min, min(outline.d_min + half, start)),
        min(outline.d_max, max(outline.d_max - half, start)),
    )


def _snaps(scenario: Scenario, bodies: Sequence[Box]) -> tuple[Snap, Snap]:
    road, ego = scenario.road, scenario.ego
    spans = [road.s, *(surface.s for surface in road.surfaces), *(gap.s for gap in road.missing)]
    boxes = [*bodies, ego.body, *([scenario.goal] if scenario.goal else [])]
    moving_s = [ego.s, *(place for box in boxes for place in (box.s_min, box.s_max))]
    moving_d = [ego.d, *(place for box in boxes for place in (box.d_min, box.d_max))]
    return snap_table(chain.from_iterable(spans), moving_s), snap_table(road.lanes, moving_d)


def _appearances(
    obstacles: Sequence[Obstacle], layers: Sequence[Sequence[Region]]
) -> tuple[tuple[tuple[str, ...], ...], dict[str, int], dict[str, tuple[int, int]]]:
    taken = {obstacle.id for obstacle in obstacles}
    current: dict[int, str] = {}
    index_of: dict[str, int] = {}
    present: dict[str, tuple[int, int]] = {}
    names: list[tuple[str, ...]] = []
    for p, regions in enumerate(layers):
        for i in (region.obstacle for region in regions):
            name = current.get(i)
            if name is None or present[name][1] < p - 1:
                first = obstacles[i].id
                spares = (f"{first}_{number}" for number in count(2))
                name = first if name is None else next(x for x in spares if x not in taken)
                taken.add(name)
                current[i] = name
                index_of[name] = i
                present[name] = (p, p)
            present[name] = (present[name][0], p)
        names.append(tuple(current[region.obstacle] for region in regions))
    return tuple(names), index_of, present
