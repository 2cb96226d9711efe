"""The findings of traces."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.logic.free_names import names_in
from rulec.monitoring.explain.explanation import Explanation, explain
from rulec.monitoring.verdict import NotJudged, Verdict
from rulec.report.findings.verdict_finding import (
    VerdictFinding,
    left_open,
    measured,
    named_law,
    named_rule,
    not_judged,
)
from rulec.trace import Trace


def trace_findings(
    file: str,
    trace: Trace,
    answer: Verdict,
    rulebook: CompiledRulebook,
    explained: list[Explanation],
) -> Iterator[VerdictFinding]:
    """The findings of a trace; ``explained`` are explanations of its first violations."""
    rules = {rule.name: rule for rule in rulebook.rules}
    law = named_law(rulebook)

    def about(rule: CompiledRule) -> dict[str, Any]:
        return {"file": file, "vehicle": answer.trace, **law, **named_rule(rule)}

    presumed = {*answer.presumed}
    for number, violation in enumerate(answer.violations):
        read = names_in(rules[violation.rule].formula)
        explanation = (
            explained[number]
            if number < len(explained)
            else explain(violation, trace, rulebook, repaired=False)
        )
        first, last = explanation.lasts
        yield VerdictFinding(
            outcome="violated",
            other=tuple(violation.binding.values()),
            from_s=_time_s(trace, first),
            to_s=_time_s(trace, last),
            at_s=_time_s(trace, explanation.decisive),
            rests_on="default" if presumed.intersection(read) else "measured",
            **measured(explanation.margins()),
            **about(rules[violation.rule]),
        )
    for result in answer.open:
        yield VerdictFinding(
            from_s=_time_s(trace, 0),
            to_s=_time_s(trace, len(trace.states) - 1),
            **left_open(result),
            **about(rules[result.rule]),
        )
    for rule in answer.not_judged:
        yield VerdictFinding(**not_judged(rule), **about(rules[rule.rule]))


def not_judged_trace(file: str, answer: NotJudged, rulebook: str) -> VerdictFinding:
    """The finding that a trace could not be judged."""
    return VerdictFinding(
        file=file,
        vehicle=answer.trace or "",
        rulebook=rulebook,
        outcome="not_judged",
        because=answer.error.diagnostics[0].message,
    )


def _time_s(trace: Trace, state: int) -> float:
    """The time of a state (s), from the first state on."""
    return round(state * trace.step_s, 9)
