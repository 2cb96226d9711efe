"""Rules applied to paths through a navigation graph, and the partition that rules need."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import Diagnostic, RulecError, SourceLocation, named
from rulec.diagnostics.argument_kinds import checked_kinds
from rulec.diagnostics.diagnostic import at
from rulec.logic.free_names import names_in
from rulec.monitoring.assumptions import Assumptions
from rulec.monitoring.constant_values import agreed_value, display
from rulec.monitoring.implied_values import with_words_in_graph
from rulec.monitoring.monitoring_messages import UNDECLARED_NAME, UNFITTING_VALUE
from rulec.monitoring.state_validation import check_objects, check_state
from rulec.monitoring.told_names import with_defaulted
from rulec.monitoring.verdict import NO_PAST, CarriedState
from rulec.partition import NavigationGraph, PartitionName
from rulec.planning.planning_messages import TWO_PARTITIONS, UNFITTING_PAST
from rulec.planning.product.graph_instance import GraphInstance
from rulec.planning.product.possible_instances import instances
from rulec.rulebook.rulebook_model import Rulebook, Strength
from rulec.scenario import Obstacle, Scenario
from rulec.trace import State, Trace, TraceGraph, Value
from rulec.trace.trace_messages import UNKNOWN_OBJECT
from rulec.trace.vocabulary_projection import project_graph
from rulec.vocabulary import Vocabulary

if TYPE_CHECKING:
    from rulec.cell_words import CellWords
    from rulec.planning.trace_history import Before


RELATIONS_OF: dict[PartitionName, tuple[str, ...]] = {
    "paper": ("position",),
    "fine": ("station", "lateral"),
}
"""The relations that only one partition supplies."""

SUPPLIED = frozenset({"surface", *RELATIONS_OF["paper"], *RELATIONS_OF["fine"]})
"""The names that partitions supply."""


@checked_kinds
def partition_for(
    rules: Rulebook | CompiledRulebook, partition: PartitionName | None
) -> PartitionName:
    """The given partition, or the one that the rules need.

    Raises RulecError: R0405 if the rules need another one, or two.
    """
    read = {name for rule in rules.rules for name in names_in(rule.formula)}
    needed = {
        name: named([relation for relation in relations if relation in read])
        for name, relations in RELATIONS_OF.items()
        if read.intersection(relations)
    }
    if len(needed) > 1:
        raise TWO_PARTITIONS.error(
            _place_of(RELATIONS_OF["paper"], rules),
            f"rulebook `{rules.name}` reads {needed['paper']} and {needed['fine']}, "
            "which no one partition supplies",
            help="use `station` and `lateral` only: they distinguish all that `position` does",
        )
    for name, relations in needed.items():
        if partition not in (None, name):
            raise TWO_PARTITIONS.error(
                _place_of(RELATIONS_OF[name], rules),
                f"rulebook `{rules.name}` reads {relations}, which the partition "
                f"`{partition}` does not supply",
                help=f"use the partition `{name}`, or leave the choice to the rulebook",
            )
        return name
    declares_fine = not rules.vocabulary.declarations.keys().isdisjoint(RELATIONS_OF["fine"])
    return partition or ("fine" if declares_fine else "paper")


def _place_of(
    relations: Collection[str], rules: Rulebook | CompiledRulebook
) -> SourceLocation | None:
    """The place of the first rule that reads one of these, or else of the compiled rulebook."""
    wanted = set(relations)
    reading = (rule for rule in rules.rules if not wanted.isdisjoint(names_in(rule.formula)))
    name = next(reading).name
    if isinstance(rules, CompiledRulebook):
        return rules.place_of(name) or SourceLocation(rules.name)
    return at(next(rule.span for rule in rules.rules if rule.name == name))


NOTHING_ASSUMED = Assumptions()


@dataclass(frozen=True, slots=True)
class SceneReading:
    """The values assumed for what a scenario does not provide.

    The assumed values replace unknown and missing ones. Other missing values have their defaults
    or, with ``told_only``, are unknown.
    """

    assumptions: Assumptions = NOTHING_ASSUMED
    told_only: bool = False

    def after(self, constants: Mapping[str, Value]) -> SceneReading:
        """The same after a past that has given these constants."""
        values = {**constants, **self.assumptions.values}
        return replace(self, assumptions=replace(self.assumptions, values=values))

    def of(self, graph: TraceGraph) -> TraceGraph:
        """The graph with the assumed values."""
        if not self.assumptions and not self.told_only:
            return graph
        told = graph.told
        if told is None:
            said = (name for layer in graph.states for state in layer for name in state)
            told = SUPPLIED.union(said)
        traces = [
            self.assumptions.applied(
                Trace("", graph.step_s, graph.objects, layer, ends="complete", told=told)
            )
            for layer in graph.states
        ]
        # With no layers the assumed names would be missing.
        told = told.union(self.assumptions.values)
        told_only = self.told_only or graph.told is not None
        told_only = told_only and not self.assumptions.defaults
        states = tuple([trace.states for trace in traces])
        return replace(graph, states=states, told=told if told_only else None)


def in_rule_words(
    graph: NavigationGraph,
    traces: TraceGraph,
    obstacles: Mapping[str, Obstacle],
    vocabulary: Vocabulary,
    reading: SceneReading,
    *,
    words: CellWords | None = None,
) -> TraceGraph:
    """Traces of paths through a graph, about these obstacles, in the terms of a vocabulary.

    With ``words`` these are the only values in its cells.
    """
    recorded = None
    if graph.scenario.account is not None:
        recorded = {name: (own.type, *own.broader) for name, own in obstacles.items()}
    if words is not None:
        recorded = dict(words.types)
        always = 0, len(graph.layers) - 1
        traces = replace(
            traces,
            states=words.states,
            objects={name: own[0] for name, own in recorded.items()},
            present={name: span for name, span in words.present.items() if span != always},
            told=words.told,
        )
    found = reading.of(project_graph(traces, vocabulary, SUPPLIED, recorded))
    if words is not None and found.told is None:
        found = replace(found, told=with_defaulted(words.told, vocabulary))
    return with_words_in_graph(found, vocabulary)


def past_for(
    graph: NavigationGraph,
    paths: TraceGraph,
    rules: CompiledRulebook,
    strengths: Collection[Strength],
    after: Before | None,
) -> CarriedState:
    """The state in which the past leaves rules of these strengths. Raises RulecError."""
    if after is None:
        return NO_PAST
    from rulec.planning.trace_history import past_of  # imported late: 30 ms

    return past_of(paths, after, rules, graph.step, strengths)


def check_constants(paths: TraceGraph, past: CarriedState) -> None:
    """Raises RulecError R0511 if a scenario's constants differ from those of its past."""
    state = paths.states[0][paths.start]
    for name, value in past.constants.items():
        own = state.get(name)
        if own is not None and agreed_value(own, value) is None:
            raise UNFITTING_PAST.error(
                None,
                f"the past says that `{name}` is {display(value)}, and the scenario, or what is "
                f"assumed, that it is {display(own)}",
                help=f"the vocabulary says `constant {name}`; give the past of this scenario",
            )


def bind_rules(
    graph: NavigationGraph,
    paths: TraceGraph,
    rules: CompiledRulebook,
    strengths: Collection[Strength],
    past: CarriedState,
) -> list[GraphInstance]:
    """Bind rules of these strengths to the objects of a graph.

    Raises RulecError as ``instances`` does, with the scenario as the place.
    """
    try:
        return instances(paths, rules, graph.step, strengths, past)
    except RulecError as error:
        if any(diagnostic.code in _OF_STATES for diagnostic in error.diagnostics):
            _check_said(graph.scenario, paths.objects, rules.vocabulary)
        place = SourceLocation(graph.scenario.name)
        raise RulecError(
            [replace(diagnostic, place=place) for diagnostic in error.diagnostics]
        ) from None


_OF_STATES = {code.code for code in (UNDECLARED_NAME, UNFITTING_VALUE, UNKNOWN_OBJECT)}
"""Codes of mistakes in a state that the scenario's file may have caused."""


def _check_said(scenario: Scenario, objects: Mapping[str, str], vocabulary: Vocabulary) -> None:
    """Raise RulecError R0502, R0503 or R0505 for wrong values, at their places in the file."""
    obstacles = {obstacle.id: obstacle for obstacle in scenario.obstacles}
    wrong: list[Diagnostic] = []
    odd = set()
    for (name, about), place in scenario.places.items():
        state: State = {}
        own: dict[str, str] = {}
        if about:
            own[about] = objects.get(about, obstacles[about].type)
            state = {name: {about: obstacles[about].signals[name]}} if name else {}
        else:
            state = {name: scenario.signals[name]}
        diagnostics = _wrong_in(state, own, vocabulary, place)
        if diagnostics and not name:
            odd.add(about)
        # If an obstacle's type is unknown, report only that.
        if not (name and about in odd):
            wrong += diagnostics
    if wrong:
        raise RulecError(wrong)


def _wrong_in(
    state: State, objects: Mapping[str, str], vocabulary: Vocabulary, place: SourceLocation
) -> Sequence[Diagnostic]:
    try:
        check_objects(objects, vocabulary, place)
        check_state(state, objects, vocabulary, "the scenario", place)
    except RulecError as error:
        names = [name for name in state if name in vocabulary.declarations]
        if objects or not any(vocabulary.declarations[name].parameters for name in names):
            return error.diagnostics
        way_out = f"give it for an obstacle: `signals = {{ {names[0]} = … }}`"
        return [replace(diagnostic, help=way_out) for diagnostic in error.diagnostics]
    return ()
