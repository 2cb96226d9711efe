"""A trace as a ribbon: values in rows over time, and violations."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.logic.free_names import names_in
from rulec.monitoring.state_view import value_in
from rulec.monitoring.verdict import Verdict, Violation
from rulec.report.verdicts.violation_table import shown
from rulec.trace import State, Trace, Value
from rulec.vocabulary import Enumeration, Quantity, Vocabulary


@dataclass(frozen=True, slots=True)
class ValueRun:
    """A run of states, ``first`` to ``last`` included, with a constant value.

    ``value`` is None where nothing is said, or who it is about is not there.
    """

    first: int
    last: int
    value: Value | None


@dataclass(frozen=True, slots=True)
class RibbonRow:
    """One thing that rules read, such as ``position(v1)``, over a whole trace.

    ``values`` are those that there can be, in the vocabulary's order; none for a quantity.
    """

    title: str
    objects: tuple[str, ...]
    values: tuple[Value, ...]
    runs: tuple[ValueRun, ...]


@dataclass(frozen=True, slots=True)
class Ribbon:
    """A trace's rows and violations; ``left_out`` further rows are all default."""

    trace: Trace
    rows: tuple[RibbonRow, ...]
    left_out: int
    violations: tuple[Violation, ...]

    def decisive(self, violation: Violation) -> int:
        """The state that decides a violation; beyond the last for the end."""
        return len(self.trace.states) if violation.step is None else violation.step


def ribbon(
    trace: Trace, rules: CompiledRulebook, verdict: Verdict, only: Collection[str] = ()
) -> Ribbon:
    """Collect the rows that the rules read, of nobody, of each object, then of pairs.

    What the trace does not speak of has a row only if a rule that is violated reads it. ``only``:
    the objects to tell of, if not of all.
    """
    shown_objects = set(only) or set(trace.objects)
    violations = tuple(
        violation
        for violation in verdict.violations
        if shown_objects.issuperset(violation.binding.values())
    )
    violated = {violation.rule for violation in violations}
    # Name -> whether a violated rule reads it.
    read: dict[str, bool] = {}
    for rule in rules.rules:
        for name in names_in(rule.formula):
            read[name] = read.get(name, False) or rule.name in violated
    rows = []
    left_out = 0
    for objects in [(), *((name,) for name in trace.objects), *_pairs(trace, read)]:
        for name, matters in read.items() if shown_objects.issuperset(objects) else ():
            row = _row(trace, rules.vocabulary, name, objects)
            if row is None:
                continue
            if matters or any(_said(state, name, objects) for state in trace.states):
                rows.append(row)
            else:
                left_out += 1
    return Ribbon(trace, tuple(rows), left_out, violations)


def _pairs(trace: Trace, names: Iterable[str]) -> list[tuple[str, str]]:
    """Pairs of objects mentioned in some state; others have defaults alone."""
    pairs = {
        (first, second)
        for name in names
        for state in trace.states
        if isinstance(value := state.get(name), Mapping)
        for first, inner in value.items()
        if isinstance(inner, Mapping)
        for second in inner
    }
    order = {name: place for place, name in enumerate(trace.objects)}
    return sorted(pairs, key=lambda pair: (order[pair[0]], order[pair[1]]))


def _row(
    trace: Trace, vocabulary: Vocabulary, name: str, objects: tuple[str, ...]
) -> RibbonRow | None:
    declaration = vocabulary.declarations[name]
    if len(declaration.parameters) != len(objects) or not all(
        vocabulary.is_subtype(trace.objects[item], kind)
        for item, kind in zip(objects, declaration.parameters, strict=True)
    ):
        return None
    presences = [trace.present.get(item, (0, len(trace.states))) for item in objects]
    values = [
        value_in(state, name, objects, declaration)
        if all(first <= number <= last for first, last in presences)
        else None
        for number, state in enumerate(trace.states)
    ]
    if all(value is None for value in values):
        return None
    title = f"{name}({', '.join(objects)})" if objects else name
    possible: tuple[Value, ...] = (False, True)
    match declaration:
        case Enumeration():
            possible = declaration.values
        case Quantity():
            possible = ()
            title += f" in {declaration.unit}" if declaration.unit else ""
    return RibbonRow(title, objects, possible, tuple(_runs(values)))


def _said(state: State, name: str, objects: Sequence[str]) -> bool:
    value: Any = state.get(name)
    for item in objects:
        value = value.get(item) if value is not None else None
    return value is not None


def _runs(values: Sequence[Value | None]) -> Iterator[ValueRun]:
    at = 0
    for value, same in groupby(values):
        first, at = at, at + sum(1 for _ in same)
        yield ValueRun(first, at - 1, value)


def extremes(row: RibbonRow) -> tuple[float, float]:
    """The least and the greatest value of a quantity."""
    numbers = [float(run.value) for run in row.runs if run.value is not None]
    return min(numbers), max(numbers)


def in_words(value: Value) -> str:
    """A value in a row."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return shown(value)
