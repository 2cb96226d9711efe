"""Provenance of a rule in a chain of rulebooks, in few words."""

from __future__ import annotations

from rulec.analysis.lineage.rule_lineage import LineageStep, RuleHistory


def provenance(rule_history: RuleHistory, book: str) -> str:
    """Provenance of a rule in ``book`` (own, inherited, overriding, gone), with reason."""
    last = rule_history.last
    because = f", because {last.because}" if last.because else ""
    here = last.book == book
    base = rule_history.steps[-2].book if len(rule_history.steps) > 1 else ""
    match last.deed:
        case "declared":
            return "own" if here else f"inherited from {last.book}"
        case "overridden" if here:
            return f"overrides {base}: {_clauses(last)}"
        case "overridden":
            return f"inherited from {last.book}, which overrides {base}: {_clauses(last)}"
        case "softened":
            return f"softened{'' if here else f' by {last.book}'}{because}"
        case "dropped":
            return f"dropped{'' if here else f' by {last.book}'}{because}"
        case "silent":
            return f"silent{'' if here else f', as {last.book} is'}{because}"


def _clauses(step: LineageStep) -> str:
    return ", ".join(step.clauses) if step.clauses else "nothing changes"
