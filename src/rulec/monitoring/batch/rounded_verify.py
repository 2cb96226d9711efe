"""Traces in arrays judged by a rulebook rounded to their step, whatever faults of rulec cost."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.garbage_collection import no_garbage_collection
from rulec.monitoring.batch.findings import JudgedTrace
from rulec.monitoring.batch.verify_arrays import answer_to, judge_arrays, verify_arrays
from rulec.monitoring.fault_containment import judged_apart, without, without_words
from rulec.monitoring.verdict import NotJudged, Verdict, agreed
from rulec.trace.trace_arrays import TraceArrays

_Judged: TypeAlias = JudgedTrace | Verdict | NotJudged


@no_garbage_collection()
def judge_rounded(
    traces: Sequence[TraceArrays], roundings: Sequence[CompiledRulebook]
) -> Sequence[_Judged]:
    """The answer to each trace, whose verdict may be built by ``answer_to``.

    Rules that read a word which a fault has cost are not judged.
    """
    whole = iter(_judged([trace for trace in traces if not trace.faults], roundings))
    return [_without_words(x, roundings) if x.faults else next(whole) for x in traces]


def _judged(
    traces: Sequence[TraceArrays], roundings: Sequence[CompiledRulebook]
) -> Sequence[_Judged]:
    try:
        if len(roundings) == 1:
            return judge_arrays(traces, roundings[0])
        return _verified(traces, roundings)
    except Exception:
        return judged_apart(_verified, traces, roundings)


def _without_words(
    trace: TraceArrays, roundings: Sequence[CompiledRulebook]
) -> Verdict | NotJudged:
    known = roundings[0].prepared.setdefault(_without_words, {})
    words = frozenset(trace.faults)
    if words not in known:
        known[words] = [without_words(book, trace.faults)[0] for book in roundings]
    (judged,) = _judged([trace], known[words])
    answer = answer_to(judged, trace)
    if not isinstance(answer, Verdict):
        return answer
    _, lost = without_words(roundings[0], trace.faults)
    return without(answer, lost, [*trace.faults.values()])


def _verified(
    traces: Sequence[TraceArrays], roundings: Sequence[CompiledRulebook]
) -> list[Verdict | NotJudged]:
    every = zip(*(verify_arrays(traces, rules) for rules in roundings), strict=True)
    return [_agreed(answers) for answers in every]


def _agreed(answers: Sequence[Verdict | NotJudged]) -> Verdict | NotJudged:
    verdicts = [answer for answer in answers if isinstance(answer, Verdict)]
    return agreed(verdicts) if len(verdicts) == len(answers) else answers[0]
