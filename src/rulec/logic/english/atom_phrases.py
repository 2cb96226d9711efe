"""Atoms, comparisons and bounds as phrases of plain English."""

from __future__ import annotations

import re
from collections.abc import Sequence
from fractions import Fraction
from typing import Literal

from rulec.logic.formula import Atom, Bound, Comparison, Count, QuantityTerm, Relation, Term
from rulec.logic.printing import number_in_words, term_text

_VERBS: dict[Relation, tuple[str, str]] = {
    "<": ("is less than", "is not less than"),
    "<=": ("is at most", "is not at most"),
    "=": ("is exactly", "is not exactly"),
    "!=": ("differs from", "does not differ from"),
    ">=": ("is at least", "is not at least"),
    ">": ("is more than", "is not more than"),
}

_COUNTED: dict[Relation, str] = {
    "<": "fewer than",
    "<=": "at most",
    "=": "exactly",
    "!=": "any number other than",
    ">=": "at least",
    ">": "more than",
}

_SIGN = re.compile(r"<=|>=|!=|<|>|=")

_MOST_PLACES = 12
"""A number with more decimal places is written as a fraction."""


def number_text(value: Fraction) -> str:
    """An exact number as a short decimal, or else a fraction."""
    return number_in_words(value) if 10**_MOST_PLACES % value.denominator == 0 else str(value)


def spoken(name: str) -> str:
    """A name in spoken words: ``in_front_of`` becomes three, ``R_cw`` stays."""
    several = re.fullmatch(r"[^\W\dA-Z_]+(_[^\W\dA-Z_]+)+", name)
    return name.replace("_", " ") if several else name


def listed(names: Sequence[str]) -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    return " and ".join(filter(None, [", ".join(names[:-1]), names[-1]]))


def of_objects(name: str, arguments: Sequence[str]) -> str:
    """``the station of v``, ``the surface``."""
    return f"the {spoken(name)}{f' of {listed(arguments)}' if arguments else ''}"


def atom_in_english(atom: Atom, *, holds: bool) -> str:
    """A clause stating that the atom holds, or not."""
    if atom.value is not None:
        verb = "is" if holds else "is not"
        return f"{of_objects(atom.name, atom.arguments)} {verb} “{spoken(atom.value)}”"
    of = f" of {listed(atom.arguments)}" if atom.arguments else ""
    return f"“{spoken(atom.name)}” {'holds' if holds else 'does not hold'}{of}"


def comparison_in_english(comparison: Comparison, *, holds: bool) -> str:
    """A clause stating that the comparison holds, or not."""
    text = comparison_text(comparison)
    signs = _SIGN.findall(text)
    terms = [term for _, term in comparison.terms]
    if len(signs) != 1 or any(isinstance(term, Count) for term in terms):
        return f"“{text}” {'is true' if holds else 'is not true'}"
    left, right = text.split(signs[0])
    verb = _VERBS[signs[0]][0 if holds else 1]
    return f"{_aloud(left.strip(), terms)} {verb} {_aloud(right.strip(), terms)}"


def _aloud(text: str, terms: Sequence[Term]) -> str:
    """Arithmetic with the quantities in it named in words."""
    for term in terms:
        if isinstance(term, QuantityTerm):
            written = re.compile(rf"(?<![\w.]){re.escape(term_text(term))}(?![\w(])")
            words = of_objects(term.name, term.arguments)
            text = written.sub(lambda _, words=words: words, text)  # type: ignore[misc]
    return text.replace(" * ", " times ")


def single_count(comparison: Comparison) -> Count | None:
    """The only count of a comparison with a number, or None."""
    match comparison.terms:
        case ((coefficient, Count() as count),) if coefficient == 1:
            return count
    return None


def counted(comparison: Comparison, count: Count) -> str:
    """The head of a counting clause: ``there are at least 8 ...``.

    In full ``there are at least 8 vehicles x for which``, to go on with the body.
    """
    match comparison.relation, comparison.limit:
        case ">=", Fraction(numerator=1, denominator=1):
            return f"there is a {spoken(count.type)} {count.variable} for which"
        case "=", Fraction(numerator=0):
            return f"there is no {spoken(count.type)} {count.variable} for which"
    one = comparison.limit == 1 and comparison.relation != "!="
    noun = spoken(count.type) if one else plural(spoken(count.type))
    amount = f"{_COUNTED[comparison.relation]} {number_text(comparison.limit)}"
    return f"there {'is' if one else 'are'} {amount} {noun} {count.variable} for which"


def plural(noun: str) -> str:
    """The plural of a type's name, by the rules for regular nouns."""
    if re.search(r"(s|x|ch|sh|z)$", noun):
        return f"{noun}es"
    return f"{noun[:-1]}ies" if re.search(r"[^aeiou]y$", noun) else f"{noun}s"


def comparison_text(comparison: Comparison) -> str:
    """The comparison's own text, or one made of its terms, without units."""
    if comparison.text:
        return comparison.text
    return f"{terms_text(comparison.terms)} {comparison.relation} {number_text(comparison.limit)}"


def terms_text(terms: Sequence[tuple[Fraction, Term]]) -> str:
    """``gap(v) - 0.5 * speed``."""
    text = ""
    for coefficient, term in terms:
        size = "" if abs(coefficient) == 1 else f"{number_text(abs(coefficient))} * "
        sign = "-" if coefficient < 0 else "+"
        joint = f" {sign} " if text else ("-" if coefficient < 0 else "")
        text += f"{joint}{size}{term_text(term)}"
    return text


def amount(value: Fraction, unit: Literal["s", "steps"]) -> str:
    """``3 s``, ``1 step``, ``2 steps``."""
    return f"{number_text(value)} {'step' if unit == 'steps' and value == 1 else unit}"


def span(bound: Bound, beyond: str) -> str:
    """A time span: ``from 1 s to 4 s later``. ``beyond`` is ``later`` or ``before``."""
    low = amount(bound.low, bound.unit)
    if bound.high is None:
        return f"{low} or more {beyond}"
    high = amount(bound.high, bound.unit)
    if bound.low == bound.high:
        return f"exactly {low} {beyond}"
    return f"up to {high} {beyond}" if not bound.low else f"from {low} to {high} {beyond}"


def lasting(bound: Bound) -> str:
    """A duration: ``for 1 s to 4 s``."""
    low = amount(bound.low, bound.unit)
    if bound.high is None:
        return f"for at least {low}"
    high = amount(bound.high, bound.unit)
    if bound.low == bound.high:
        return f"for exactly {low}"
    return f"for at most {high}" if not bound.low else f"for {low} to {high}"
