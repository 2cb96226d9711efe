"""Notes of findings on traces, and on questions that were left open."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.analysis.lint.finding_messages import NOT_DECIDED
from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.analysis.trace_literals import trace_literal
from rulec.diagnostics import Diagnostic
from rulec.rulebook.model import Rule
from rulec.trace import Trace
from rulec.witnesses.undecided import UndecidedError


def trace_note(what: str, trace: Trace, analyzed_rules: Sequence[AnalyzedRule]) -> tuple[str, ...]:
    """The note on a trace, in the words of these rules."""
    rules = [analyzed.rule for analyzed in analyzed_rules]
    return (f"{what}: {trace_literal(trace, rules, analyzed_rules[0].rulebook.vocabulary)}",)


def undecided_diagnostic(rule: Rule, what: str, problem: UndecidedError) -> Diagnostic:
    """The warning (R0807) that a question about a rule was left open."""
    return NOT_DECIDED.at(
        rule.span,
        f"not decided of rule `{rule.name}` whether {what}: {problem}",
        help="say less in one rule; rules beside each other are looked at one by one",
        severity="warning",
    )
