"""Atoms and quantities that carry their vocabulary's phrases for use in sentences."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from rulec.logic import formula as ltl
from rulec.logic.formula import with_terms
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.language import Language

_FORMS = re.compile(r"\[([^\]|]*)\|([^\]]*)\]")


@dataclass(frozen=True, slots=True)
class SpokenAtom(ltl.Atom):
    """An atom with the clauses for when it holds and when it does not."""

    affirmed: str = ""
    denied: str = ""


@dataclass(frozen=True, slots=True)
class SpokenQuantity(ltl.QuantityTerm):
    """A quantity with the noun that names it."""

    noun: str = ""


def spoken_formula(
    formula: ltl.Formula, phrases: Mapping[str, str], language: Language = ENGLISH
) -> ltl.Formula:
    """The same formula, with phrases added to its atoms and quantities where there are any.

    A phrase is, for example, ``ego [is|is not] behind {}``; for a quantity it is a noun.
    """
    match formula:
        case ltl.Unary() | ltl.Binary():
            return ltl.with_operands(formula, lambda part: spoken_formula(part, phrases, language))
        case ltl.Comparison():
            return with_terms(formula, lambda term: spoken_term(term, phrases, language))
        case ltl.Atom(name, arguments, value):
            phrase = phrases.get(value or name)
            if phrase is None:
                return formula
            affirmed, denied = (_with_objects(form, arguments, language) for form in forms(phrase))
            return SpokenAtom(name, arguments, value, affirmed, denied)
    return formula


def forms(phrase: str) -> tuple[str, str]:
    """The phrase's text where the word holds, and its text where it does not."""
    return _FORMS.sub(r"\1", phrase), _FORMS.sub(r"\2", phrase)


def spoken_term(term: ltl.Term, phrases: Mapping[str, str], language: Language) -> ltl.Term:
    """The same number with its phrase, if there is one."""
    if isinstance(term, ltl.Count):
        return replace(term, body=spoken_formula(term.body, phrases, language))
    phrase = phrases.get(term.name)
    if phrase is None:
        return term
    noun = _with_objects(phrase, term.arguments, language)
    return SpokenQuantity(term.name, term.arguments, noun)


def _with_objects(text: str, arguments: tuple[str, ...], language: Language) -> str:
    for argument in arguments:
        text = text.replace("{}", argument, 1)
    # Without quotation marks, a clause containing `and` would be read as two of the joined clauses.
    return language.quoted.format(text) if language.inner_joints.search(text) else text
