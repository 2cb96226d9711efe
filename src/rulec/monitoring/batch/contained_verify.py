"""Traces in arrays judged together, whatever faults of rulec cost."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.garbage_collection import no_garbage_collection
from rulec.monitoring.batch.findings import JudgedTrace
from rulec.monitoring.batch.verify_arrays import answer_to, judge_arrays, verify_arrays
from rulec.monitoring.fault_containment import judged_apart, without, without_words
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.trace.trace_arrays import TraceArrays

_Judged: TypeAlias = JudgedTrace | Verdict | NotJudged


@no_garbage_collection()
def judge_contained(traces: Sequence[TraceArrays], rulebook: CompiledRulebook) -> Sequence[_Judged]:
    """As ``judge_arrays``; rules that read a word which a fault has cost are not judged."""
    whole = iter(_judged([trace for trace in traces if not trace.faults], rulebook))
    return [_without_words(x, rulebook) if x.faults else next(whole) for x in traces]


def answers_contained(
    traces: Sequence[TraceArrays], rulebook: CompiledRulebook
) -> list[Verdict | NotJudged]:
    """The answer to each trace by ``judge_contained``."""
    judged = judge_contained(traces, rulebook)
    return [answer_to(own, trace) for own, trace in zip(judged, traces, strict=True)]


def _judged(traces: Sequence[TraceArrays], rulebook: CompiledRulebook) -> Sequence[_Judged]:
    try:
        return judge_arrays(traces, rulebook)
    except Exception:
        return judged_apart(verify_arrays, traces, rulebook)


def _without_words(trace: TraceArrays, rulebook: CompiledRulebook) -> Verdict | NotJudged:
    known = rulebook.prepared.setdefault(_without_words, {})
    words = frozenset(trace.faults)
    if words not in known:
        known[words] = without_words(rulebook, trace.faults)[0]
    (judged,) = _judged([trace], known[words])
    answer = answer_to(judged, trace)
    if not isinstance(answer, Verdict):
        return answer
    _, lost = without_words(rulebook, trace.faults)
    return without(answer, lost, [*trace.faults.values()])
