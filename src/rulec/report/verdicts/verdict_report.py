"""Verdicts on traces as text."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.logic.printing import number_in_words
from rulec.monitoring.explain.explanation import Explanation
from rulec.monitoring.verdict import Verdict, Violation
from rulec.report.text.terminal_text import styled, visible
from rulec.report.verdicts import violation_table

MOST_VIOLATIONS = 20
"""So many are shown for a trace; JSON has them all."""


def as_text(
    verdict: Verdict,
    rulebook: CompiledRulebook,
    explained: Sequence[Explanation] = (),
    *,
    every_part: bool = False,
    width: int = violation_table.WIDTH,
) -> str:
    """Write a trace's violations, a line each, below its name.

    ``explained`` are explanations of the first violations; each follows its line, folded to a
    ``width`` unless ``every_part`` of it is wanted.
    """
    if not verdict.violations:
        return f"{visible(verdict.trace)}: {styled('satisfied', 'green')}"
    word = (
        styled("satisfied, but for soft rules", "yellow")
        if verdict.satisfied
        else styled("violated", "red")
    )
    rules = {rule.name: rule for rule in rulebook.rules}
    lines = [f"{visible(verdict.trace)}: {word}"]
    shown = verdict.violations[:MOST_VIOLATIONS]
    for number, violation in enumerate(shown):
        line = in_a_line(violation, rules[violation.rule], rulebook.name)
        lines.append(f"  {visible(line)}")
        if number < len(explained):
            lines.append(
                violation_table.as_text(explained[number], every_part=every_part, width=width)
            )
    if len(verdict.violations) > len(shown):
        lines.append(f"  and {len(verdict.violations) - len(shown):,} more; --json has them all")
    return "\n".join(lines)


def in_a_line(violation: Violation, rule: CompiledRule, rulebook: str) -> str:
    """The violated rule of ``rulebook``, its binding and its time."""
    where = ", ".join(f"{name} = {item}" for name, item in violation.binding.items())
    when = (
        "not fulfilled when the trace ends"
        if violation.step is None
        else f"cannot be kept any more after state {violation.step}"
    )
    about = f" for {where}" if where else ""
    return f"{rule.strength} rule {_title(rule, rulebook)}{about}: {when}"


def _title(rule: CompiledRule, rulebook: str) -> str:
    """The rule's name with level and weight unless default, and its place."""
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
