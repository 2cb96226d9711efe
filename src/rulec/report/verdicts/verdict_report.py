"""Verdicts as text for people and as JSON for machines."""

from __future__ import annotations

import json
from collections.abc import Sequence
from typing import Any

import click

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.diagnostics import RulecError
from rulec.logic.printing import number_in_words
from rulec.monitoring.explain.explanation import Explanation
from rulec.monitoring.verdict import NotJudged, Verdict, Violation
from rulec.report.findings.source_excerpt import visible
from rulec.report.verdicts import violation_table

MOST_VIOLATIONS = 20
"""So many are shown for a trace; JSON has them all."""

_ENCODE = json.JSONEncoder(ensure_ascii=False).encode


def as_json(
    verdict: Verdict, rulebook: CompiledRulebook, explained: Sequence[Explanation] = ()
) -> str:
    """One line of JSON for a trace, as docs/traces.md describes it.

    ``explained`` are explanations of the first violations, which get a field of their own.
    """
    rules = {rule.name: rule for rule in rulebook.rules}
    violations = [_as_data(violation, rules[violation.rule]) for violation in verdict.violations]
    for violation, why in zip(violations, explained, strict=False):
        violation["explanation"] = violation_table.as_data(why)
    return _ENCODE(
        {"trace": verdict.trace, "satisfied": verdict.satisfied, "violations": violations}
    )


def _as_data(violation: Violation, rule: CompiledRule) -> dict[str, Any]:
    whole = rule.weight.denominator == 1
    return {
        "rule": violation.rule,
        "binding": dict(violation.binding),
        "step": violation.step,
        "strength": violation.strength,
        "level": rule.level or None,
        "weight": int(rule.weight) if whole else float(rule.weight),
    }


def not_judged_as_json(answer: NotJudged) -> str:
    """One line of JSON for a trace that could not be judged; ``trace`` is null if it has no id."""
    return _ENCODE({"trace": answer.trace, "error": error_as_data(answer.error)})


def error_as_data(error: RulecError) -> dict[str, Any]:
    """What is wrong with a trace or a state, and where."""
    diagnostic = error.diagnostics[0]
    place = diagnostic.place
    return {
        "code": diagnostic.code,
        "message": diagnostic.message,
        "file": place.file if place else None,
        "line": place.line if place else None,
    }


def as_text(
    verdict: Verdict,
    rulebook: CompiledRulebook,
    explained: Sequence[Explanation] = (),
    *,
    every_part: bool = False,
) -> str:
    """The violations of a trace, a line each, below a line that names the trace.

    ``explained`` are explanations of the first violations; each follows its line, folded unless
    ``every_part`` of it is wanted.
    """
    if not verdict.violations:
        return f"{visible(verdict.trace)}: {click.style('satisfied', fg='green')}"
    word = (
        click.style("satisfied, but for soft rules", fg="yellow")
        if verdict.satisfied
        else click.style("violated", fg="red")
    )
    rules = {rule.name: rule for rule in rulebook.rules}
    lines = [f"{visible(verdict.trace)}: {word}"]
    shown = verdict.violations[:MOST_VIOLATIONS]
    for number, violation in enumerate(shown):
        line = in_a_line(violation, rules[violation.rule], rulebook.name)
        lines.append(f"  {visible(line)}")
        if number < len(explained):
            lines.append(violation_table.as_text(explained[number], every_part=every_part))
    if len(verdict.violations) > len(shown):
        lines.append(f"  and {len(verdict.violations) - len(shown):,} more; --json has them all")
    return "\n".join(lines)


def in_a_line(violation: Violation, rule: CompiledRule, rulebook: str) -> str:
    """Which rule is violated for whom and when; ``rulebook`` is the name of the one that judged."""
    where = ", ".join(f"{name} = {item}" for name, item in violation.binding.items())
    when = (
        "not fulfilled when the trace ends"
        if violation.step is None
        else f"cannot be kept any more after state {violation.step}"
    )
    about = f" for {where}" if where else ""
    return f"{rule.strength} rule {_title(rule, rulebook)}{about}: {when}"


def _title(rule: CompiledRule, rulebook: str) -> str:
    """The rule as its head says it, as far as it says more than every other rule, and where."""
    title, place = rule.name, rule.cite
    if rule.level:
        title += f" in {rule.level}"
    if rule.strength == "soft" and rule.weight != 1:
        title += f" weight {number_in_words(rule.weight)}"
    if rule.book and rule.book != rulebook:
        place = f"{rule.book}, {place}" if place else rule.book
    return f"{title} [{place}]" if place else title


def summary(satisfied: int, violated: int, not_judged: int) -> str:
    """The line that ends a run."""
    total = satisfied + violated + not_judged
    parts = [f"{satisfied:,} satisfied", f"{violated:,} violated"]
    if not_judged:
        parts.append(f"{not_judged:,} not judged")
    return f"{total:,} {'trace' if total == 1 else 'traces'}: {', '.join(parts)}"
