"""The provenance of a rule in a chain of rulebooks, in a few words."""

from __future__ import annotations

from rulec.analysis.lineage.rule_lineage import BookLineage, LineageStep, RuleHistory
from rulec.report.rulebooks.document_language import IN_ENGLISH, DocumentLanguage


def provenance(
    rule_history: RuleHistory, inherited: BookLineage, words: DocumentLanguage = IN_ENGLISH
) -> str:
    """How a chain's last book has a rule: own, inherited, overridden or dropped; and why."""
    say = words.say
    book, last = inherited.book, rule_history.last
    open_law = say(", not confirmed") if inherited.inherited_from(rule_history) else ""
    because = open_law + say(", because {}", last.because) if last.because else open_law
    here = last.book == book
    base = rule_history.steps[-2].book if len(rule_history.steps) > 1 else ""
    clauses = _clauses(last, words)
    match last.deed:
        case "declared":
            return say("own") if here else say("inherited from {}", last.book) + because
        case "overridden" if here:
            return say("overrides {}: {}", base, clauses) + because
        case "overridden":
            how = say("inherited from {}, which overrides {}: {}", last.book, base, clauses)
            return how + because
        case "confirmed" if here:
            return say("confirms {}: {}", base, clauses)
        case "confirmed":
            how = say("inherited from {}, which confirms {}: {}", last.book, base, clauses)
            return how + because
        case "softened":
            return (say("softened") if here else say("softened by {}", last.book)) + because
        case "dropped":
            return (say("dropped") if here else say("dropped by {}", last.book)) + because
        case "silent":
            return (say("silent") if here else say("silent, as {} is", last.book)) + because


def _clauses(step: LineageStep, words: DocumentLanguage) -> str:
    return ", ".join(step.clauses) if step.clauses else words.say("nothing changes")
