"""A trace as a ribbon: values in rows over time, and violations."""

from __future__ import annotations

from collections.abc import Collection, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.logic.formula import Atom
from rulec.logic.free_names import names_in
from rulec.monitoring.state_view import value_in
from rulec.monitoring.verdict import Verdict, Violation
from rulec.report.verdicts.violation_table import shown
from rulec.trace import State, Trace, Value
from rulec.vocabulary import Enumeration, Quantity, Vocabulary
from rulec.vocabulary.partial_values import Interval, PartialValue

WORD_STYLES = 6
"""Number of styles for the values of enumerations."""


@dataclass(frozen=True, slots=True)
class ValueRun:
    """A run of states with a constant value, from ``first`` to ``last`` inclusive.

    ``value`` is None where it is ``unknown``, or where its object is absent. For a number known
    within bounds it is their middle, and ``bounds`` shows them, such as ``4 to 1000``.
    """

    first: int
    last: int
    value: Value | None
    unknown: bool = False
    bounds: str = ""


@dataclass(frozen=True, slots=True)
class RibbonRow:
    """One thing that rules read, such as ``position(v1)``, over a whole trace.

    ``values`` are the possible values in the vocabulary's order; empty for a quantity. A number
    known within bounds is shown as their middle, which may be wrong by up to ``error``.
    """

    title: str
    objects: tuple[str, ...]
    values: tuple[Value, ...]
    runs: tuple[ValueRun, ...]
    error: float = 0.0


@dataclass(frozen=True, slots=True)
class Ribbon:
    """A trace's rows and violations; ``left_out`` counts rows omitted as default or unwanted."""

    trace: Trace
    rows: tuple[RibbonRow, ...]
    left_out: int
    violations: tuple[Violation, ...]

    def decisive(self, violation: Violation) -> int:
        """The state that decides a violation; one past the last if the end decides."""
        return len(self.trace.states) if violation.step is None else violation.step


def ribbon(
    trace: Trace,
    rules: CompiledRulebook,
    verdict: Verdict,
    only: Collection[str] = (),
    *,
    every_row: bool = False,
) -> Ribbon:
    """Collect the rows that violated rules read about the world, the bound objects and their pairs.

    Without violations, or with ``every_row``, the rows that any rule reads and the trace mentions.
    ``only``: show only these objects, if not empty.
    """
    shown_objects = set(only) or set(trace.objects)
    violations = tuple(
        violation
        for violation in verdict.violations
        if shown_objects.issuperset(violation.binding.values())
    )
    reads = {rule.name: tuple(names_in(rule.formula)) for rule in rules.rules}
    every = every_row or not violations
    rows = []
    left_out = 0
    names = list(dict.fromkeys(name for rule in rules.rules for name in reads[rule.name]))
    for objects in [(), *((name,) for name in trace.objects), *_pairs(trace, names)]:
        for name in names if shown_objects.issuperset(objects) else ():
            row = _row(trace, rules.vocabulary, name, objects)
            if row is None:
                continue
            matters = any(
                name in reads[violation.rule]
                and set(violation.binding.values()).issuperset(objects)
                for violation in violations
            )
            if matters or (every and any(_is_said(state, name, objects) for state in trace.states)):
                rows.append(row)
            else:
                left_out += 1
    return Ribbon(trace, tuple(rows), left_out, violations)


def _pairs(trace: Trace, names: Iterable[str]) -> list[tuple[str, str]]:
    """Pairs of objects mentioned in some state; all other pairs have only defaults."""
    pairs = {
        (first, second)
        for name in names
        for state in trace.states
        for first, inner in _about_objects(state.get(name))
        for second, _ in _about_objects(inner)
    }
    order = {name: place for place, name in enumerate(trace.objects)}
    return sorted(pairs, key=lambda pair: (order[pair[0]], order[pair[1]]))


def _row(
    trace: Trace, vocabulary: Vocabulary, name: str, objects: tuple[str, ...]
) -> RibbonRow | None:
    declaration = vocabulary.declarations[name]
    kinds, parameters = [trace.objects[item] for item in objects], declaration.parameters
    if len(kinds) != len(parameters) or not all(map(vocabulary.is_subtype, kinds, parameters)):
        return None
    presences = [trace.present.get(item, (0, len(trace.states))) for item in objects]
    states = range(len(trace.states))
    there = [all(first <= state <= last for first, last in presences) for state in states]
    given = [
        value_in(state, name, objects, declaration) if present else None
        for state, present in zip(trace.states, there, strict=True)
    ]
    if not any(there):
        return None
    error = max((value.error for value in given if isinstance(value, Interval)), default=0.0)
    title = str(Atom(name, objects))
    possible: tuple[Value, ...] = (False, True)
    match declaration:
        case Enumeration():
            possible = declaration.values
        case Quantity():
            possible = ()
            title += f" in {declaration.unit}" if declaration.unit else ""
    return RibbonRow(title, objects, possible, tuple(_runs(given, there)), error)


def _about_objects(value: Any) -> Iterable[tuple[str, Any]]:
    return value.items() if isinstance(value, Mapping) else ()


def _known(value: PartialValue | None) -> Value | None:
    if isinstance(value, Interval):
        return value.middle
    return value if isinstance(value, bool | int | float | str) else None


def _is_said(state: State, name: str, objects: Sequence[str]) -> bool:
    value: Any = state.get(name)
    for item in objects:
        value = value.get(item) if isinstance(value, Mapping) else value
    return value is not None


def _runs(given: Sequence[PartialValue | None], there: Sequence[bool]) -> Iterator[ValueRun]:
    at = 0
    bounds = [shown(value) if isinstance(value, Interval) else "" for value in given]
    for (value, bound, present), same in groupby(
        zip(map(_known, given), bounds, there, strict=True)
    ):
        first, at = at, at + sum(1 for _ in same)
        yield ValueRun(first, at - 1, value, unknown=present and value is None, bounds=bound)


_LIGHTS = {"red_light": "red", "amber_light": "yellow", "green_light": "green"}


def value_style(row: RibbonRow, value: Value | None) -> str:
    """The style of a value: truth values, words and lights have different ones."""
    if value is None:
        return "unknown"
    if isinstance(value, bool):
        return "true" if value else "off"
    return _LIGHTS.get(str(value)) or f"word{row.values.index(value) % WORD_STYLES}"


def extremes(row: RibbonRow) -> tuple[float, float]:
    """The smallest and the largest value of a quantity."""
    numbers = [float(run.value) for run in row.runs if run.value is not None]
    return min(numbers, default=0.0), max(numbers, default=0.0)


def in_words(value: Value) -> str:
    """A value as text in a row."""
    if isinstance(value, bool):
        return "true" if value else "false"
    return shown(value)
