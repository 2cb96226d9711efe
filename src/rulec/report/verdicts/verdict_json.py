"""Verdicts on traces as JSON, a line for each (see docs/traces.md)."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Literal

from msgspec import UNSET, UnsetType

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.monitoring.explain.explanation import Explanation
from rulec.monitoring.verdict import NotJudged, Verdict, Violation
from rulec.report.json_document import JsonDocument, JsonPart, Number, as_line, plain_number
from rulec.report.verdicts.explanation_json import ExplanationData, explanation_data


class ErrorData(JsonPart, frozen=True, kw_only=True):
    """An error in a trace or a state, with its place."""

    code: str
    message: str
    file: str | None
    line: int | None


class ViolationData(JsonPart, frozen=True, kw_only=True):
    """A violated rule and binding; ``step`` null if only the end decides.

    Of recorded traffic, ``time_s`` is the step's time, and ``by_default`` names what the rule reads
    and nothing supplies.
    """

    rule: str
    binding: Mapping[str, str]
    step: int | None
    strength: Literal["hard", "soft"]
    level: str | None
    weight: Number
    explanation: ExplanationData | UnsetType = UNSET
    time_s: float | UnsetType | None = UNSET
    by_default: Sequence[str] | UnsetType = UNSET


class TraceVerdict(JsonDocument, frozen=True, kw_only=True):
    """The verdict on a trace: does it keep every hard rule?"""

    trace: str
    satisfied: bool
    violations: Sequence[ViolationData]


class TraceNotJudged(JsonDocument, frozen=True, kw_only=True):
    """A trace that could not be judged; ``trace`` null without an id."""

    trace: str | None
    error: ErrorData


def as_json(
    verdict: Verdict, rulebook: CompiledRulebook, explained: Sequence[Explanation] = ()
) -> str:
    """Write a verdict; ``explained`` are explanations of its first violations."""
    rules = {rule.name: rule for rule in rulebook.rules}
    violations = [
        violation_data(
            violation,
            rules[violation.rule],
            explained[number] if number < len(explained) else None,
        )
        for number, violation in enumerate(verdict.violations)
    ]
    return as_line(
        TraceVerdict(trace=verdict.trace, satisfied=verdict.satisfied, violations=violations)
    )


def not_judged_as_json(answer: NotJudged) -> str:
    """Write why there is no verdict."""
    return as_line(TraceNotJudged(trace=answer.trace, error=error_data(answer.error)))


def violation_data(
    violation: Violation, rule: CompiledRule, explanation: Explanation | None
) -> ViolationData:
    """A violation with what its rule says of its weight."""
    return ViolationData(
        rule=violation.rule,
        binding=violation.binding,
        step=violation.step,
        strength=violation.strength,
        level=rule.level or None,
        weight=plain_number(rule.weight),
        explanation=UNSET if explanation is None else explanation_data(explanation),
    )


def error_data(error: RulecError) -> ErrorData:
    """The first diagnostic of an error."""
    diagnostic = error.diagnostics[0]
    place = diagnostic.place
    return ErrorData(
        code=diagnostic.code,
        message=diagnostic.message,
        file=place.file if place else None,
        line=place.line if place else None,
    )
