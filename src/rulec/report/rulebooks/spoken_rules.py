"""Rules whose sentences use the phrases of the vocabulary."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rulec.logic.formula import Formula
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.language import Language
from rulec.logic.sentences.spoken_words import spoken_formula
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.rulebook.vocabulary_phrases import phrases_of


def spoken_book(rulebook: Rulebook, language: Language = ENGLISH) -> Rulebook:
    """The rulebook with phrases in its rules' requirements and exceptions; the meaning stays."""
    phrases = phrases_of(rulebook, language.code)
    if not phrases:
        return rulebook
    return replace(
        rulebook, rules=tuple(_spoken(rule, phrases, language) for rule in rulebook.rules)
    )


def _spoken(rule: Rule, phrases: Mapping[str, str], language: Language) -> Rule:
    def spoken(formula: Formula) -> Formula:
        return spoken_formula(formula, phrases, language)

    return replace(
        rule,
        formula=spoken(rule.formula),
        required=None if rule.required is None else spoken(rule.required),
        condition=None if rule.condition is None else spoken(rule.condition),
        exemptions=tuple(
            replace(exemption, formula=spoken(exemption.formula)) for exemption in rule.exemptions
        ),
    )
