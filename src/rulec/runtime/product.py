"""A graph of traces times the rules' machines: which paths keep every rule, without walking them.

Two partial paths that end in the same node with every machine in the same state have the same
futures. So paths are counted per node and joint state, layer by layer.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from rulec.automata.compiled import CompiledRulebook
from rulec.automata.machine import Machine
from rulec.runtime.binding import bindings
from rulec.runtime.checking import check_objects, check_state
from rulec.runtime.facts import check_counting_facts
from rulec.runtime.letters import Columns, present_in
from rulec.runtime.numbers import exact
from rulec.runtime.verify import check_step
from rulec.trace import TraceGraph

JointState = tuple[int, ...]
"""The state of each instance's machine; all zero at the end, where only verdicts are left."""

LOST = -1
"""In place of a state: the rule is lost."""

Effect = tuple[int, ...]
"""What a node does to a machine: for each of its states the one after, or LOST."""

ProductNode = tuple[int, JointState]
"""A node's index in its layer, and the joint state behind it."""


@dataclass(frozen=True, slots=True)
class Instance:
    """A rule with objects bound: its machine, and the letter class of every node.

    ``letters[p]`` are those of layer ``first + p``'s nodes.
    """

    machine: Machine
    first: int
    last: int
    letters: tuple[tuple[int, ...], ...]


@dataclass(frozen=True, slots=True)
class Product:
    """The part of graph times machines that can be reached without losing a rule.

    ``counts[p]`` gives for each product node of layer ``p`` how many partial paths lead to it, and
    ``steps[p]`` its followers in layer ``p + 1``.
    """

    graph: TraceGraph
    counts: tuple[dict[ProductNode, int], ...]
    steps: tuple[dict[ProductNode, list[ProductNode]], ...]

    @property
    def accepted(self) -> int:
        """How many paths from start to a goal keep every rule: exact."""
        goals = set(self.graph.goals)
        return sum(count for (node, _), count in self.counts[-1].items() if node in goals)


def count_paths(graph: TraceGraph) -> int:
    """How many paths lead from start to a goal: exact."""
    counts = {graph.start: 1}
    for successors in graph.successors:
        following: dict[int, int] = {}
        for node, count in counts.items():
            for target in successors[node]:
                following[target] = following.get(target, 0) + count
        counts = following
    return sum(counts.get(goal, 0) for goal in set(graph.goals))


def instances(
    graph: TraceGraph, rulebook: CompiledRulebook, step_s: Fraction | None = None
) -> list[Instance]:
    """Every hard rule with every binding of its variables to the graph's objects.

    ``step_s`` is the graph's step where that is no decimal, a third of a second for one.

    Raises:
        RulecError: R0502 to R0505 if the graph does not supply what the rules read, R0507 if a hard
            rule was compiled for another step, R0508 if a state contradicts a fact.
    """
    vocabulary = rulebook.vocabulary
    rules = [rule for rule in rulebook.rules if rule.strength == "hard"]
    for rule in rules:
        check_step(rule, exact(graph.step_s) if step_s is None else step_s, "the graph")
    check_objects(graph.objects, vocabulary)
    for layer, states in enumerate(graph.states):
        for state in states:
            check_state(state, graph.objects, vocabulary, f"a cell of layer {layer}")
    columns = [
        Columns(
            states,
            vocabulary,
            f"a cell of layer {layer}".format,
            objects=present_in(layer, graph.objects, graph.present),
            facts=rulebook.facts,
        )
        for layer, states in enumerate(graph.states)
    ]
    for layer, read in enumerate(columns):
        where = f"a cell of layer {layer}".format
        check_counting_facts(rulebook, len(graph.states[layer]), read.moment, where, None)
    return [
        Instance(
            rule.machine,
            binding.first,
            binding.last,
            tuple(
                columns[layer].word(rule, binding.objects, 0, len(graph.states[layer]) - 1)
                for layer in range(binding.first, binding.last + 1)
            ),
        )
        for rule in rules
        for binding in bindings(rule, vocabulary, graph.objects, graph.present, len(graph.states))
    ]


def explore(graph: TraceGraph, rules: Sequence[Instance]) -> Product:
    """Build the product forward from the graph's start, dropping every path that loses a rule."""
    effects = _effects(graph, rules)
    waiting = (0,) * len(effects[0][graph.start])
    first = _enter(effects[0][graph.start], waiting)
    counts: list[dict[ProductNode, int]] = [{} if first is None else {(graph.start, first): 1}]
    steps: list[dict[ProductNode, list[ProductNode]]] = []
    for layer, successors in enumerate(graph.successors, 1):
        following: dict[ProductNode, int] = {}
        onward: dict[ProductNode, list[ProductNode]] = {}
        known: dict[ProductNode, ProductNode | None] = {}
        for origin, count in counts[-1].items():
            node, joint = origin
            reached = []
            for target in successors[node]:
                key = (target, joint)
                if key not in known:
                    entered = _enter(effects[layer][target], joint)
                    known[key] = None if entered is None else (target, entered)
                step = known[key]
                if step is not None:
                    following[step] = following.get(step, 0) + count
                    reached.append(step)
            onward[origin] = reached
        counts.append(following)
        steps.append(onward)
    return Product(graph, tuple(counts), tuple(steps))


def _enter(effects: Sequence[Effect], joint: JointState) -> JointState | None:
    """The joint state after a node with these effects; None if a rule is lost there."""
    after = tuple([effect[state] for effect, state in zip(effects, joint, strict=True)])
    return None if LOST in after else after


def _effects(graph: TraceGraph, rules: Sequence[Instance]) -> list[list[list[Effect]]]:
    """For every layer and node the effects on the machines of all instances that ever matter."""
    every = [
        _merged(graph, [_layer(instance, p, graph) for p in range(len(graph.states))])
        for instance in rules
    ]
    mattering = [one for one in every if one is not None]
    return [
        [[one[layer][node] for one in mattering] for node in range(len(states))]
        for layer, states in enumerate(graph.states)
    ]


def _layer(instance: Instance, layer: int, graph: TraceGraph) -> list[Effect]:
    """The effect of each node of a layer.

    A machine waits in state 0 until its objects are there. With their last layer it gives its
    verdict and returns to state 0.
    """
    machine = instance.machine
    if not instance.first <= layer <= instance.last:
        return [(0,) * len(machine.following)] * len(graph.states[layer])
    symbols = instance.letters[layer - instance.first]
    if layer == instance.last:
        return [tuple([0 if row[s] else LOST for row in machine.accepting]) for s in symbols]
    return [
        tuple([LOST if row[s] == machine.dead else row[s] for row in machine.following])
        for s in symbols
    ]


def _merged(graph: TraceGraph, effects: list[list[Effect]]) -> list[list[Effect]] | None:
    """The same effects with states made one that no path onward from a node tells apart.

    What a machine remembers of an object often has no bearing any more on what can still happen in
    this graph; then paths that differ in it alone count together. A state from which every path is
    lost is LOST at once. None if nothing is ever lost: then the instance does not matter at all.
    """
    for layer in reversed(range(len(graph.successors))):
        later = effects[layer + 1]
        here = []
        for node, effect in enumerate(effects[layer]):
            onward = graph.successors[layer][node]
            futures = list(zip(*[later[target] for target in onward], strict=True))
            here.append(_with_futures(effect, futures) if onward else effect)
        effects[layer] = here
    lost = any(LOST in effect for layer in effects for effect in layer)
    return effects if lost else None


def _with_futures(effect: Effect, futures: Sequence[tuple[int, ...]]) -> Effect:
    """``futures[state]``: what the followers of a node make of a state."""
    representative: dict[tuple[int, ...], int] = {}
    merged = []
    for state, future in enumerate(futures):
        if all(after == LOST for after in future):
            merged.append(LOST)
        else:
            merged.append(representative.setdefault(future, state))
    return tuple([LOST if state == LOST else merged[state] for state in effect])
