"""Transformers of monitor states by the nodes of a graph.

From the last layer backwards, states of a machine that no path onward from a node tells apart are
made one: what it remembers of an object often has no bearing any more on what can still happen in
this graph, and paths that differ in it alone can count together. A machine from whose state every
path onward is rejected is lost at once, one that can no longer be lost is safe.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass

from rulec.automata.mealy_monitor import MealyMonitor
from rulec.planning.product.graph_instances import GraphInstance
from rulec.planning.product.reachability import Step, trimmed, trimmed_steps
from rulec.trace import TraceGraph

SAFE = -1
"""In place of a state: nothing that comes is rejected. As an index it means the last entry."""

LOST = -2
"""In place of a state: everything that comes is rejected."""

Effect = tuple[int, ...]
"""For each state of a machine, and last for SAFE: the state after a node, SAFE or LOST."""


@dataclass(frozen=True, slots=True)
class NodeTransformers:
    """Trimmed graph, with the state transformer of each node and instance.

    ``steps[p][node]`` are a node's followers from which a goal can be reached.
    ``nodes[p][node][i]`` is what the node does to ``instances[i]``, those that some path loses;
    nothing is known of nodes that are on no way from start to a goal, and
    ``on_the_way[p][node]`` says which are on one. Equal layers are one object.
    """

    graph: TraceGraph
    instances: tuple[GraphInstance, ...]
    on_the_way: tuple[tuple[bool, ...], ...]
    steps: tuple[tuple[tuple[Step, ...], ...], ...]
    nodes: tuple[tuple[tuple[Effect, ...], ...], ...]

    @property
    def starts(self) -> bool:
        """Test whether some path leads from the start to a goal."""
        return self.on_the_way[0][self.graph.start]

    @property
    def waiting(self) -> tuple[int, ...]:
        """The states of the machines before the first node."""
        return tuple([instance.start for instance in self.instances])

    def of(self, chosen: Sequence[int]) -> NodeTransformers:
        """The effects on some of the instances alone, by index."""
        known: dict[int, tuple[tuple[Effect, ...], ...]] = {}
        for layer in self.nodes:
            if id(layer) not in known:
                known[id(layer)] = tuple(
                    [tuple([row[i] for i in chosen]) if row else () for row in layer]
                )
        return NodeTransformers(
            self.graph,
            tuple([self.instances[i] for i in chosen]),
            self.on_the_way,
            self.steps,
            tuple([known[id(layer)] for layer in self.nodes]),
        )


def node_transformers(graph: TraceGraph, instances: Sequence[GraphInstance]) -> NodeTransformers:
    """Transformer of every instance by every node between start and goals."""
    on_the_way = trimmed(graph)
    steps = trimmed_steps(graph, on_the_way)
    result = [
        (instance, layers)
        for instance in instances
        if _can_be_lost(instance) and (layers := _merged(instance, steps, on_the_way)) is not None
    ]
    nodes = []
    known: dict[tuple[int, ...], tuple[tuple[Effect, ...], ...]] = {}
    for p, alive in enumerate(on_the_way):
        rows = [layers[p] for _, layers in result]
        key = (id(alive), *map(id, rows))
        if key not in known:
            known[key] = tuple(
                [tuple([row[i] for row in rows]) if there else () for i, there in enumerate(alive)]
            )
        nodes.append(known[key])
    bound = tuple([instance for instance, _ in result])
    return NodeTransformers(graph, bound, tuple(on_the_way), steps, tuple(nodes))


def _can_be_lost(instance: GraphInstance) -> bool:
    """Test whether the monitor rejects some word of the letters that occur."""
    machine = instance.rule.machine
    symbols = set().union(*instance.letters)
    reached, new = {instance.start}, [instance.start]
    while new:
        successors = machine.successors[new.pop()]
        for state in {successors[symbol] for symbol in symbols} - reached:
            reached.add(state)
            new.append(state)
    return machine.rejecting_sink in reached or not all(
        machine.outputs[state][symbol] for state in reached for symbol in symbols
    )


def _merged(
    instance: GraphInstance,
    steps: Sequence[tuple[tuple[Step, ...], ...]],
    on_the_way: Sequence[tuple[bool, ...]],
) -> list[tuple[Effect, ...]] | None:
    """Transformers of every layer, with states of equal futures merged.

    None if no path loses the instance: then it does not matter.
    """
    nobody = {len(layer): (0,) * len(layer) for layer in on_the_way}
    merging = _Merging(instance)
    known: dict[object, tuple[Effect, ...]] = {}
    same: dict[tuple[Effect, ...], tuple[Effect, ...]] = {}
    later: tuple[Effect, ...] = ()
    layers = []
    for layer in reversed(range(len(on_the_way))):
        alive = on_the_way[layer]
        here = instance.first <= layer <= instance.last
        symbols = instance.letters[layer - instance.first] if here else nobody[len(alive)]
        raw = merging.raw(layer)
        rows = steps[layer] if layer < len(steps) else ()
        key = (symbols, id(raw), id(rows), id(later), id(alive))
        if key not in known:
            transformers = merging.layer(symbols, raw, rows, later, alive)
            known[key] = same.setdefault(transformers, transformers)
        later = known[key]
        layers.append(later)
    layers.reverse()
    states = {instance.start}
    for row in layers:
        states = {effect[state] for effect in set(row) if effect for state in states}
        if LOST in states:
            return layers
    return None


class _Merging:
    """Merge states of an instance's monitor by their futures."""

    def __init__(self, instance: GraphInstance) -> None:
        machine = instance.rule.machine
        self._instance = instance
        n_states = len(machine.successors)
        self._before = [((instance.start,) * n_states)]
        self._after = [((SAFE,) * n_states)]
        self._within = _columns(machine, final=False)
        self._last = _columns(machine, final=True)
        self._known: dict[object, Effect] = {}

    def raw(self, layer: int) -> list[Effect]:
        """Transformer of each letter class in a layer, before merging.

        The machine waits until its objects are there. With their last layer it gives its verdict.
        """
        if layer < self._instance.first:
            return self._before
        if layer > self._instance.last:
            return self._after
        return self._last if layer == self._instance.last else self._within

    def layer(
        self,
        symbols: Sequence[int],
        raw: Sequence[Effect],
        rows: Sequence[Sequence[Step]],
        later: Sequence[Effect],
        alive: Sequence[bool],
    ) -> tuple[Effect, ...]:
        """Transformers of a layer's nodes, given those of the next."""
        transformers: list[Effect] = []
        for node, symbol in enumerate(symbols):
            if not alive[node]:
                transformers.append(())
                continue
            futures = frozenset([later[target] for target, _ in rows[node]]) if rows else None
            key = (id(raw), symbol, futures)
            if key not in self._known:
                self._known[key] = _in_view_of(futures, raw[symbol])
            transformers.append(self._known[key])
        return tuple(transformers)


def _columns(machine: MealyMonitor, *, final: bool) -> list[Effect]:
    """Transformer of each letter class: the next state, or the verdict."""
    classes = range(len(machine.successors[0]))
    if final:
        return [tuple([SAFE if row[s] else LOST for row in machine.outputs]) for s in classes]
    return [
        tuple([LOST if row[s] == machine.rejecting_sink else row[s] for row in machine.successors])
        for s in classes
    ]


def _in_view_of(futures: Collection[Effect] | None, raw: Effect) -> Effect:
    """An effect with states made one that no follower's effect tells apart."""
    if futures is None:
        return (*raw, SAFE)
    merged: list[int] = []
    first: dict[tuple[int, ...], int] = {}
    for state, future in enumerate(zip(*futures, strict=True)):
        if all(after == LOST for after in future):
            merged.append(LOST)
        elif all(after == SAFE for after in future):
            merged.append(SAFE)
        else:
            merged.append(first.setdefault(future, state))
    return (*[after if after < 0 else merged[after] for after in raw], SAFE)
