"""Answers about a rule that need a compiler: examples, sentence, parent."""

from __future__ import annotations

from dataclasses import dataclass, replace

from rulec.api import lazy_imports as lazy
from rulec.extraction.tellable_words import TELLABLE_WORDS
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.trace.vocabulary_projection import with_told_values

COMMONROAD = "commonroad"

_WIDTH = 100
"""The width of texts in characters."""


@dataclass(frozen=True, slots=True)
class ExampleAnswer:
    """The results of a rule's examples, and examples that are missing.

    ``lacking`` are the words without which CommonRoad's recordings cannot judge the rule.
    """

    passed: int
    failing: tuple[str, ...]
    missing: tuple[str, ...]
    lacking: tuple[str, ...]

    def in_words(self, rule: str) -> str:
        """One sentence each on examples, edges and recordings."""
        total = self.passed + len(self.failing)
        text = [f"{rule}: {self.passed} of {total} examples pass"]
        if self.failing:
            text.append(f"failing: {', '.join(self.failing)}")
        if self.missing:
            text.append(f"untested edges: {len(self.missing)}, the first one by\n{self.missing[0]}")
        if self.lacking:
            text.append(f"not judgeable from CommonRoad, which lacks {', '.join(self.lacking)}")
        return "\n".join(text)


@dataclass(frozen=True, slots=True)
class ParentAnswer:
    """A rule compared with that of the rulebook that this one extends, with a witness in words."""

    relation: str
    parent: str
    text: str


def example_answer(book: Rulebook, rule: Rule) -> ExampleAnswer:
    """Run the examples of a rule and find what they do not cover. Raises RulecError."""
    alone = replace(book, rules=(rule,))
    compiled = lazy.compile_rulebook(alone)
    run = lazy.run_rulebook_examples(alone, compiled)
    seen = lazy.example_coverage.coverage(run) if rule.examples else ()
    words = with_told_values(TELLABLE_WORDS[COMMONROAD], compiled.vocabulary)
    words |= lazy.told_types(COMMONROAD, compiled.vocabulary)
    audited = lazy.audit_source(compiled, COMMONROAD, words)
    return ExampleAnswer(
        sum(outcome.passed for outcome in run.outcomes),
        tuple(outcome.name for outcome in run.outcomes if not outcome.passed),
        tuple(
            example
            for witness in seen
            for example in lazy.missing_examples(witness, compiled.vocabulary)
        ),
        audited.rules[0].lacking,
    )


def english(book: Rulebook, rule: Rule) -> str:
    """A rule in plain English."""
    return lazy.rule_page.summary(rule, book, _WIDTH)


def parent_answer(book: Rulebook, parent: Rulebook, rule: str) -> ParentAnswer:
    """Whether a rule is stricter or laxer than its parent. Raises RulecError."""
    diff = lazy.diff_rulebooks(first=book, second=parent, patterns=(rule,))
    relation = diff.pairs[0].comparison.relation if diff.pairs else "of its own"
    return ParentAnswer(relation, parent.name, lazy.diff_text.as_text(diff, _WIDTH))
