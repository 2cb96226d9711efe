"""Synthesised states as a trace, with names for all objects."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.trace import Trace
from rulec.witnesses.counted_objects import counted_objects_of_types, fewest_counted_objects
from rulec.witnesses.object_universe import EXTRA, ObjectUniverse
from rulec.witnesses.state_synthesis import JointState, Subject, Value, default_value, subjects_of
from rulec.witnesses.undecided import UndecidedError


def place_objects(
    states: Sequence[JointState], universe: ObjectUniverse, stem: Callable[[str], str]
) -> tuple[dict[str, str], list[dict[Subject, Value]]]:
    """Name the additional objects that all states' counts need, with values.

    Args:
        states: synthesised states.
        universe: the objects that are there already.
        stem: of a type, what the names of such objects begin with.

    Returns:
        The types of the further objects by name, and the values of each state.

    Raises:
        UndecidedError: if the objects counted in one state are in the way in another.
    """
    types = _types([fewest_counted_objects(state, universe) or () for state in states])
    names = _names([stem(kind) for kind in types], universe.objects)
    placed: list[dict[Subject, Value]] = []
    for state in states:
        further = counted_objects_of_types(state, universe, types)
        if further is None:
            raise UndecidedError("objects to be counted in one state are in the way in another")
        values = dict(state.values)
        for name, companion in zip(names, further, strict=True):
            for (declaration, items), value in companion.values.items():
                own = tuple(name if item == EXTRA else item for item in items)
                values[declaration, own] = value
        placed.append(values)
    return dict(zip(names, types, strict=True)), placed


def synthesize_trace(
    states: Sequence[JointState],
    universe: ObjectUniverse,
    step_s: Fraction,
    shows: Callable[[Trace], bool],
) -> Trace:
    """Synthesise a trace through these states for which ``shows`` holds.

    Raises UndecidedError if the objects that are there to be counted are in the way.
    """
    objects, placed = place_objects(states, universe, str)
    all_objects = {**universe.objects, **objects}
    types = list(objects.values())
    for fill in _fills(universe, types):
        written = tuple(_written(values, universe, all_objects, fill) for values in placed)
        trace = Trace("witness", float(step_s), all_objects, written)
        if _does_show(trace, shows, certain=not types):
            return trace
    if types:
        raise UndecidedError("further objects, there to be counted, are subject to the rule, too")
    raise AssertionError(f"a trace does not do what it is to show: {trace.states}")


def _does_show(trace: Trace, shows: Callable[[Trace], bool], *, certain: bool) -> bool:
    try:
        return shows(trace)
    except RulecError:
        # Objects that are there to be counted may be what facts of several objects rule out.
        if certain:
            raise
        return False


def _types(groups: Iterable[Sequence[Any]]) -> list[str]:
    """Types of companions, each as often as any state needs it."""
    most: Counter[str] = Counter()
    for group in groups:
        most |= Counter(companion.type for companion in group)
    return sorted(most.elements())


def _names(stems: Sequence[str], taken: Mapping[str, str]) -> list[str]:
    names: list[str] = []
    for stem in stems:
        number = 1
        while (name := f"{stem}{number}") in taken or name in names:
            number += 1
        names.append(name)
    return names


def _fills(universe: ObjectUniverse, types: Sequence[str]) -> Iterable[Mapping[str, Value]]:
    """Values for unread properties of additional objects, defaults first."""
    yield {}
    if not types:
        return
    for name, declaration in universe.vocabulary.declarations.items():
        if declaration.parameters:
            for value in getattr(declaration, "values", ()):
                yield {name: value}


def _written(
    values: Mapping[Subject, Value],
    universe: ObjectUniverse,
    all_objects: Mapping[str, str],
    fill: Mapping[str, Value],
) -> dict[str, Any]:
    """State in a trace's form, without values that equal their defaults."""
    state: dict[str, Any] = {}
    for (name, items), declaration in subjects_of(universe.vocabulary, all_objects):
        value = values.get((name, items))
        if value is None and name in universe.unsaid:
            continue
        if value is None:
            value = fill.get(name, default_value(declaration))
        if value == declaration.default and type(value) is type(declaration.default):
            continue
        inside = state
        *outer, last = (name, *items)
        for key in outer:
            inside = inside.setdefault(key, {})
        inside[last] = value
    return state


def single_rule_rulebook(
    rulebook: CompiledRulebook, rule: CompiledRule, universe: ObjectUniverse
) -> CompiledRulebook:
    """Rulebook of one rule, in the vocabulary of a universe."""
    return replace(rulebook, vocabulary=universe.vocabulary, rules=(rule,))
