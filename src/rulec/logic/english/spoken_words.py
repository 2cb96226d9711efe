"""Atoms and quantities that bring the phrases of their vocabulary into sentences."""

from __future__ import annotations

import re
from collections.abc import Mapping
from dataclasses import dataclass, replace

from rulec.logic import formula as ltl

_FORMS = re.compile(r"\[([^\]|]*)\|([^\]]*)\]")

_JOINED = re.compile(r",| and | or ")


@dataclass(frozen=True, slots=True)
class SpokenAtom(ltl.Atom):
    """An atom with the clauses that say that it holds, and that it does not."""

    affirmed: str = ""
    denied: str = ""


@dataclass(frozen=True, slots=True)
class SpokenQuantity(ltl.QuantityTerm):
    """A quantity with the noun that it goes by."""

    noun: str = ""


def spoken_formula(formula: ltl.Formula, phrases: Mapping[str, str]) -> ltl.Formula:
    """The same formula, its atoms and quantities with their phrases, as far as there are any.

    A phrase is such as ``ego [is|is not] behind {}``, that of a quantity a noun.
    """
    match formula:
        case ltl.Unary() | ltl.Binary():
            return ltl.with_operands(formula, lambda operand: spoken_formula(operand, phrases))
        case ltl.Comparison(terms):
            spoken = tuple((factor, _spoken_term(term, phrases)) for factor, term in terms)
            return replace(formula, terms=spoken)
        case ltl.Atom(name, arguments, value):
            phrase = phrases.get(value or name)
            if phrase is None:
                return formula
            affirmed, denied = (_with_objects(form, arguments) for form in forms(phrase))
            return SpokenAtom(name, arguments, value, affirmed, denied)
    return formula


def forms(phrase: str) -> tuple[str, str]:
    """What a phrase says where the word holds, and where it does not."""
    return _FORMS.sub(r"\1", phrase), _FORMS.sub(r"\2", phrase)


def _spoken_term(term: ltl.Term, phrases: Mapping[str, str]) -> ltl.Term:
    if isinstance(term, ltl.Count):
        return replace(term, body=spoken_formula(term.body, phrases))
    phrase = phrases.get(term.name)
    if phrase is None:
        return term
    return SpokenQuantity(term.name, term.arguments, _with_objects(phrase, term.arguments))


def _with_objects(text: str, arguments: tuple[str, ...]) -> str:
    for argument in arguments:
        text = text.replace("{}", argument, 1)
    # Where clauses are joined, one that has an `and` of its own would be read as two.
    return f"“{text}”" if _JOINED.search(text) else text
