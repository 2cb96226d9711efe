"""A graph's maneuvers in worlds where obstacles do not do what is likeliest.

A world chooses one prediction for each obstacle. Ego takes the same path through the same cells;
the relation of a cell to an obstacle is the one by the chosen prediction.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import compress
from typing import TypeVar

from rulec.partition.cell_graph import NavigationGraph, valuation
from rulec.partition.cells.cell_model import Cell, Layer
from rulec.partition.cells.occupancy import HIT, Predicted
from rulec.scenario import Obstacle
from rulec.trace.trace_model import State, TraceGraph

Of = TypeVar("Of")

World = Mapping[str, int]
"""Obstacle -> the number of the prediction that comes true; 0, the likeliest, if missing."""


@dataclass(frozen=True, slots=True)
class PredictedPath:
    """A path through a graph, with every prediction of every obstacle.

    ``weights`` are, for each obstacle, those of its predictions; predictions that the path's cells
    do not distinguish are merged under the smallest number. ``traces`` is a graph of this path
    alone; ``predicted`` maps its objects to predictions. Objects in ``hit`` have no relation in
    some state, because there they are where ego is.
    """

    traces: TraceGraph
    weights: Mapping[str, Mapping[int, Fraction]]
    predicted: Mapping[str, Predicted]
    hit: frozenset[str]


def predicted_path(graph: NavigationGraph, path: Sequence[int]) -> PredictedPath:
    """A path, given by its cells' indices, with all predictions."""
    cells = [layer.cells[i] for layer, i in zip(graph.layers, path, strict=True)]
    weights = _told_apart(graph, cells)
    who = {
        name: prediction
        for name, prediction in _predictions(graph).items()
        if prediction.number in weights[prediction.of]
    }
    named = {name: name for name in who}
    last = len(path) - 1
    step = ((0,),)
    traces = TraceGraph(
        step_s=graph.step_s,
        objects={name: prediction.obstacle.type for name, prediction in who.items()},
        present=graph.at_times(named),
        states=tuple(_states(graph, p, [i], who, named) for p, i in enumerate(path)),
        successors=(step,) * last,
        weights=(step,) * last,
        margins=(((None,),),) * last,
        cost_unit=Fraction(1),
        start=0,
        goals=(0,),
    )
    hit = (_hit_in(*there, who) for there in zip(graph.layers, cells, strict=True))
    return PredictedPath(traces, weights, who, frozenset().union(*hit))


def _predictions(graph: NavigationGraph) -> dict[str, Predicted]:
    likeliest = {name: Predicted(object_, object_.id, 0) for name, object_ in graph.objects.items()}
    return {**likeliest, **graph.alternatives}


def _told_apart(graph: NavigationGraph, cells: Sequence[Cell]) -> dict[str, dict[int, Fraction]]:
    predictions = _predictions(graph)
    codes: dict[tuple[str, int], dict[int, int]] = {}
    for p, (layer, cell) in enumerate(zip(graph.layers, cells, strict=True)):
        for name, code in zip((*layer.objects, *layer.alternatives), cell.code, strict=True):
            codes.setdefault((predictions[name].of, predictions[name].number), {})[p] = code
    result: dict[str, dict[int, Fraction]] = {}
    for obstacle in graph.scenario.obstacles:
        own = result[obstacle.id] = {0: obstacle.weight}
        for number, alternative in enumerate(obstacle.alternatives, start=1):
            there = codes.get((obstacle.id, number))
            same = next((k for k in own if codes.get((obstacle.id, k)) == there), number)
            own[same] = own.get(same, Fraction(0)) + alternative.weight
    return result


def world_graph(graph: NavigationGraph, world: World) -> TraceGraph | None:
    """The paths without a collision in a world; None if there are none.

    Obstacles keep the names that they have in the scenario.
    """
    who, named = _in_world(graph, world)
    free = [
        [i for i, cell in enumerate(layer.cells) if not _hit_in(layer, cell, who)]
        for layer in graph.layers
    ]
    if graph.start not in free[0] or not all(free):
        return None
    return replace(
        _thinned(graph.trace_graph(), free),
        objects={named[name]: prediction.obstacle.type for name, prediction in who.items()},
        present=graph.at_times(named),
        states=tuple(_states(graph, p, cells, who, named) for p, cells in enumerate(free)),
    )


def named_in(graph: NavigationGraph, world: World) -> dict[str, Obstacle]:
    """The obstacles on the road in a world, by their names there."""
    who, named = _in_world(graph, world)
    return {named[name]: prediction.obstacle for name, prediction in who.items()}


def _in_world(graph: NavigationGraph, world: World) -> tuple[dict[str, Predicted], dict[str, str]]:
    who = {
        name: prediction
        for name, prediction in _predictions(graph).items()
        if world.get(prediction.of, 0) == prediction.number
    }
    return who, {
        name: prediction.of if name == prediction.obstacle.id else name
        for name, prediction in who.items()
    }


def _hit_in(layer: Layer, cell: Cell, who: Collection[str]) -> set[str]:
    names = (*layer.objects, *layer.alternatives)
    return {
        name for name, code in zip(names, cell.code, strict=True) if code == HIT and name in who
    }


def _states(
    graph: NavigationGraph,
    p: int,
    cells: Sequence[int],
    who: Mapping[str, Predicted],
    named: Mapping[str, str],
) -> tuple[State, ...]:
    layer = graph.layers[p]
    here = [
        (i, name) for i, name in enumerate((*layer.objects, *layer.alternatives)) if name in who
    ]
    signals = graph.signals_of({named[name]: who[name].obstacle for _, name in here})
    states = []
    for cell in (layer.cells[i] for i in cells):
        codes = {named[name]: cell.code[i] for i, name in here if cell.code[i] != HIT}
        states.append({**valuation(cell, list(codes), bytes(codes.values())), **signals})
    return tuple(states)


def _thinned(traces: TraceGraph, kept: Sequence[Sequence[int]]) -> TraceGraph:
    number = [{node: new for new, node in enumerate(layer)} for layer in kept]

    def onward(rows: Sequence[Sequence[Sequence[Of]]], p: int) -> tuple[tuple[Of, ...], ...]:
        ahead = number[p + 1]
        return tuple(
            tuple(compress(rows[p][i], [target in ahead for target in traces.successors[p][i]]))
            for i in kept[p]
        )

    steps = range(len(kept) - 1)
    return replace(
        traces,
        successors=tuple(
            tuple(tuple(number[p + 1][i] for i in row) for row in onward(traces.successors, p))
            for p in steps
        ),
        weights=tuple(onward(traces.weights, p) for p in steps),
        margins=tuple(onward(traces.margins, p) for p in steps),
        start=number[0][traces.start],
        goals=tuple(number[-1][goal] for goal in traces.goals if goal in number[-1]),
    )
