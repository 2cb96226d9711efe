"""What partition and scenario supply, in the words of a rulebook's vocabulary."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from typing import TYPE_CHECKING

from rulec.automata.compiled import CompiledRulebook
from rulec.runtime.terms import names_in
from rulec.trace import State, TraceGraph, Value
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary

if TYPE_CHECKING:
    from rulec.partition import NavigationGraph, PartitionName

RELATIONS_OF: dict[PartitionName, tuple[str, ...]] = {
    "paper": ("position",),
    "fine": ("station", "lateral"),
}
"""The relations that only one partition supplies."""

SUPPLIED = {"surface", *RELATIONS_OF["paper"], *RELATIONS_OF["fine"]}
"""All that partitions supply."""

RECORDED_UNIT = "km/h"
"""The unit of the quantities that recorded scenes supply."""


def in_terms_of(vocabulary: Vocabulary, graph: NavigationGraph) -> TraceGraph:
    """The graph's paths as traces, without what is supplied and the vocabulary has no word for.

    The author of a rulebook has not written these names, unlike those in a file of traces. The same
    goes for the signals of a recorded scene, and its objects are of the most specific type that the
    vocabulary knows.
    """
    traces = graph.trace_graph()
    if not vocabulary.types:
        traces = replace(traces, objects={}, present={})
    recorded = graph.scenario.account is not None
    if recorded:
        objects = _known_objects(vocabulary, graph)
        present = {name: there for name, there in traces.present.items() if name in objects}
        traces = replace(traces, objects=objects, present=present)
    return replace(
        traces,
        states=tuple(
            tuple(_state(vocabulary, traces.objects, state, recorded) for state in layer)
            for layer in traces.states
        ),
    )


def assumed(rules: CompiledRulebook, traces: TraceGraph) -> tuple[str, ...]:
    """What the rules read and nobody supplies, so that the vocabulary's default stands for it."""
    supplied = {name for layer in traces.states for state in layer for name in state}
    read = {name for rule in rules.rules for name in names_in(rule.formula)}
    return tuple(
        name
        for name in rules.vocabulary.declarations
        if name in read and name not in supplied | SUPPLIED
    )


def _known_objects(vocabulary: Vocabulary, graph: NavigationGraph) -> dict[str, str]:
    """Object -> its type; without those that the vocabulary cannot speak of."""
    found: dict[str, str] = {}
    for name, obstacle in graph.objects.items():
        words = (word for word in (obstacle.type, *obstacle.broader) if word in vocabulary.types)
        known = next(words, None)
        if known is not None:
            found[name] = known
    return found


def _state(
    vocabulary: Vocabulary, objects: Mapping[str, str], state: State, recorded: bool
) -> State:
    kept: dict[str, Value | Mapping[str, Value]] = {}
    for name, value in state.items():
        declaration = vocabulary.declarations.get(name)
        if name in SUPPLIED:
            if declaration is None:
                continue
        elif recorded and not _fits(value, declaration):
            continue
        if (
            isinstance(value, Mapping)
            and declaration is not None
            and (recorded or name in SUPPLIED)
        ):
            value = _about(value, declaration, objects, vocabulary, recorded)
        kept[name] = value
    return kept


def _about(
    value: Mapping[str, Value],
    declaration: Declaration,
    objects: Mapping[str, str],
    vocabulary: Vocabulary,
    recorded: bool,
) -> Mapping[str, Value]:
    """A relation without the objects that it is not about."""
    kind = declaration.parameters[0] if declaration.parameters else None
    return {
        item: inner
        for item, inner in value.items()
        if (objects.get(item) not in vocabulary.types and not recorded)
        or kind is None
        or (item in objects and vocabulary.is_subtype(objects[item], kind))
    }


def _fits(value: Value | Mapping[str, Value], declaration: Declaration | None) -> bool:
    """Could this be what the vocabulary means by the name?"""
    if declaration is None or isinstance(value, Mapping) != bool(declaration.parameters):
        return False
    values = value.values() if isinstance(value, Mapping) else (value,)
    match declaration:
        case Signal():
            return all(isinstance(one, bool) for one in values)
        case Enumeration():
            return all(one in declaration.values for one in values)
        case Quantity():
            plain = all(isinstance(one, float) for one in values)
            return plain and declaration.unit == RECORDED_UNIT
