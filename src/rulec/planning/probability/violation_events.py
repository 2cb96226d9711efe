"""The events in which a path through a graph violates a rule.

Each obstacle follows one of its predictions, independently of the others; an event is that several
obstacles follow certain predictions. Worlds (a prediction for every obstacle) are not enumerated.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Iterator, Mapping
from fractions import Fraction
from functools import cache
from itertools import product
from math import prod

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.automata.outcome_machine import KEPT
from rulec.logic.formula import Count, Formula
from rulec.logic.free_names import names_in, variables_of
from rulec.logic.kleene import holds
from rulec.monitoring.bindings import Binding, Cast, types_of
from rulec.monitoring.implied_values import with_implied_in_graph
from rulec.monitoring.state_view import StateView
from rulec.monitoring.uncertainty.lazy_bindings import doubtful_bindings
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.monitoring.uncertainty.uncertain_machine import uncertain_machine
from rulec.monitoring.uncertainty.uncertain_verdict import UncertainRun
from rulec.partition.prediction_worlds import PredictedPath
from rulec.planning.maneuvers import Maneuvers
from rulec.planning.planning_messages import MOST_WORLDS
from rulec.planning.product.possible_instances import HARD, SOFT
from rulec.planning.rule_instances import in_rule_words, past_for
from rulec.rulebook.rules.axiom_instances import counts
from rulec.trace import Trace, TraceGraph
from rulec.vocabulary import Vocabulary
from rulec.witnesses.object_universe import counts_in

Event = frozenset[tuple[str, int]]
"""Obstacles with the predictions that have to come true; the empty event always happens."""

Weights = Mapping[str, Mapping[int, Fraction]]
"""For each obstacle its predictions and their probabilities, which add up to 1."""


def none_of(events: Collection[Event], weights: Weights) -> Fraction:
    """The exact probability that no event happens.

    Events that share no obstacle are independent. For the others one obstacle after the other is
    fixed, which takes time exponential only in how much the events overlap.
    """

    @cache
    def none(events: frozenset[Event]) -> Fraction:
        if frozenset() in events:
            return Fraction(0)
        return prod(map(none_entangled, _independent(events)), start=Fraction(1))

    def none_entangled(events: frozenset[Event]) -> Fraction:
        counted = Counter(obstacle for event in events for obstacle, _ in event)
        obstacle = min(counted, key=lambda candidate: (-counted[candidate], candidate))
        result = Fraction(0)
        for number, weight in weights[obstacle].items():
            left = frozenset(
                event - {(obstacle, number)}
                for event in events
                if all(name != obstacle or what == number for name, what in event)
            )
            result += weight * none(left)
        return result

    return none(frozenset(events))


def _independent(events: frozenset[Event]) -> Iterator[frozenset[Event]]:
    left = set(events)
    while left:
        group = {left.pop()}
        about = {obstacle for event in group for obstacle, _ in event}
        while joining := {event for event in left if any(name in about for name, _ in event)}:
            left -= joining
            group |= joining
            about |= {obstacle for event in joining for obstacle, _ in event}
        yield frozenset(group)


Lost = dict[tuple[str, ...], set[Event]]
"""For the objects (of the scenario) that a rule is about, the events in which it is violated."""


class ViolationEvents:
    """Events in which rules are violated on one path.

    If not everything is known: events in which they are not surely kept, or with ``perhaps`` those
    in which they are surely violated.
    """

    def __init__(self, maneuvers: Maneuvers, path: PredictedPath, *, perhaps: bool = False) -> None:
        self._book = maneuvers.rules
        self._unknown = frozenset(maneuvers.unknown)
        self._perhaps = perhaps
        self._path = path
        obstacles = {name: predicted.obstacle for name, predicted in path.predicted.items()}
        vocabulary, reading = maneuvers.rules.vocabulary, maneuvers.reading
        words = in_rule_words(maneuvers.graph, path.traces, obstacles, vocabulary, reading)
        self._words = with_implied_in_graph(words, vocabulary)
        self._states = [state for (state,) in self._words.states]
        self._past = past_for(
            maneuvers.graph, maneuvers.paths, maneuvers.rules, (*HARD, *SOFT), maneuvers.after
        )
        self.in_doubt = bool(maneuvers.unknown or self._past.doubtful_rules)
        self._everybody = self._run(self._words.objects)

    @property
    def hits(self) -> set[Event]:
        """The events in which an obstacle hits ego."""
        return {self._event([name]) for name in self._path.hit}

    def events(self, rule: CompiledRule) -> Lost | None:
        """Events in which a rule is violated; None if there are too many worlds."""
        if counts(rule.formula):
            return self._counting(rule)
        lost: Lost = {}
        for binding in self._bindings(rule):
            if not self._keeps(rule, binding, self._everybody):
                names = binding.objects.values()
                lost.setdefault(self._of(names), set()).add(self._event(names))
        return lost

    def _counting(self, rule: CompiledRule) -> Lost | None:
        """Events for a rule that counts further objects.

        Worlds that differ only in ways that do not matter to the rule are examined once.
        """
        in_doubt = self._is_in_doubt(rule)
        alike = PredictionClasses(
            rule, self._path, self._words, self._book.vocabulary, told_apart=in_doubt
        )
        matters = [name for name in self._words.objects if self._concerns(rule, name)]
        hitting = [name for name in matters if name in self._path.hit]
        left = MOST_WORLDS
        lost: Lost = {}
        for binding in self._bindings(rule):
            names = binding.objects.values()
            event = self._event(names)
            about = {own.of: own.number for own in map(self._path.predicted.__getitem__, names)}
            events = {event | self._event([name]) for name in hitting if self._is_in(about, name)}
            if event not in events:
                others = {
                    of: alike.groups(of, binding)
                    for of in {self._path.predicted[name].of for name in matters} - about.keys()
                }
                left -= prod(map(len, others.values()))
                if left < 0:
                    return None
                for chosen in product(*others.values()):
                    world = about | {of: group[0] for of, group in zip(others, chosen, strict=True)}
                    run = self._run(
                        {
                            name: kind
                            for name, kind in self._words.objects.items()
                            if self._is_in(world, name)
                        }
                    )
                    if not self._keeps(rule, binding, run):
                        open_ones = [
                            [(of, number) for number in group]
                            for of, group in zip(others, chosen, strict=True)
                            if len(others[of]) > 1
                        ]
                        events |= {event.union(combination) for combination in product(*open_ones)}
            if events:
                lost.setdefault(self._of(names), set()).update(events)
        return lost

    def _concerns(self, rule: CompiledRule, name: str) -> bool:
        kind = self._words.objects[name]
        types = {*(variable.type for variable in rule.variables), *counted_types(rule.formula)}
        return any(self._book.vocabulary.is_subtype(kind, type_) for type_ in types)

    def _is_in(self, world: Mapping[str, int], name: str) -> bool:
        predicted = self._path.predicted[name]
        return world.get(predicted.of, predicted.number) == predicted.number

    def _event(self, names: Collection[str]) -> Event:
        """The event that these predictions come true; certain predictions are left out."""
        return frozenset(
            (predicted.of, predicted.number)
            for predicted in map(self._path.predicted.__getitem__, names)
            if len(self._path.weights[predicted.of]) > 1
        )

    def _of(self, names: Iterable[str]) -> tuple[str, ...]:
        return tuple([self._path.predicted[name].of for name in names])

    def _run(self, objects: Mapping[str, str]) -> UncertainRun:
        words = self._words
        there = {name: span for name, span in words.present.items() if name in objects}
        trace = Trace("", words.step_s, objects, tuple(self._states), there, told=words.told)
        trace = spelled_out(trace, self._book.vocabulary)
        return UncertainRun(trace, self._book, where="the maneuver's cell of layer {}".format)

    def _is_in_doubt(self, rule: CompiledRule) -> bool:
        unknown = not self._unknown.isdisjoint(names_in(rule.formula))
        return unknown or rule.name in self._past.doubtful_rules

    def _bindings(self, rule: CompiledRule) -> Iterator[Binding]:
        """Bindings whose objects' predictions can come true together.

        If there are many, only those that may be violated, unless that depends on more than states.
        """
        words = self._words
        cast = Cast(words.objects, self._book.vocabulary, len(self._states), words.present)
        bindings = cast.bindings(rule)
        if cast.has_many(types_of(rule)) and self._is_told_by_states(rule):
            idle = uncertain_machine(rule, None).idle
            bindings = doubtful_bindings(rule, cast, self._everybody.bits_of(rule), idle)
        for binding in bindings:
            who = [self._path.predicted[name] for name in binding.objects.values()]
            chosen = {(predicted.of, predicted.number) for predicted in who}
            if len({of for of, _ in chosen}) == len(chosen):
                yield binding

    def _is_told_by_states(self, rule: CompiledRule) -> bool:
        """Whether states alone decide if a rule is violated: no hits, counts or past matter."""
        is_hit = any(self._concerns(rule, name) for name in self._path.hit)
        return not (is_hit or counts(rule.formula) or self._past.begun(rule.name))

    def _keeps(self, rule: CompiledRule, binding: Binding, run: UncertainRun) -> bool:
        names = binding.objects.values()
        about = (rule.name, self._of(names))
        goes_on = binding.first == 0
        if goes_on and about in self._past.settled:
            return True
        if not self._path.hit.isdisjoint(names):
            return False
        starts = self._past.starts(about) if goes_on else frozenset({0})
        if self._perhaps and goes_on and about in self._past.perhaps_settled:
            return True
        best, worst = run.outcomes(rule, binding, starts)
        return (best if self._perhaps else worst) == KEPT


class PredictionClasses:
    """Groups an obstacle's predictions that a counting rule cannot distinguish on one path.

    With ``told_apart``, used if not everything is known, every prediction is a group of its own.
    """

    def __init__(
        self,
        rule: CompiledRule,
        path: PredictedPath,
        words: TraceGraph,
        vocabulary: Vocabulary,
        *,
        told_apart: bool = False,
    ) -> None:
        self._told_apart = told_apart
        self._terms = list(dict.fromkeys(counts_in(rule.formula)))
        self._path = path
        self._moments = [StateView(state, words.objects, vocabulary) for (state,) in words.states]
        self._words = words
        self._truth = cache(self._is_counted)

    def groups(self, obstacle: str, binding: Binding) -> list[list[int]]:
        """An obstacle's predictions that do not hit ego, in groups.

        Those of a group count alike in every state, for a rule that is about other objects.
        """
        result: dict[object, list[int]] = {}
        for number in self._path.weights[obstacle]:
            names = [
                name
                for name, predicted in self._path.predicted.items()
                if (predicted.of, predicted.number) == (obstacle, number)
            ]
            if self._path.hit.isdisjoint(names):
                result.setdefault(self._counted(names, number, binding), []).append(number)
        return list(result.values())

    def _counted(self, names: list[str], number: int, binding: Binding) -> object:
        if self._told_apart or any(counts(term.body) for term in self._terms):
            # How nested counts count it depends on other objects
            return number
        layers = range(binding.first, binding.last + 1)
        result: list[int] = []
        for term in self._terms:
            free = dict.fromkeys(variables_of(term.body))
            bound = tuple([(own, binding.objects[own]) for own in free if own != term.variable])
            result += [
                sum([self._truth(term, layer, name, bound) for name in names]) for layer in layers
            ]
        return tuple(result)

    def _is_counted(
        self, term: Count, layer: int, name: str, bound: tuple[tuple[str, str], ...]
    ) -> bool:
        """Whether a count counts one object in a layer, with its other variables ``bound``."""
        moment = self._moments[layer]
        first, last = self._words.present.get(name, (0, len(self._moments) - 1))
        if name not in moment.objects or not first <= layer <= last:
            return False
        if not moment.vocabulary.is_subtype(moment.objects[name], term.type):
            return False
        # Where it may be unknown, all predictions are told apart instead
        return holds(term.body, {**dict(bound), term.variable: name}, moment) is True


def counted_types(formula: Formula) -> Iterator[str]:
    """The types of the objects that a formula counts."""
    for term in counts_in(formula):
        yield term.type
        yield from counted_types(term.body)
