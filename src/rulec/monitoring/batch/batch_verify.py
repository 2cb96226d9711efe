"""Verification of many traces together, with verdicts equal to ``verify``'s.

Traces that are alike but for their objects' names run through the machines together. Whatever is
odd about a trace, from an unknown name to a missing value, is left to ``verify``, which says it
best.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import chain

from rulec.automata.axiom_instances import counts
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook, check_step
from rulec.automata.thresholds import exact
from rulec.diagnostics import RulecError
from rulec.monitoring.axiom_violations import check_counting_axioms
from rulec.monitoring.batch.columns.column_reader import NotGivenError
from rulec.monitoring.batch.columns.columnize import columnize
from rulec.monitoring.batch.columns.value_encoding import UnencodableError
from rulec.monitoring.batch.engine import verify_cells, verify_columns
from rulec.monitoring.batch.trace_groups import group_traces, under_common_names
from rulec.monitoring.batch.trace_shapes import Names, Shape, shape_of, under_own_names
from rulec.monitoring.batch.verdict_columns import VerdictColumns
from rulec.monitoring.limits import LIMITS
from rulec.monitoring.state_validation import check_objects, check_state
from rulec.monitoring.state_view import StateView
from rulec.monitoring.verdict import NotJudged, Verdict, Violation
from rulec.monitoring.verify import rulebook_for_trace, verify_or_reason
from rulec.trace import Trace
from rulec.trace.trace_validation import check_frame, check_presence

FEWEST = 4
"""Fewer traces of one shape are judged one by one."""

_LONG = 1 << 6
"""Fewer of them are judged together, too, if they have so many states."""

_SHARED = 4
"""Where a state is met so many times, on average, what it means is worked out once."""

Answer = Verdict | NotJudged


def verify_many(
    traces: Iterable[Trace | RulecError], rulebook: CompiledRulebook
) -> Iterator[Answer]:
    """Answers for many traces in order: a verdict, or a ``NotJudged``.

    Traces are read some thousands at a time, fewer if they are long, so there may be any number of
    them. A ``RulecError`` in place of a trace, as from ``read_traces``, becomes a ``NotJudged``.
    """
    chunk: list[Trace | RulecError] = []
    n_states = 0
    for item in traces:
        chunk.append(item)
        n_states += len(item.states) + 1 if isinstance(item, Trace) else 1
        if n_states >= LIMITS.states_together:
            yield from verify_chunk(chunk, rulebook)
            chunk, n_states = [], 0
    yield from verify_chunk(chunk, rulebook)


def verify_chunk(
    items: Sequence[Trace | RulecError], rulebook: CompiledRulebook, fewest: int = FEWEST
) -> list[Answer]:
    """Answers for some traces, together from ``fewest`` of one shape on."""
    answers: list[Answer | None] = [None] * len(items)
    shapes: dict[Shape, list[int]] = {}
    for place, item in enumerate(items):
        if isinstance(item, Trace):
            try:
                shapes.setdefault(shape_of(item), []).append(place)
            except (TypeError, AttributeError, KeyError):
                continue  # it is no trace, which ``verify`` will say
    for places in shapes.values():
        if len(places) >= fewest or _are_long(items, places):
            _verify_group(items, places, rulebook, answers)
    return [
        verify_or_reason(item, rulebook) if answer is None else answer
        for item, answer in zip(items, answers, strict=True)
    ]


def _are_long(items: Sequence[Trace | RulecError], places: Sequence[int]) -> bool:
    """Tell whether few traces have enough states to be verified together."""
    traces = [items[place] for place in places]
    return sum(len(trace.states or ()) for trace in traces if isinstance(trace, Trace)) >= _LONG


def _verify_group(
    items: Sequence[Trace | RulecError],
    places: Sequence[int],
    rulebook: CompiledRulebook,
    answers: list[Answer | None],
) -> None:
    """Answer for those traces of one shape that nothing is odd about."""
    framed: list[tuple[int, Trace]] = []
    for place in places:
        trace = items[place]
        if isinstance(trace, Trace) and _is_framed(trace):
            framed.append((place, trace))
    if not framed:
        return
    try:
        rules = rules_for(framed[0][1], rulebook)
    except RulecError:
        return
    group = _verify_grouped(framed, rules)
    if group is None:
        return
    unread = set(chain.from_iterable(verdict.unread.tolist() for verdict in group.verdicts))
    violations = violations_in(group.verdicts)
    for number, place in enumerate(group.order):
        if number not in unread:
            where, trace = group.traces[place]
            result = violations.get(number, ())
            told = under_own_names(result, group.objects, tuple(trace.objects))
            answers[where] = Verdict(trace.id, told)


_Placed = tuple[int, Trace]


@dataclass(frozen=True, slots=True)
class _GroupVerdicts:
    """Verdicts on a group's ``objects``, its traces and their order."""

    verdicts: Sequence[VerdictColumns]
    traces: Sequence[_Placed]
    order: Sequence[int]
    objects: Names


def _verify_grouped(traces: Sequence[_Placed], rules: CompiledRulebook) -> _GroupVerdicts | None:
    group = group_traces([trace for _, trace in traces])
    cells = group.cells
    if len(cells.states) * _SHARED > cells.layout.n_states:
        if any(counts(fact.formula) for fact in rules.axioms):
            return None
        try:
            columns = columnize(cells, rules.vocabulary, group.names)
            verdicts = verify_columns(columns, rules)
        except (UnencodableError, NotGivenError):
            return None
        return _GroupVerdicts(verdicts, traces, group.order, tuple(cells.objects))
    cells = under_common_names(group)
    scenes = cells.there or (cells.objects,) * len(cells.states)
    refused = {
        id(state)
        for state, known, there in zip(group.cells.states, cells.states, scenes, strict=True)
        if not _fits(known, cells.objects, there, rules)
    }
    if refused:
        traces = [trace for trace in traces if refused.isdisjoint(map(id, trace[1].states))]
        if not traces:
            return None
        group = group_traces([trace for _, trace in traces])
        cells = under_common_names(group)
    return _GroupVerdicts(verify_cells(cells, rules), traces, group.order, tuple(cells.objects))


def _is_framed(trace: Trace) -> bool:
    try:
        check_frame(trace)
        if trace.present:
            check_presence(trace)
    except (RulecError, TypeError):
        return False
    return True


def rules_for(trace: Trace, rulebook: CompiledRulebook) -> CompiledRulebook:
    """Rulebook for traces of this shape. Raises RulecError if it cannot judge."""
    rules = rulebook_for_trace(trace, rulebook)
    for rule in rules.rules:
        check_step(rule, exact(trace.step_s))
    check_objects(trace.objects, rules.vocabulary)
    return rules


def _fits(
    state: object, objects: Mapping[str, str], there: Mapping[str, str], rulebook: CompiledRulebook
) -> bool:
    if not isinstance(state, Mapping):
        return False
    vocabulary = rulebook.vocabulary
    try:
        check_state(state, objects, vocabulary, "")
        view = StateView(state, there, vocabulary)
        check_counting_axioms(rulebook, 1, lambda _: view, str, None)
    except RulecError:
        return False
    return True


def violations_in(verdicts: Sequence[VerdictColumns]) -> dict[int, list[Violation]]:
    """Violations by trace, in the order of rules and objects."""
    result: dict[int, list[Violation]] = {}
    for verdict in verdicts:
        rule, objects = verdict.task.rule, verdict.task.objects
        for trace, step in zip(verdict.violated.tolist(), verdict.lost_at().tolist(), strict=True):
            violation = Violation(rule.name, rule.strength, objects, None if step < 0 else step)
            result.setdefault(trace, []).append(violation)
    return result
