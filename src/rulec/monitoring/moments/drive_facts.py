"""Exposure of judged traces: duration, distance, road, opportunities."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from rulec.array_types import Flags
from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.joined.joined_columns import joined_rows
from rulec.monitoring.batch.joined.joined_states import joined_states
from rulec.monitoring.batch.joined.joined_traces import JoinedTraces, with_all_values
from rulec.monitoring.moments.exposure import Exposure, alike_exposures
from rulec.monitoring.moments.name_tables import NameTables, tables_of
from rulec.monitoring.moments.trace_truth import TraceTruth
from rulec.monitoring.verdict import Verdict
from rulec.trace import Trace
from rulec.trace.formats.table_blocks import Block, BlockPresence
from rulec.trace.partly_known.partly_known_values import EnumeratedChoice, Truth
from rulec.trace.trace_arrays import TraceArrays
from rulec.vocabulary import Enumeration, Signal, Vocabulary

MOTORWAY, BUILT_UP, OUTSIDE = "motorway", "built-up", "outside"
"""Road classes: motorways, other roads within built-up areas, and other roads outside of them."""


def road_classes(tables: NameTables) -> list[str]:
    """For each trace the road class of most of its states.

    It is empty if most states do not tell, or if the vocabulary lacks the words ``motorway`` and
    ``built_up`` of the vocabulary ``road``: signals, or values of an enumeration.
    """
    there = np.arange(tables.n_states) <= tables.last[:, None]
    told = [_known(tables, name, there) for name in ("motorway", "built_up")]
    if None in told:
        return [""] * tables.n_traces
    (on_motorway, not_on_motorway), (built_up, not_built_up) = filter(None, told)
    counts = {
        MOTORWAY: on_motorway.sum(axis=1),
        BUILT_UP: (not_on_motorway & built_up).sum(axis=1),
        OUTSIDE: (not_on_motorway & not_built_up).sum(axis=1),
    }
    counts[""] = tables.last + 1 - sum(counts.values())
    most = np.argmax(list(counts.values()), axis=0)
    return [[*counts][place] for place in most.tolist()]


def _known(tables: NameTables, name: str, there: Flags) -> tuple[Flags, Flags] | None:
    """The states in which a word is known to hold, and known not to; None if it is no such word."""
    declared = tables.vocabulary.declarations.get(name) or tables.vocabulary.enumeration_of.get(
        name
    )
    if not isinstance(declared, Signal | Enumeration) or declared.parameters:
        return None
    rows = tables.world(declared.name)
    if isinstance(declared, Enumeration) and isinstance(rows, EnumeratedChoice):
        rows = rows.equals(declared.values.index(name))
    assert isinstance(rows, Truth), "a signal has one"
    return there & rows.sure, there & ~rows.possible


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
    for places, alike in _alike_traces(items, [*judged], rulebook.vocabulary):
        own = [judged.get(place, _NOT_WANTED) for place in places]
        kind, of_each = alike.kind, alike.n_objects[0]
        names = [tuple(alike.names[n * of_each : (n + 1) * of_each]) for n in range(len(own))]
        tables = NameTables(alike, rulebook.vocabulary)
        truth = TraceTruth(tables, rulebook.semantics, kind.ends)
        facts = _facts(truth, kind.step_s, rulebook, own, names)
        facts_at |= zip(places, facts, strict=True)
    for place in judged.keys() - facts_at.keys():
        trace = items[place]
        assert isinstance(trace, Trace), "it has been judged"
        facts_at[place] = facts_of(trace, rulebook, judged[place])
    return [facts_at[place] for place in judged]


def _alike_traces(
    items: Sequence[Trace | RulecError], wanted: Sequence[int], vocabulary: Vocabulary
) -> Iterator[tuple[Sequence[int], JoinedTraces]]:
    """The ``wanted`` items of one shape with their places, as far as arrays can tell of them.

    There may be further traces of the same shape among them.
    """
    if isinstance(items, Block) and items.outline is not None:
        for own in _shapes(items, items.outline):
            with suppress(UnencodableError):
                yield own, joined_rows(items, items.outline, np.array(own), vocabulary)
        wanted = [place for place in wanted if place in items.partial]
    shapes: dict[object, tuple[list[int], list[Trace]]] = {}
    for place in wanted:
        trace = items[place]
        assert isinstance(trace, Trace), "it has been judged"
        if vocabulary.constants or vocabulary.implied:
            trace = with_all_values(trace, vocabulary)
        key = _shape_of(trace), trace.ends, trace.told
        places, traces = shapes.setdefault(key, ([], []))
        places.append(place)
        traces.append(trace)
    for places, traces in shapes.values():
        with suppress(UnencodableError):
            yield places, joined_states(traces, vocabulary)


def _shapes(block: Block, outline: BlockPresence) -> list[list[int]]:
    """The traces of a block of which everything is known, grouped by shape."""
    shapes: dict[object, list[int]] = {}
    for trace in sorted(set(range(len(block))) - block.partial):
        shapes.setdefault(outline.shape_of(trace), []).append(trace)
    return [*shapes.values()]


def _shape_of(trace: Trace) -> tuple[object, ...]:
    """The shape of a trace: step, object types in order, and presence, without names."""
    places = {name: place for place, name in enumerate(trace.objects)}
    stretches = [(places[name], stretch) for name, stretch in trace.present.items()]
    return trace.step_s, tuple(trace.objects.values()), tuple(sorted(stretches))


_NOT_WANTED = Verdict("", ())


def _facts(
    truth: TraceTruth,
    step_s: float,
    rulebook: CompiledRulebook,
    verdicts: Sequence[Verdict],
    names: Sequence[tuple[str, ...]],
) -> list[DriveFacts]:
    exposures = alike_exposures(truth, step_s, rulebook, verdicts, names)
    columns = truth.tables.last.tolist(), road_classes(truth.tables), exposures
    return [
        DriveFacts(last + 1, step_s, road, exposure)
        for last, road, exposure in zip(*columns, strict=True)
    ]
