"""Exposure of judged traces: duration, distance, road, opportunities."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.alike_traces import alike_traces
from rulec.monitoring.batch.trace_groups import Names
from rulec.monitoring.moments.exposure import Exposure, alike_exposures
from rulec.monitoring.moments.name_tables import ColumnTables
from rulec.monitoring.moments.road_class import road_classes
from rulec.monitoring.moments.trace_truth import TraceTruth, tables_of
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.trace import Trace
from rulec.trace.trace_arrays import TraceArrays


@dataclass(frozen=True, slots=True)
class DriveFacts:
    """The states of a trace, ``step_s`` seconds apart, its road class, and its exposure."""

    n_states: int
    step_s: float
    road: str
    exposure: Mapping[str, Exposure]


def facts_of(
    trace: Trace | TraceArrays, rulebook: CompiledRulebook, verdict: Verdict
) -> DriveFacts:
    """The facts of one checked trace."""
    tables = tables_of(trace, rulebook.vocabulary)
    truth = TraceTruth(tables, rulebook.semantics, trace.ends)
    (facts,) = _facts(truth, trace.step_s, rulebook, [verdict], [tuple(trace.objects)])
    return facts


def idle_rules(
    trace: TraceArrays, rulebook: CompiledRulebook, verdict: Verdict | NotJudged
) -> frozenset[str]:
    """The judged rules that a trace certainly gives no opportunity to violate."""
    if isinstance(verdict, NotJudged):
        return frozenset()
    exposures = facts_of(trace, rulebook, verdict).exposure.items()
    return frozenset([name for name, own in exposures if not own.perhaps_opportunities])


def facts_of_many(
    items: Sequence[Trace | RulecError],
    verdicts: Sequence[Verdict | None],
    rulebook: CompiledRulebook,
) -> list[DriveFacts]:
    """The facts of the traces that have a verdict, in order.

    Similar traces are evaluated together.
    """
    judged = {place: verdict for place, verdict in enumerate(verdicts) if verdict is not None}
    facts_at: dict[int, DriveFacts] = {}
    for alike in alike_traces(items, [*judged], rulebook.vocabulary):
        own = [judged.get(place, _NOT_WANTED) for place in alike.places]
        names = [alike.names(number) for number in range(len(own))]
        tables = ColumnTables(alike.columns, rulebook.vocabulary, alike.told)
        truth = TraceTruth(tables, rulebook.semantics, alike.ends)
        facts = _facts(truth, alike.columns.step_s, rulebook, own, names)
        facts_at |= zip(alike.places, facts, strict=True)
    for place in judged.keys() - facts_at.keys():
        trace = items[place]
        assert isinstance(trace, Trace), "it has been judged"
        facts_at[place] = facts_of(trace, rulebook, judged[place])
    return [facts_at[place] for place in judged]


_NOT_WANTED = Verdict("", ())


def _facts(
    truth: TraceTruth,
    step_s: float,
    rulebook: CompiledRulebook,
    verdicts: Sequence[Verdict],
    names: Sequence[Names],
) -> list[DriveFacts]:
    exposures = alike_exposures(truth, step_s, rulebook, verdicts, names)
    columns = truth.tables.last.tolist(), road_classes(truth.tables), exposures
    return [
        DriveFacts(last + 1, step_s, road, exposure)
        for last, road, exposure in zip(*columns, strict=True)
    ]
