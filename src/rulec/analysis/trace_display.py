"""Traces for reports: tables and literals of the values that rules read."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass
from typing import Any

from rulec.analysis.believable_states import declarations_read
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.diagnostics import named
from rulec.logic.formula import Atom
from rulec.monitoring.state_view import value_in
from rulec.trace import State, Trace, Value
from rulec.vocabulary import Quantity, Vocabulary
from rulec.witnesses.state_synthesis import subjects_of, value_literal


@dataclass(frozen=True, slots=True)
class SignalRow:
    """The values of one subject by column, with its title and unit.

    ``unit`` is empty if there is none. ``is_default``: all values are the default.
    """

    title: str
    unit: str
    values: tuple[Value | None, ...]
    is_default: bool = False


@dataclass(frozen=True, slots=True)
class TraceTable:
    """A table of a trace; a column is a run of equal states, given by its first and last state."""

    columns: tuple[tuple[int, int], ...]
    rows: tuple[SignalRow, ...]


def trace_table(
    trace: Trace, names: Set[str], vocabulary: Vocabulary, types: Mapping[str, str] | None = None
) -> TraceTable:
    """The table of a trace's values for these declarations and all its objects.

    Preceded by the ``types`` of some objects.
    """
    starts = [
        number
        for number, state in enumerate(trace.states)
        if number == 0 or state != trace.states[number - 1]
    ]
    ends = [*(start - 1 for start in starts[1:]), len(trace.states) - 1]
    rows = [
        SignalRow(f"type of {name}", "", (kind,) * len(starts))
        for name, kind in (types or {}).items()
    ]
    for (name, items), declaration in subjects_of(vocabulary, trace.objects, names):
        if len(set(items)) == len(items):
            values: tuple[Any, ...] = tuple(
                value_in(trace.states[n], name, items, declaration) for n in starts
            )
            unit = declaration.unit if isinstance(declaration, Quantity) else ""
            is_default = all(value == declaration.default for value in values)
            rows.append(SignalRow(str(Atom(name, items)), unit, values, is_default))
    return TraceTable(tuple(zip(starts, ends, strict=True)), tuple(rows))


def trace_note(title: str, trace: Trace, rules: Sequence[AnalyzedRule]) -> tuple[str, ...]:
    """A note with the trace as a literal in the words of these rules.

    ``{ behind(v); beside(v) and fog }``: omitted words have their defaults. Objects for which the
    rules have no variable come first, as in an example.
    """
    names = frozenset(name for analyzed in rules for name in declarations_read(analyzed.rule))
    vocabulary = rules[0].rulebook.vocabulary
    states = "; ".join(state_literals(trace, names, vocabulary))
    own = special_types(trace, [analyzed.rule for analyzed in rules])
    special = [f"{name}: {kind}" for name, kind in own.items()]
    variables = {variable.name for each in rules for variable in each.rule.variables}
    others = [f"{name}: {kind}" for name, kind in trace.objects.items() if name not in variables]
    objects = f"({', '.join(others)}) " if others else ""
    return (f"{title}{', for ' + named(special) if special else ''}: {objects}{{ {states} }}",)


def special_types(trace: Trace, rules: Iterable[CompiledRule]) -> dict[str, str]:
    """The types of those of the rules' objects that are of a type that no rule declares."""
    variables = [variable for rule in rules for variable in rule.variables]
    names = {variable.name for variable in variables}
    types = {variable.type for variable in variables}
    return {
        name: kind for name, kind in trace.objects.items() if name in names and kind not in types
    }


def state_literals(trace: Trace, names: Set[str], vocabulary: Vocabulary) -> list[str]:
    """Each state of a trace as in an example; omitted words have their defaults."""
    return [_state(state, trace, names, vocabulary) for state in trace.states]


def _state(state: State, trace: Trace, names: Set[str], vocabulary: Vocabulary) -> str:
    literals = []
    for (name, items), declaration in subjects_of(vocabulary, trace.objects, names):
        value = value_in(state, name, items, declaration)
        if value is None or value == declaration.default:
            continue
        if len(set(items)) < len(items):
            continue
        literals.append(value_literal((name, items), value, declaration))
    return " and ".join(literals) or "true"
