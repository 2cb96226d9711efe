"""Many traces judged together; each verdict is the one that ``verify`` gives of the trace alone.

Traces that share their shape run through the machines together. Whatever is odd about a trace, from
an unknown name to a missing value, is left to ``verify``, which says it best.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import islice

import numpy as np

from rulec.automata.compiled import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.runtime.batch.gathering import OddError, gathered
from rulec.runtime.batch.grouping import Shape, grouped, shape_of
from rulec.runtime.batch.judged import Judged
from rulec.runtime.batch.judging import judge_cells, judge_columns
from rulec.runtime.batch.reading import NotGivenError
from rulec.runtime.checking import check_objects, check_state
from rulec.runtime.numbers import exact
from rulec.runtime.verdict import NotJudged, Verdict, Violation
from rulec.runtime.verify import RulebookFor, check_step, judge, made_for
from rulec.trace import Trace
from rulec.trace.check import check_frame, check_presence
from rulec.trace.columns import TraceCells

MOST_TOGETHER = 1 << 14
"""So many traces are read before they are judged."""

FEWEST = 4
"""Fewer traces of one shape are judged one by one."""

_SHARED = 4
"""Where a state is met so many times, on average, what it means is worked out once."""

Rules = CompiledRulebook | RulebookFor
Answer = Verdict | NotJudged


def verify_many(traces: Iterable[Trace | RulecError], rulebook: Rules) -> Iterator[Answer]:
    """The verdict on each trace, in their order; in place of one that cannot be given, why.

    Traces are read a few thousand at a time, so there may be any number of them. A ``RulecError``
    in place of a trace, as from ``read_traces``, becomes a ``NotJudged``.
    """
    waiting = iter(traces)
    while chunk := list(islice(waiting, MOST_TOGETHER)):
        yield from judge_chunk(chunk, rulebook)


def judge_chunk(
    items: Sequence[Trace | RulecError], rulebook: Rules, fewest: int = FEWEST
) -> list[Answer]:
    """The same for a few traces; ``fewest`` of one shape are judged together."""
    answers: list[Answer | None] = [None] * len(items)
    shapes: dict[Shape, list[int]] = {}
    for place, item in enumerate(items):
        if isinstance(item, Trace):
            try:
                shapes.setdefault(shape_of(item), []).append(place)
            except (TypeError, AttributeError):  # it is no trace, which ``verify`` will say
                continue
    for places in shapes.values():
        if len(places) >= fewest:
            _judge_group(items, places, rulebook, answers)
    return [
        judge(item, rulebook) if answer is None else answer
        for item, answer in zip(items, answers, strict=True)
    ]


def _judge_group(
    items: Sequence[Trace | RulecError],
    places: Sequence[int],
    rulebook: Rules,
    answers: list[Answer | None],
) -> None:
    """Answer for those traces of one shape that nothing is odd about."""
    sound: list[tuple[int, Trace]] = []
    for place in places:
        trace = items[place]
        if isinstance(trace, Trace) and _is_framed(trace):
            sound.append((place, trace))
    if not sound:
        return
    try:
        rules = _rules_for(sound[0][1], rulebook)
    except RulecError:
        return
    group = grouped([trace for _, trace in sound])
    cells = group.cells
    if len(cells.states) * _SHARED > cells.layout.n_states:
        try:
            judged = judge_columns(gathered(cells, rules.vocabulary), rules)
        except (OddError, NotGivenError):
            return
        odd = np.zeros(cells.layout.n_traces, dtype=bool)
    else:
        odd = _odd_traces(cells, rules)
        judged = judge_cells(cells, rules)
    for one in judged:
        odd[one.unread] = True
    violations = _violations(judged)
    for trace_place, number in enumerate(group.order):
        if not odd[trace_place]:
            place, trace = sound[number]
            answers[place] = Verdict(trace.id, tuple(violations.get(trace_place, ())))


def _is_framed(trace: Trace) -> bool:
    try:
        check_frame(trace)
        if trace.present:
            check_presence(trace)
    except (RulecError, TypeError):
        return False
    return True


def _rules_for(trace: Trace, rulebook: Rules) -> CompiledRulebook:
    """The rulebook for traces of this one's shape. Raises RulecError if it cannot judge them."""
    rules = made_for(trace, rulebook)
    for rule in rules.rules:
        check_step(rule, exact(trace.step_s))
    check_objects(trace.objects, rules.vocabulary)
    return rules


def _odd_traces(
    cells: TraceCells, rulebook: CompiledRulebook
) -> np.ndarray[tuple[int], np.dtype[np.bool_]]:
    """Which traces have a state that does not fit the vocabulary."""
    odd = np.array([not _fits(state, cells.objects, rulebook) for state in cells.states])
    found = np.zeros(cells.layout.n_traces, dtype=bool)
    if odd.any():
        for step in range(cells.layout.n_steps):
            start, end = cells.layout.starts[step : step + 2]
            found[: end - start] |= odd.take(cells.cells[start:end])
    return found


def _fits(state: object, objects: Mapping[str, str], rulebook: CompiledRulebook) -> bool:
    if not isinstance(state, Mapping):
        return False
    try:
        check_state(state, objects, rulebook.vocabulary, "")
    except RulecError:
        return False
    return True


def _violations(judged: Sequence[Judged]) -> dict[int, list[Violation]]:
    """The violations of each trace that has some, in the order of rules and objects."""
    found: dict[int, list[Violation]] = {}
    for one in judged:
        rule, objects = one.task.rule, one.task.objects
        for trace, step in zip(one.violated.tolist(), one.lost_at().tolist(), strict=True):
            violation = Violation(rule.name, rule.strength, objects, None if step < 0 else step)
            found.setdefault(trace, []).append(violation)
    return found
