"""The findings of traces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.diagnostics.argument_kinds import is_finite
from rulec.logic.free_names import names_in
from rulec.monitoring.explain.explanation import Explanation, explain
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.report.findings.verdict_finding import FindingSource, VerdictFinding
from rulec.trace import Trace


def trace_findings(
    file: str,
    trace: Trace,
    answer: Verdict,
    rulebook: CompiledRulebook,
    explained: Sequence[Explanation],
) -> Iterator[VerdictFinding]:
    """The findings of a trace; ``explained`` are explanations of its first violations."""
    source, vehicle, presumed = FindingSource(rulebook, file), answer.trace, {*answer.presumed}
    for number, violation in enumerate(answer.violations):
        explanation = (
            explained[number]
            if number < len(explained)
            else explain(violation, trace, rulebook, repaired=False)
        )
        first, last = explanation.lasts
        is_presumed = presumed.intersection(names_in(explanation.rule.formula))
        yield source.violated(
            violation,
            vehicle,
            explanation.margins(),
            other=tuple(violation.binding.values()),
            from_s=_time_s(trace, first),
            to_s=_time_s(trace, last),
            at_s=_time_s(trace, explanation.decisive),
            rests_on="default" if is_presumed else "measured",
        )
    lasts = _time_s(trace, 0), _time_s(trace, len(trace.states) - 1)
    for result in answer.open:
        yield source.left_open(result, vehicle, *lasts)
    for rule in answer.not_judged:
        yield source.not_judged(rule, vehicle)


def not_judged_trace(file: str, answer: NotJudged, rulebook: str) -> VerdictFinding:
    """The finding that a trace could not be judged."""
    return VerdictFinding(
        file=file,
        vehicle=answer.trace or "",
        rulebook=rulebook,
        outcome="not_judged",
        because=answer.error.diagnostics[0].message,
    )


def _time_s(trace: Trace, state: int) -> float | None:
    """The time of a state (s), from the first state on; None if it is beyond all floats."""
    time_s = state * trace.step_s
    return round(time_s, 9) if is_finite(time_s) else None
