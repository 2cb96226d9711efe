"""Verification of blocks of tables, with verdicts equal to ``verify``'s."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.automata.axiom_instances import counts
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.batch_verify import Answer, rules_for, verify_chunk, violations_in
from rulec.monitoring.batch.columns.block_columns import BlockGroup, columnize_block, groups_of
from rulec.monitoring.batch.columns.column_reader import NotGivenError
from rulec.monitoring.batch.columns.columnize import UnencodableError
from rulec.monitoring.batch.engine import verify_columns
from rulec.monitoring.batch.trace_groups import under_own_names
from rulec.monitoring.verdict import Verdict
from rulec.monitoring.verify import rulebook_for_step, rulebook_for_trace, verify_or_reason
from rulec.trace import Trace
from rulec.trace.formats.block_presence import outlined
from rulec.trace.formats.table_blocks import Block, OddTableError

_FEWEST_ROWS = 200
"""Where a shape has fewer rows, on average, traces are read row by row."""

Items = Sequence[Trace | RulecError]


def verify_items(items: Items, rulebook: CompiledRulebook) -> tuple[Items, Sequence[Answer]]:
    """Traces as they were read, perhaps a block, and their answers."""
    if isinstance(items, Block):
        answers = _verify_block(items, rulebook)
        if answers is not None:
            return items, answers
        items = list(items)
    return items, verify_chunk(items, rulebook)


def rulebook_for(items: Items, place: int, rulebook: CompiledRulebook) -> CompiledRulebook:
    """The rulebook that one of ``verify_items`` was judged by."""
    if isinstance(items, Block):
        return rulebook_for_step(items.step_s(place), rulebook)
    trace = items[place]
    assert isinstance(trace, Trace)
    return rulebook_for_trace(trace, rulebook)


def _verify_block(block: Block, rulebook: CompiledRulebook) -> list[Answer] | None:
    """None if something is odd about the block."""
    answers: list[Answer | None] = [None] * len(block)
    try:
        presence = outlined(block)
        groups = groups_of(block, presence)
        if len(groups) * _FEWEST_ROWS > len(presence.trace) + _FEWEST_ROWS:
            return None
        for group in groups:
            _verify_group(group, rulebook, answers)
    except (OddTableError, UnencodableError, NotGivenError, RulecError):
        return None
    return [
        verify_or_reason(block[place], rulebook) if answer is None else answer
        for place, answer in enumerate(answers)
    ]


def _verify_group(
    group: BlockGroup, rulebook: CompiledRulebook, answers: list[Answer | None]
) -> None:
    """Answer for those traces of a group whose values are all readable."""
    presence = group.presence
    objects = dict(zip(group.objects, group.types, strict=True))
    step_s = float(presence.step_s[group.traces[0]])
    rules = rules_for(Trace("", step_s, objects, ()), rulebook)
    if any(counts(axiom.formula) for axiom in rules.axioms):
        raise UnencodableError
    verdicts = verify_columns(columnize_block(group, rules.vocabulary), rules)
    traces = group.traces.tolist()
    for number, violations in violations_in(verdicts, len(traces)):
        trace = traces[number]
        own = presence.objects_of(trace) if violations else ()
        violations = under_own_names(violations, group.objects, own)
        answers[trace] = Verdict(presence.names[trace], violations)
