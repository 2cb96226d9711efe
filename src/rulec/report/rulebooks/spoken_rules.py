"""Rules whose sentences speak in the phrases of the vocabulary."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rulec.logic.english.spoken_words import spoken_formula
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.rulebook.vocabulary_phrases import phrases_of


def spoken_book(rulebook: Rulebook) -> Rulebook:
    """The rulebook with phrases in all that its rules require and except; they mean the same."""
    phrases = phrases_of(rulebook)
    if not phrases:
        return rulebook
    return replace(rulebook, rules=tuple(_spoken(rule, phrases) for rule in rulebook.rules))


def _spoken(rule: Rule, phrases: Mapping[str, str]) -> Rule:
    return replace(
        rule,
        formula=spoken_formula(rule.formula, phrases),
        required=None if rule.required is None else spoken_formula(rule.required, phrases),
        condition=None if rule.condition is None else spoken_formula(rule.condition, phrases),
        exemptions=tuple(
            replace(one, formula=spoken_formula(one.formula, phrases)) for one in rule.exemptions
        ),
    )
