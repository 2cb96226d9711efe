"""Provenance of a rule in a chain of rulebooks, in few words."""

from __future__ import annotations

from rulec.analysis.lineage.rule_lineage import BookLineage, LineageStep, RuleHistory


def provenance(rule_history: RuleHistory, inherited: BookLineage) -> str:
    """Provenance of a rule in a chain's last book: own, inherited, overriding, gone; and why."""
    book, last = inherited.book, rule_history.last
    open_law = ", not confirmed" if inherited.inherited_from(rule_history) else ""
    because = f"{open_law}, because {last.because}" if last.because else open_law
    here = last.book == book
    base = rule_history.steps[-2].book if len(rule_history.steps) > 1 else ""
    match last.deed:
        case "declared":
            return "own" if here else f"inherited from {last.book}{because}"
        case "overridden" if here:
            return f"overrides {base}: {_clauses(last)}{because}"
        case "overridden":
            return f"inherited from {last.book}, which overrides {base}: {_clauses(last)}{because}"
        case "confirmed" if here:
            return f"confirms {base}: {_clauses(last)}"
        case "confirmed":
            return f"inherited from {last.book}, which confirms {base}: {_clauses(last)}{because}"
        case "softened":
            return f"softened{'' if here else f' by {last.book}'}{because}"
        case "dropped":
            return f"dropped{'' if here else f' by {last.book}'}{because}"
        case "silent":
            return f"silent{'' if here else f', as {last.book} is'}{because}"


def _clauses(step: LineageStep) -> str:
    return ", ".join(step.clauses) if step.clauses else "nothing changes"
