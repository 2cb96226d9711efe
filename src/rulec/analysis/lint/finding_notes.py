"""Notes of findings on traces, and on questions that were left open."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.analysis.shared_compilation import AnalyzedRule
from rulec.analysis.trace_literals import trace_literal
from rulec.trace import Trace


def trace_note(what: str, trace: Trace, analyzed_rules: Sequence[AnalyzedRule]) -> tuple[str, ...]:
    """The note on a trace, in the words of these rules."""
    rules = [analyzed.rule for analyzed in analyzed_rules]
    return (f"{what}: {trace_literal(trace, rules, analyzed_rules[0].rulebook.vocabulary)}",)
