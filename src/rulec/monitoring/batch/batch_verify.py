"""Verification of many traces together, with the same verdicts as ``verify``.

Any irregular trace, for instance one with an unknown name or a missing value, is judged by its
states.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from itertools import islice

import numpy as np

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.garbage_collection import no_garbage_collection
from rulec.monitoring.batch.by_states import rulebook_for_trace, verify_or_reason
from rulec.monitoring.batch.cell_verdicts import VerdictColumns, verify_cells
from rulec.monitoring.batch.columns.column_states import shared_states, trace_at
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.joined.joined_columns import (
    check_arrays,
    joined_columns,
    joined_rows,
)
from rulec.monitoring.batch.joined.joined_traces import JoinedTraces, TraceKind
from rulec.monitoring.batch.stacked.ready_rules import ready_rules
from rulec.monitoring.batch.stacked.stacked_run import StackedRun
from rulec.monitoring.batch.verify import (
    IRREGULAR,
    derived_trace,
    has_few_choices,
    verdicts_together,
)
from rulec.monitoring.bindings import Cast, types_of
from rulec.monitoring.fault_containment import said
from rulec.monitoring.limits import LIMITS
from rulec.monitoring.state_validation import check_objects
from rulec.monitoring.told_names import words_meant
from rulec.monitoring.verdict import NotJudged, Verdict, Violation
from rulec.resource_limits import CHOICES
from rulec.trace import Trace
from rulec.trace.formats.table_blocks import Block, OddTableError, outlined
from rulec.trace.trace_columns import TraceCells, TraceColumns
from rulec.trace.trace_model import check_frame, check_presence

_MADE_TOGETHER = 1 << 12
"""How many reasons for refusing traces are built at once.

Each takes one or two kilobytes, and a block may need one per row.
"""

Answer = Verdict | NotJudged

Items = Sequence[Trace | RulecError]


def verify_many(
    traces: Iterable[Trace | RulecError], rulebook: CompiledRulebook
) -> Iterator[Answer]:
    """Answers for many traces in order: a verdict, or a ``NotJudged``.

    Traces are read some thousands at a time (fewer if they are long), so their number is unlimited.
    A ``RulecError`` in place of a trace, as from ``read_traces``, becomes a ``NotJudged``.
    """
    chunk: list[Trace | RulecError] = []
    n_states = 0
    for item in traces:
        chunk.append(item)
        n_states += _n_states(item) + 1
        if n_states >= LIMITS.states_together:
            yield from verify_chunk(chunk, rulebook)
            chunk, n_states = [], 0
    yield from verify_chunk(chunk, rulebook)


def _n_states(item: Trace | RulecError) -> int:
    states: object = item.states if isinstance(item, Trace) else ()
    return len(states) if isinstance(states, Sequence) else 0


@no_garbage_collection()
def verify_chunk(items: Sequence[Trace | RulecError], rulebook: CompiledRulebook) -> list[Answer]:
    """Answers for some traces, judged together where they are alike."""
    try:
        return _verify_chunk(items, rulebook)
    except Exception as problem:
        return said([verify_or_reason(item, rulebook) for item in items], problem)


def _verify_chunk(items: Sequence[Trace | RulecError], rulebook: CompiledRulebook) -> list[Answer]:
    answers: list[Answer | None] = [None] * len(items)
    kinds: dict[TraceKind, list[tuple[int, Trace]]] = {}
    for place, item in enumerate(items):
        # What is no trace, or has a constant that changes, is judged alone.
        if isinstance(item, Trace):
            trace = _readable(item, rulebook)
            if trace is not None:
                kind = TraceKind(trace.step_s, trace.ends, trace.told)
                kinds.setdefault(kind, []).append((place, trace))
    for kind, placed in kinds.items():
        with suppress(*IRREGULAR):
            ready_rules(kind, rulebook)
            verdicts = verdicts_together([trace for _, trace in placed], rulebook)
            for (place, _), verdict in zip(placed, verdicts, strict=True):
                answers[place] = verdict
    return [
        verify_or_reason(item, rulebook) if answer is None else answer
        for item, answer in zip(items, answers, strict=True)
    ]


def _readable(trace: Trace, rulebook: CompiledRulebook) -> Trace | None:
    """The trace with what follows from its values; None if only its states can tell."""
    with suppress(TypeError, AttributeError, LookupError, RulecError):
        check_frame(trace)
        check_presence(trace)
        return derived_trace(trace, rulebook)
    return None


def verify_items(
    items: Items, rulebook: CompiledRulebook
) -> Iterator[tuple[Items, Iterable[Answer]]]:
    """Yield traces as they were read, possibly as a block, with their answers.

    An irregular block is yielded in parts. Answers for traces that are judged one by one are
    computed on demand.
    """
    judged: tuple[Items, Iterable[Answer]] | None = None
    failed = None
    try:
        if isinstance(items, Block):
            judged = _verify_block(items, rulebook)
    except Exception as problem:
        failed = problem
    if judged is not None:
        yield judged
        return
    rest = iter(items)
    while some := list(islice(rest, _MADE_TOGETHER)):
        yield some, said(verify_chunk(some, rulebook), failed)
        failed = None


def _with_others(
    answers: Sequence[Answer | None], block: Block, rulebook: CompiledRulebook
) -> Iterator[Answer]:
    """Answers in order; missing ones are computed on demand."""
    for start in range(0, len(answers), _MADE_TOGETHER):
        some = answers[start : start + _MADE_TOGETHER]
        left = [start + number for number, answer in enumerate(some) if answer is None]
        others = iter(verify_chunk([block[place] for place in left], rulebook))
        yield from [next(others) if answer is None else answer for answer in some]


def _fill(
    answers: list[Answer | None],
    places: Sequence[int],
    joined: JoinedTraces,
    rulebook: CompiledRulebook,
) -> None:
    """Fill in the answers for the traces that can be judged together. Raises ``IRREGULAR``."""
    own = range(len(places)) if max(joined.n_objects) ** 2 > CHOICES.value() else ()
    if not all(has_few_choices(joined.objects_of(number), rulebook) for number in own):
        raise UnencodableError
    for place, verdict in zip(places, StackedRun(joined, rulebook).verdicts(), strict=True):
        answers[place] = verdict


@no_garbage_collection()
def verify_columns(columns: TraceColumns, rulebook: CompiledRulebook) -> list[Answer]:
    """Answers for traces given as columns, in the layout's order.

    Raises ValueError for an array that fits no name of the vocabulary, or not the layout.
    """
    check_arrays(columns, rulebook.vocabulary)
    answers: list[Answer | None] = [None] * columns.layout.n_traces
    with suppress(*IRREGULAR):
        cells = _cells(columns, rulebook)
        if cells is None:
            joined = joined_columns(columns, rulebook.vocabulary)
            _fill(answers, range(len(answers)), joined, rulebook)
        else:
            verdicts = verify_cells(cells, rulebook.fitted_to(columns.step_s))
            for number, violations in _violations_in(verdicts, len(answers)):
                answers[number] = Verdict(str(number), tuple(violations))
    return [
        verify_or_reason(trace_at(columns, place, rulebook.vocabulary), rulebook)
        if answer is None
        else answer
        for place, answer in enumerate(answers)
    ]


def _cells(columns: TraceColumns, rulebook: CompiledRulebook) -> TraceCells | None:
    """The traces as cells, if they are of few states that say everything. Raises ``IRREGULAR``."""
    vocabulary = rulebook.vocabulary
    if vocabulary.constants or vocabulary.implied or words_meant(vocabulary, None):
        return None
    cells = shared_states(columns, vocabulary)
    if cells is not None:
        rules = rulebook_for_trace(Trace("", columns.step_s, columns.objects, ()), rulebook)
        ready_rules(TraceKind(columns.step_s, "complete", None), rules)
        check_objects(columns.objects, vocabulary)
        cast = Cast(columns.objects, vocabulary, columns.layout.n_steps, columns.present)
        if any(cast.has_many(types_of(rule)) for rule in rules.rules):
            raise UnencodableError
    return cells


def _violations_in(
    verdicts: Sequence[VerdictColumns], n_traces: int
) -> Iterator[tuple[int, Sequence[Violation]]]:
    """The violations of each trace that could be read, in the order of rules and objects."""
    unread: set[int] = set().union(*[verdict.unread.tolist() for verdict in verdicts])
    by_trace: dict[int, list[Violation]] = {}
    for verdict in verdicts:
        rule, objects = verdict.task.rule, verdict.task.objects
        for trace, step in zip(verdict.violated.tolist(), verdict.lost_at().tolist(), strict=True):
            violation = Violation(rule.name, rule.strength, objects, None if step < 0 else step)
            by_trace.setdefault(trace, []).append(violation)
    for trace in range(n_traces):
        if trace not in unread:
            yield trace, by_trace.get(trace, ())


def rulebook_for(items: Items, place: int, rulebook: CompiledRulebook) -> CompiledRulebook:
    """The rulebook by which an item of ``verify_items`` was judged."""
    return rulebook.fitted_to(step_of(items, place))


def step_of(items: Items, place: int) -> float:
    """The time step (s) of a trace that has been judged."""
    if isinstance(items, Block):
        return items.step_s(place)
    trace = items[place]
    assert isinstance(trace, Trace)
    return trace.step_s


def _verify_block(
    block: Block, rulebook: CompiledRulebook
) -> tuple[Block, Iterator[Answer]] | None:
    """The block with its outline, and its answers; None if it is irregular."""
    answers: list[Answer | None] = [None] * len(block)
    try:
        presence = outlined(block)
        block = replace(block, outline=presence)
        kinds: dict[tuple[object, ...], list[int]] = {}
        for trace in sorted({*range(len(block))} - block.partial):
            kinds.setdefault((presence.step_s[trace], presence.ends[trace]), []).append(trace)
        for traces in kinds.values():
            joined = joined_rows(block, presence, np.array(traces), rulebook.vocabulary)
            _fill(answers, traces, joined, rulebook)
    except (OddTableError, *IRREGULAR):
        return None
    return block, _with_others(answers, block, rulebook)
