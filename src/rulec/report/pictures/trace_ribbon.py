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
from rulec.vocabulary import Declaration, Enumeration, Quantity


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

    name: str
    objects: tuple[str, ...]
    unit: str
    values: tuple[Value, ...]
    runs: tuple[ValueRun, ...]

    @property
    def title(self) -> str:
        """The row's title in the words of a rule."""
        about = f"({', '.join(self.objects)})" if self.objects else ""
        return f"{self.name}{about}" + (f" in {self.unit}" if self.unit else "")


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
    """Collect the rows that the rules read.

    First what is about nobody, then object by object, then pairs.

    What the trace does not speak of has a row only if a rule that is violated reads it. ``only``:
    the objects to tell of, if not of all.
    """
    wanted = set(only) or set(trace.objects)
    violations = tuple(
        violation
        for violation in verdict.violations
        if wanted.issuperset(violation.binding.values())
    )
    read = dict.fromkeys(name for rule in rules.rules for name in names_in(rule.formula))
    violated = {violation.rule for violation in violations}
    matters = {
        name for rule in rules.rules if rule.name in violated for name in names_in(rule.formula)
    }
    rows = []
    left_out = 0
    for objects in [(), *((name,) for name in trace.objects), *_pairs(trace, read)]:
        for name in read if wanted.issuperset(objects) else ():
            row = _row(trace, rules, name, objects)
            if row is not None:
                told = name in matters or any(_said(state, name, objects) for state in trace.states)
                rows += [row] if told else []
                left_out += not told
    return Ribbon(trace, tuple(rows), left_out, violations)


def _pairs(trace: Trace, names: Iterable[str]) -> list[tuple[str, str]]:
    """Pairs of objects mentioned in some state; others have defaults alone."""
    values = (state.get(name) for name in names for state in trace.states)
    result = {
        (one, other): None
        for value in values
        if isinstance(value, Mapping)
        for one, inner in value.items()
        if isinstance(inner, Mapping)
        for other in inner
    }
    order = {name: place for place, name in enumerate(trace.objects)}
    return sorted(result, key=lambda pair: (order[pair[0]], order[pair[1]]))


def _row(
    trace: Trace, rules: CompiledRulebook, name: str, objects: tuple[str, ...]
) -> RibbonRow | None:
    vocabulary = rules.vocabulary
    declaration = vocabulary.declarations[name]
    if len(declaration.parameters) != len(objects) or not all(
        vocabulary.is_subtype(trace.objects[item], kind)
        for item, kind in zip(objects, declaration.parameters, strict=True)
    ):
        return None
    values = [
        _value(trace, number, name, objects, declaration) for number in range(len(trace.states))
    ]
    if all(value is None for value in values):
        return None
    unit = declaration.unit if isinstance(declaration, Quantity) else ""
    return RibbonRow(name, objects, unit, _possible(declaration), tuple(_runs(values)))


def _said(state: State, name: str, objects: Sequence[str]) -> bool:
    value: Any = state.get(name)
    for item in objects:
        value = value.get(item) if value is not None else None
    return value is not None


def _value(
    trace: Trace, number: int, name: str, objects: Sequence[str], declaration: Declaration
) -> Value | None:
    whole = (0, len(trace.states) - 1)
    for item in objects:
        first, last = trace.present.get(item, whole)
        if not first <= number <= last:
            return None
    return value_in(trace.states[number], name, objects, declaration)


def _runs(values: Sequence[Value | None]) -> Iterator[ValueRun]:
    at = 0
    for value, same in groupby(values):
        first, at = at, at + sum(1 for _ in same)
        yield ValueRun(first, at - 1, value)


def _possible(declaration: Declaration) -> tuple[Value, ...]:
    if isinstance(declaration, Enumeration):
        return declaration.values
    return () if isinstance(declaration, Quantity) else (False, True)


def extremes(row: RibbonRow) -> tuple[float, float]:
    """The least and the greatest value of a quantity."""
    numbers = [float(run.value) for run in row.runs if run.value is not None]
    return min(numbers), max(numbers)


def in_words(value: Value) -> str:
    """A value in a row."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return shown(value)
