"""Verification of traces in arrays, with the same verdicts as ``verify`` on their states.

Any irregular trace is judged by its states; a fault of rulec costs little.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from contextlib import suppress
from typing import TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.garbage_collection import no_garbage_collection
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.findings import JudgedTrace
from rulec.monitoring.batch.joined.joined_traces import JoinedTraces, TraceKind, side_by_side
from rulec.monitoring.batch.stacked.stacked_run import StackedRun
from rulec.monitoring.fault_containment import judged_apart, without, without_words
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.trace.shared_columns import SharedColumns
from rulec.trace.trace_arrays import TraceArrays
from rulec.trace.trace_columns import Array

Answer: TypeAlias = Verdict | NotJudged
Judged: TypeAlias = JudgedTrace | Answer


def verify_arrays(traces: Sequence[TraceArrays], rulebook: CompiledRulebook) -> list[Answer]:
    """Answers for traces in arrays, in their order: a verdict, or a ``NotJudged``."""
    judged = judge_arrays(traces, rulebook)
    return [answer_to(own, trace) for own, trace in zip(judged, traces, strict=True)]


def answer_to(judged: Judged, trace: TraceArrays) -> Answer:
    """The answer for a trace that has been judged."""
    if isinstance(judged, JudgedTrace):
        return judged.findings.verdict(judged.number, trace.id, trace.says)
    return judged


def judge_arrays(traces: Sequence[TraceArrays], rulebook: CompiledRulebook) -> list[Judged]:
    """The same as ``verify_arrays``, but verdicts are built on demand by ``answer_to``."""
    answers: list[Judged | None] = [None] * len(traces)
    groups: dict[object, list[int]] = {}
    known: dict[int, frozenset[str]] = {}
    for place in side_by_side(traces):
        trace = traces[place]
        names = _names(trace.world, known), _names(trace.about, known)
        key = TraceKind(trace.step_s, trace.ends, trace.told), names
        groups.setdefault(key, []).append(place)
    for places in groups.values():
        found: Sequence[JudgedTrace | None] = [None] * len(places)
        with suppress(UnencodableError, RulecError):
            together = JoinedTraces.of_arrays([traces[x] for x in places], rulebook.vocabulary)
            found = StackedRun(together, rulebook).judged()
        for place, own in zip(places, found, strict=True):
            answers[place] = own or _by_states(traces[place], rulebook)
    return [answer for answer in answers if answer is not None]


def _names(columns: Mapping[str, Array], known: dict[int, frozenset[str]]) -> frozenset[str]:
    """The names of columns; ``known`` caches those of columns that several traces share."""
    if not isinstance(columns, SharedColumns):
        return frozenset(columns)
    key = id(columns.columns)
    if key not in known:
        known[key] = frozenset(columns)
    return known[key]


def _by_states(trace: TraceArrays, rulebook: CompiledRulebook) -> Answer:
    # The engine for states loads slowly, and few recordings need it.
    from rulec.monitoring.batch.by_states import verify_or_reason

    return verify_or_reason(trace.trace(), rulebook)


@no_garbage_collection()
def judge_contained(traces: Sequence[TraceArrays], rulebook: CompiledRulebook) -> Sequence[Judged]:
    """As ``judge_arrays``; rules that read a word which a fault has cost are not judged."""
    whole = iter(_judged([trace for trace in traces if not trace.faults], rulebook))
    return [_without_words(x, rulebook) if x.faults else next(whole) for x in traces]


def _judged(traces: Sequence[TraceArrays], rulebook: CompiledRulebook) -> Sequence[Judged]:
    try:
        return judge_arrays(traces, rulebook)
    except Exception:
        return judged_apart(verify_arrays, traces, rulebook)


def _without_words(trace: TraceArrays, rulebook: CompiledRulebook) -> Answer:
    known = rulebook.prepared.setdefault(_without_words, {})
    key = frozenset(trace.faults), trace.told
    if key not in known:
        known[key] = without_words(rulebook, trace.faults, trace.told)[0]
    (judged,) = _judged([trace], known[key])
    answer = answer_to(judged, trace)
    if not isinstance(answer, Verdict):
        return answer
    _, lost = without_words(rulebook, trace.faults, trace.told)
    return without(answer, lost, [*trace.faults.values()])
