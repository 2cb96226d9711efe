"""Rules bound to a graph's objects, with the letters that each node may have.

Paths are judged like traces in ``rulec.monitoring.uncertainty``: a node has a set of letters, and
the machine steps on sets of states, one set for each choice of the constants. These steps form a
machine of their own, by which paths can be counted.
"""

from __future__ import annotations

from bisect import bisect_right
from collections.abc import Callable, Collection, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from functools import cached_property
from itertools import accumulate, chain, pairwise
from typing import TypeAlias, TypeVar

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook, check_step
from rulec.automata.outcome_machine import KEPT, VIOLATED, SetMonitor
from rulec.automata.thresholds import exact_step
from rulec.monitoring.axiom_violations import check_counting_axioms
from rulec.monitoring.bindings import Binding, Cast, binding_of, types_of
from rulec.monitoring.implied_values import with_implied_in_graph
from rulec.monitoring.state_validation import check_objects, check_states
from rulec.monitoring.told_names import names_lacking, untold_names, untold_types, with_untold
from rulec.monitoring.uncertainty.known_words import run
from rulec.monitoring.uncertainty.lazy_bindings import doubtful_bindings
from rulec.monitoring.uncertainty.state_letters.possible_letters import PossibleLetters
from rulec.monitoring.uncertainty.suppositions import (
    Suppositions,
    spelled_out,
)
from rulec.monitoring.uncertainty.uncertain_machine import UncertainMachine, uncertain_machine
from rulec.monitoring.verdict import NO_PAST, CarriedState, RuleNotJudged, Violation
from rulec.planning.product.graph_instance import GraphInstance, Readings, SetMachine
from rulec.rulebook.rulebook_model import Strength
from rulec.trace import State, Trace, TraceGraph

MOST_SETS = 1 << 10
"""The most sets of states distinguished; of further ones everything is assumed possible."""

_NOBODY = -1
"""Instead of a set of states: facts exclude this choice of constants."""

_Word: TypeAlias = tuple[int, ...]
"""For each node, layer by layer, the classes of its possible letters as a bit set."""


@dataclass(frozen=True, slots=True)
class _Start:
    """The possible states of a machine, and whether the rule may already be settled."""

    states: frozenset[int] = frozenset({0})
    perhaps_settled: bool = False


@dataclass(frozen=True, slots=True)
class _Alike:
    """The data that bindings of a rule have in common if they are one instance."""

    first: int
    start: _Start
    words: tuple[_Word, ...]
    exact: bool


class PossibleNodes:
    """The letters that the nodes of a checked graph may have."""

    def __init__(
        self,
        graph: TraceGraph,
        rulebook: CompiledRulebook,
        places: Sequence[Callable[[int], str]],
    ) -> None:
        self._graph = graph
        self._rulebook = rulebook
        self._places = places
        self._untold = untold_names(rulebook.vocabulary, graph.told)
        self._untold_types = untold_types(rulebook.vocabulary, graph.told)
        self._vocabulary = with_untold(rulebook.vocabulary, self._untold)
        self._nodes = NodesInTurn(graph)
        nodes = spelled_out(
            Trace("", graph.step_s, graph.objects, self._nodes.states, self._nodes.present),
            rulebook.vocabulary,
        )
        self._letters = PossibleLetters(nodes, rulebook, self._vocabulary, self._where)
        some = tuple([layer[0] if layer else {} for layer in graph.states])
        path = spelled_out(
            Trace("", graph.step_s, graph.objects, some, graph.present), rulebook.vocabulary
        )
        constants = PossibleLetters(path, rulebook, self._vocabulary)
        self._suppositions = Suppositions(path, rulebook, self._vocabulary, constants)
        self._machines: dict[object, tuple[Sequence[tuple[int, ...]], Readings]] = {}

    def check_counting_axioms(self) -> None:
        """Check the counting axioms in every node. Raises RulecError R0508."""
        n_nodes = len(self._nodes.states)
        check_counting_axioms(self._rulebook, n_nodes, self._letters.view, self._where, None)

    def _where(self, number: int) -> str:
        return self._places[self._nodes.layer_of(number)](number)

    def untold(self, rule: CompiledRule, past: CarriedState) -> tuple[str, ...]:
        """Missing names and types because of which no path can be known to violate a rule."""
        begun = [state for (name, _), state in past.states.items() if name == rule.name]
        if any(begun) or rule.name in past.doubtful_rules:
            return ()
        types = [
            variable.type for variable in rule.variables if variable.type in self._untold_types
        ]
        lacking = uncertain_machine(rule, None).untold(self._untold)
        return (*names_lacking(lacking, self._vocabulary, self._untold), *types)

    def instances(self, rule: CompiledRule, past: CarriedState) -> list[GraphInstance]:
        """Bind a rule to the graph's objects; no instance if the rule cannot be judged.

        Raises R0504 if a value without default is missing, R0508 if a state is impossible.
        """
        if self.untold(rule, past):
            return []
        machine = uncertain_machine(rule, None)
        alike: dict[_Alike, list[Binding]] = {}
        for binding in self._bindings(rule, past):
            about = (rule.name, tuple(binding.objects.values()))
            # What is settled is read, too, so that impossible nodes get noticed.
            words, is_exact = self._words(rule, machine, binding)
            if binding.first == 0 and about in past.settled:
                continue
            start = _Start()
            if binding.first == 0 and past != NO_PAST:
                start = _Start(past.starts(about), about in past.perhaps_settled)
            key = _Alike(binding.first, start, words, is_exact)
            alike.setdefault(key, []).append(binding)
        return [self._instance(rule, machine, key, tuple(bound)) for key, bound in alike.items()]

    def _bindings(self, rule: CompiledRule, past: CarriedState) -> Iterator[Binding]:
        """A rule's bindings, with their layers.

        Raises RulecError R0718 if there are too many, even of those that matter.
        """
        graph, nodes = self._graph, self._nodes
        cast = Cast(graph.objects, self._vocabulary, len(graph.states), graph.present)
        if not cast.has_many(types_of(rule)):
            return cast.bindings(rule)
        in_nodes = Cast(graph.objects, self._vocabulary, len(nodes.states), nodes.present)
        read, idle = self._letters.bits_of(rule), uncertain_machine(rule, None).idle
        bindings = doubtful_bindings(rule, in_nodes, read, idle, past.begun(rule.name))
        return (binding_of(own.objects, graph.present, len(graph.states)) for own in bindings)

    def _words(
        self, rule: CompiledRule, machine: UncertainMachine, binding: Binding
    ) -> tuple[tuple[_Word, ...], bool]:
        """Possible letters of all nodes per choice of constants, and whether these are exact."""
        supposed, is_exact = self._suppositions.of(rule, binding)
        nodes = Binding(binding.objects, *self._nodes.stretch(binding.first, binding.last))
        words: dict[_Word, None] = {}
        for values in supposed:
            possible = self._letters.word(rule, machine.classes, nodes, values)
            is_exact = is_exact and possible.exact
            words[possible.classes] = None
        if all(0 in word for word in words):
            for number, classes in enumerate(zip(*words, strict=True), nodes.first):
                if not any(classes):
                    raise self._letters.impossible(rule, binding.objects, number)
        return tuple(words), is_exact

    def _by_layer(self, letters: Sequence[int], binding: Binding) -> tuple[tuple[int, ...], ...]:
        return self._nodes.by_layer(letters, binding.first, binding.last)

    def _instance(
        self,
        rule: CompiledRule,
        machine: UncertainMachine,
        alike: _Alike,
        bound: tuple[Binding, ...],
    ) -> GraphInstance:
        words, start = alike.words, alike.start
        # For each node, the classes for each choice of constants
        symbols = list(zip(*words, strict=True))
        every = set(symbols)
        known = all(len(symbol) == 1 and not symbol[0] & (symbol[0] - 1) for symbol in every)
        if known and len(start.states) == 1 and not start.perhaps_settled:
            letters = self._by_layer([x.bit_length() - 1 for (x,) in symbols], bound[0])
            return GraphInstance(rule, bound, letters, min(start.states))
        order = tuple(sorted(every))
        key = rule.name, start, order
        if key not in self._machines:
            starts = (machine.monitor.number(*start.states),) * len(words)
            made = readings(machine.monitor, starts, order)
            if start.perhaps_settled:
                kept = [[True] * len(order) for _ in made.perhaps.outputs]
                made = replace(made, perhaps=replace(made.perhaps, outputs=kept))
            self._machines[key] = order, made
        place = {symbol: number for number, symbol in enumerate(order)}
        letters = self._by_layer([place[symbol] for symbol in symbols], bound[0])
        own = self._machines[key][1]
        # Violated before and violated just now cannot be distinguished.
        vague = start.perhaps_settled and rule.machine.rejecting_sink in start.states
        is_exact = own.exact and alike.exact and not vague
        return GraphInstance(rule, bound, letters, 0, replace(own, exact=is_exact))


def not_judged(
    graph: TraceGraph, rulebook: CompiledRulebook, past: CarriedState
) -> Iterator[RuleNotJudged]:
    """Rules that no path can be known to violate, because the graph lacks what they read."""
    possible = PossibleNodes(replace(graph, states=(), present={}), rulebook, [])
    for rule in rulebook.rules:
        if untold := possible.untold(rule, past):
            yield RuleNotJudged(rule.name, rule.strength, untold)


def readings(
    monitor: SetMonitor, starts: tuple[int, ...], symbols: Sequence[tuple[int, ...]]
) -> Readings:
    """The machines for words of ``symbols``, from these sets of states.

    A symbol has a bit set of classes, and a start a set of states, for each choice of constants.
    """
    anything = ()
    places: dict[tuple[int, ...], int] = {starts: 0}
    successors, surely, perhaps = [], [], []
    is_exact = True
    for sets in (waiting := [starts]):
        row, kept, not_lost = [], [], []
        for symbol in symbols:
            steps = [
                None if here == _NOBODY or not classes else monitor.step(here, classes)
                for here, classes in zip(sets, symbol, strict=bool(sets))
            ]
            known = [step for step in steps if step is not None]
            target = tuple([_NOBODY if step is None else step.states for step in steps])
            if target not in places and len(places) > MOST_SETS:
                is_exact, target = False, anything
            if target not in places:
                places[target] = len(places)
                waiting.append(target)
            row.append(places[target])
            # `sets` is empty if anything is possible. If facts exclude every choice it is not kept.
            kept.append(bool(known) and max(step.worst for step in known) == KEPT)
            best = min((step.best for step in known), default=VIOLATED)
            not_lost.append(sets == anything or best == KEPT)
        successors.append(row)
        surely.append(kept)
        perhaps.append(not_lost)
    return Readings(SetMachine(successors, surely), SetMachine(successors, perhaps), is_exact)


Item = TypeVar("Item")


class NodesInTurn:
    """The nodes of all layers in one sequence, as if they were the states of one trace."""

    def __init__(self, graph: TraceGraph) -> None:
        self._graph = graph
        self._begins = [0, *accumulate(map(len, graph.states))]

    @cached_property
    def states(self) -> tuple[State, ...]:
        """The states of all nodes."""
        return tuple(chain.from_iterable(self._graph.states))

    @cached_property
    def present(self) -> dict[str, tuple[int, int]]:
        """For each object that is not in all layers, the numbers of its first and last node."""
        return {item: self.stretch(*layers) for item, layers in self._graph.present.items()}

    def stretch(self, first: int, last: int) -> tuple[int, int]:
        """The numbers of the first and the last node of layers ``first`` to ``last``, inclusive."""
        return self._begins[first], self._begins[last + 1] - 1

    def layer_of(self, number: int) -> int:
        """The layer of a node."""
        return bisect_right(self._begins, number) - 1

    def by_layer(
        self, values: Sequence[Item], first: int, last: int
    ) -> tuple[tuple[Item, ...], ...]:
        """The nodes' ``values``, grouped by layer."""
        before = self._begins[first]
        bounds = [begin - before for begin in self._begins[first : last + 2]]
        return tuple([tuple(values[begin:end]) for begin, end in pairwise(bounds)])


HARD: tuple[Strength, ...] = ("hard",)
SOFT: tuple[Strength, ...] = ("soft",)


def instances(
    graph: TraceGraph,
    rulebook: CompiledRulebook,
    step_s: Fraction | None = None,
    strengths: Collection[Strength] = HARD,
    past: CarriedState = NO_PAST,
) -> list[GraphInstance]:
    """Bind rules of these strengths to a graph's objects.

    ``step_s`` is the graph's exact step if it is not a decimal, such as a third of a second.
    Bindings of a rule with the same letters in every node are one instance. Bindings settled in the
    ``past`` are left out, the others continue from their state; rules that cannot be judged,
    because the graph does not provide what they need, are left out too. Raises RulecError: R0502 to
    R0505 if the graph does not supply what the rules read, R0507 if one of these rules was compiled
    for another step, R0508 if a state contradicts a fact.
    """
    vocabulary = rulebook.vocabulary
    rules = [rule for rule in rulebook.rules if rule.strength in strengths]
    for rule in rules:
        check_step(rule, exact_step(graph.step_s) if step_s is None else step_s, "the graph")
    check_objects(graph.objects, vocabulary)
    places = [f"a cell of layer {layer}".format for layer in range(len(graph.states))]
    for states, where in zip(graph.states, places, strict=True):
        check_states(states, graph.objects, vocabulary, where)
    possible = PossibleNodes(with_implied_in_graph(graph, vocabulary), rulebook, places)
    possible.check_counting_axioms()
    return [own for rule in rules for own in possible.instances(rule, past)]


def violations(rules: Sequence[GraphInstance], nodes: Sequence[int]) -> tuple[Violation, ...]:
    """Violations on a path whose letters are known, with the layer of each bad prefix."""
    result = []
    for rule in rules:
        path = nodes[rule.first : rule.last + 1]
        word = [row[node] for row, node in zip(rule.letters, path, strict=True)]
        accepted, lost = run(rule.rule.machine, word, rule.start)
        if not accepted:
            layer = None if lost is None else rule.first + lost
            result += [
                Violation(rule.rule.name, rule.rule.strength, binding.objects, layer)
                for binding in rule.bindings
            ]
    return tuple(result)
