"""A word of symbols as a trace, with names for all objects."""

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
from rulec.witnesses.state_synthesis import JointState, Subject, Value, default_value, keys_of
from rulec.witnesses.undecided import UndecidedError


def synthesize_trace(
    situations: Sequence[JointState],
    scene: ObjectUniverse,
    step_s: Fraction,
    shows: Callable[[Trace], bool],
) -> Trace:
    """A trace through these situations that shows what it is to show.

    Raises UndecidedError if the objects that are there to be counted are in the way.
    """
    types = _types([fewest_counted_objects(one, scene) or () for one in situations])
    names = _names(types, scene.objects)
    everyone = {**scene.objects, **dict(zip(names, types, strict=True))}
    states: list[dict[Subject, Value]] = []
    for one in situations:
        company = counted_objects_of_types(one, scene, types)
        if company is None:
            raise UndecidedError("objects to be counted in one state are in the way in another")
        values = dict(one.values)
        for name, companion in zip(names, company, strict=True):
            for (what, items), value in companion.values.items():
                values[what, tuple(name if item == EXTRA else item for item in items)] = value
        states.append(values)
    for fill in _fills(scene, types):
        written = tuple(_written(values, scene, everyone, fill) for values in states)
        trace = Trace("witness", float(step_s), everyone, written)
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


def _types(companies: Iterable[Sequence[Any]]) -> list[str]:
    """The types of the companions that are there in all states, so that each has enough."""
    most: Counter[str] = Counter()
    for company in companies:
        most |= Counter(one.type for one in company)
    return sorted(most.elements())


def _names(types: Sequence[str], taken: Mapping[str, str]) -> list[str]:
    names: list[str] = []
    for kind in types:
        number = 1
        while (name := f"{kind}{number}") in taken or name in names:
            number += 1
        names.append(name)
    return names


def _fills(scene: ObjectUniverse, types: Sequence[str]) -> Iterable[Mapping[str, Value]]:
    """Values of what nobody asks about further objects: the usual ones, then others of each."""
    yield {}
    if not types:
        return
    for name, declaration in scene.vocabulary.declarations.items():
        if declaration.parameters:
            for value in getattr(declaration, "values", ()):
                yield {name: value}


def _written(
    values: Mapping[Subject, Value],
    scene: ObjectUniverse,
    everyone: Mapping[str, str],
    fill: Mapping[str, Value],
) -> dict[str, Any]:
    """A state as a trace has it: what is not the default, and what has none."""
    state: dict[str, Any] = {}
    for (name, items), declaration in keys_of(scene.vocabulary, everyone):
        value = values.get((name, items))
        if value is None and name in scene.unsaid:
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
    rulebook: CompiledRulebook, rule: CompiledRule, scene: ObjectUniverse
) -> CompiledRulebook:
    """A rulebook of one rule, for traces in the words of a scene."""
    return replace(rulebook, vocabulary=scene.vocabulary, rules=(rule,))
