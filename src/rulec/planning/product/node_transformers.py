"""Transformers of monitor states by the nodes of a graph.

From the last layer backwards, states of a machine that no onward path from a node distinguishes are
merged: what the machine remembers of an object often no longer matters in the rest of this graph,
and paths that differ only in that are counted together. A machine in a state from which every
onward path is rejected is lost at once; one that can no longer be lost is safe.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from rulec.planning.product.graph_instance import GraphInstance, Machine
from rulec.trace import TraceGraph
from rulec.trace.interned import Interned

Step = tuple[int, int]
"""A successor in the next layer, and the cost of going there."""

SAFE = -1
"""Instead of a state: nothing ahead is rejected. As an index it is the last entry."""

LOST = -2
"""Instead of a state: everything ahead is rejected."""

Effect = tuple[int, ...]
"""For each state of a machine, and last for SAFE: the state after a node, SAFE or LOST."""


@dataclass(frozen=True, slots=True)
class NodeTransformers:
    """The trimmed graph, with the state transformer of each node and instance.

    ``steps[p][node]`` are a node's successors from which a goal can be reached.
    ``nodes[p][node][i]`` is the node's effect on ``instances[i]``, which are the instances that
    some path loses; it is empty for nodes that are on no path from start to a goal, and
    ``on_the_way[p][node]`` says which are. Equal layers are one object.
    """

    graph: TraceGraph
    instances: tuple[GraphInstance, ...]
    on_the_way: tuple[tuple[bool, ...], ...]
    steps: tuple[tuple[tuple[Step, ...], ...], ...]
    nodes: tuple[tuple[tuple[Effect, ...], ...], ...]

    @property
    def starts(self) -> bool:
        """Whether some path leads from the start to a goal."""
        return self.on_the_way[0][self.graph.start]

    @property
    def waiting(self) -> tuple[int, ...]:
        """The states of the machines before the first node."""
        return tuple([instance.start for instance in self.instances])

    def of(self, chosen: Sequence[int]) -> NodeTransformers:
        """The transformers of only the ``chosen`` instances, by index."""
        rows = {
            layer: tuple([tuple([row[i] for i in chosen]) if row else () for row in layer.value])
            for layer in set(map(Interned, self.nodes))
        }
        return replace(
            self,
            instances=tuple([self.instances[i] for i in chosen]),
            nodes=tuple([rows[Interned(layer)] for layer in self.nodes]),
        )

    def beside(self, others: NodeTransformers) -> NodeTransformers:
        """These instances, and after them those of others on the same graph."""
        known: dict[object, tuple[tuple[Effect, ...], ...]] = {}
        nodes = []
        for own, more in zip(self.nodes, others.nodes, strict=True):
            key = Interned(own), Interned(more)
            if key not in known:
                known[key] = tuple([(*a, *b) for a, b in zip(own, more, strict=True)])
            nodes.append(known[key])
        return replace(self, instances=(*self.instances, *others.instances), nodes=tuple(nodes))


def node_transformers(
    graph: TraceGraph, instances: Sequence[GraphInstance], *, perhaps: bool = False
) -> NodeTransformers:
    """The transformer of every instance by every node between start and goals.

    An instance is lost if its rule is not surely kept or, with ``perhaps``, surely violated.
    """
    on_the_way, steps = _trimmed(graph)
    result = [
        (instance, layers)
        for instance in instances
        for machine in (instance.machine(perhaps=perhaps),)
        if _can_be_lost(instance, machine)
        and (layers := _merged(instance, machine, steps, on_the_way)) is not None
    ]
    nodes = []
    known: dict[object, tuple[tuple[Effect, ...], ...]] = {}
    for p, alive in enumerate(on_the_way):
        rows = [layers[p] for _, layers in result]
        key = tuple(map(id, (alive, *rows)))
        if key not in known:
            known[key] = tuple(
                [tuple([row[i] for row in rows]) if there else () for i, there in enumerate(alive)]
            )
        nodes.append(known[key])
    bound = tuple([instance for instance, _ in result])
    return NodeTransformers(graph, bound, on_the_way, steps, tuple(nodes))


def _trimmed(
    graph: TraceGraph,
) -> tuple[tuple[tuple[bool, ...], ...], tuple[tuple[tuple[Step, ...], ...], ...]]:
    """The nodes between the start and some goal, and their successors there with costs.

    Equal layers are one object.
    """
    from_start = [{graph.start}]
    for successors in graph.successors:
        from_start.append({target for node in from_start[-1] for target in successors[node]})
    ahead = set(graph.goals) & from_start[-1]
    trimmed = [ahead]
    for reached, rows in zip(from_start[-2::-1], reversed(graph.successors), strict=True):
        ahead = {node for node in reached if not ahead.isdisjoint(rows[node])}
        trimmed.append(ahead)
    trimmed.reverse()
    alive: dict[tuple[bool, ...], tuple[bool, ...]] = {}
    on_the_way = []
    for states, nodes in zip(graph.states, trimmed, strict=True):
        layer = tuple([node in nodes for node in range(len(states))])
        on_the_way.append(alive.setdefault(layer, layer))
    same: dict[object, tuple[tuple[Step, ...], ...]] = {}
    steps = []
    for rows, costs, ahead in zip(graph.successors, graph.weights, trimmed[1:], strict=True):
        onward = tuple(
            [
                tuple([step for step in zip(row, cost, strict=True) if step[0] in ahead])
                for row, cost in zip(rows, costs, strict=True)
            ]
        )
        steps.append(same.setdefault(onward, onward))
    return tuple(on_the_way), tuple(steps)


def _can_be_lost(instance: GraphInstance, machine: Machine) -> bool:
    """Whether the machine rejects some word of the letters that occur."""
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
    machine: Machine,
    steps: Sequence[tuple[tuple[Step, ...], ...]],
    on_the_way: Sequence[tuple[bool, ...]],
) -> list[tuple[Effect, ...]] | None:
    """Transformers of every layer, with states of equal futures merged.

    None if no path loses the instance, so that it does not matter.
    """
    n_states = len(machine.successors)
    # The machine waits until its objects are present; its verdict comes with their last layer.
    waiting, over = [(instance.start,) * n_states], [(SAFE,) * n_states]
    within, final = _columns(machine, final=False), _columns(machine, final=True)
    nobody = {len(layer): (0,) * len(layer) for layer in on_the_way}
    # Ids are cheap keys, and stay valid because the lists here keep the objects alive.
    effects: dict[int, dict[object, Effect]] = {
        id(raw): {} for raw in (waiting, within, final, over)
    }
    known: dict[object, tuple[Effect, ...]] = {}
    same: dict[tuple[Effect, ...], tuple[Effect, ...]] = {}
    later: tuple[Effect, ...] = ()
    layers = []
    for p in reversed(range(len(on_the_way))):
        alive, rows = on_the_way[p], steps[p] if p < len(steps) else ()
        if instance.first <= p <= instance.last:
            symbols = instance.letters[p - instance.first]
            raw = final if p == instance.last else within
        else:
            symbols = nobody[len(alive)]
            raw = waiting if p < instance.first else over
        key = (symbols, id(raw), id(rows), id(later), id(alive))
        if key not in known:
            seen = effects[id(raw)]
            layer: list[Effect] = []
            for node, symbol in enumerate(symbols):
                if not alive[node]:
                    layer.append(())
                    continue
                futures = frozenset([later[target] for target, _ in rows[node]]) if rows else None
                effect = seen.get((symbol, futures))
                if effect is None:
                    effect = seen[symbol, futures] = _in_view_of(futures, raw[symbol])
                layer.append(effect)
            transformers = tuple(layer)
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


def _columns(machine: Machine, *, final: bool) -> list[Effect]:
    classes = range(len(machine.successors[0]))
    if final:
        return [tuple([SAFE if row[s] else LOST for row in machine.outputs]) for s in classes]
    return [
        tuple([LOST if row[s] == machine.rejecting_sink else row[s] for row in machine.successors])
        for s in classes
    ]


def _in_view_of(futures: Collection[Effect] | None, raw: Effect) -> Effect:
    """An effect in which states that no successor's effect distinguishes are merged."""
    if futures is None:
        return (*raw, SAFE)
    merged: list[int] = []
    first: dict[tuple[int, ...], int] = {}
    for state, future in enumerate(zip(*futures, strict=True)):
        if set(future) in ({LOST}, {SAFE}):
            merged.append(future[0])
        else:
            merged.append(first.setdefault(future, state))
    return (*[after if after < 0 else merged[after] for after in raw], SAFE)
