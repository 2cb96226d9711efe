"""Atoms, comparisons, bounds and operators of time as phrases of plain English."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction
from typing import Literal

from rulec.logic.english.spoken_words import SpokenAtom, SpokenQuantity
from rulec.logic.formula import (
    Atom,
    BinaryOperator,
    Bound,
    Comparison,
    Count,
    QuantityTerm,
    Relation,
    Term,
    UnaryOperator,
)
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
    if isinstance(atom, SpokenAtom):
        return atom.affirmed if holds else atom.denied
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
            words = (
                term.noun
                if isinstance(term, SpokenQuantity)
                else of_objects(term.name, term.arguments)
            )
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
    how_far = _between(bound, "{} or more", "up to {}", "from {} to {}")
    return f"{how_far} {beyond}"


def lasting(bound: Bound) -> str:
    """A duration: ``for 1 s to 4 s``."""
    return f"for {_between(bound, 'at least {}', 'at most {}', '{} to {}')}"


def _between(bound: Bound, at_least: str, at_most: str, both: str) -> str:
    low = amount(bound.low, bound.unit)
    if bound.high is None:
        return at_least.format(low)
    high = amount(bound.high, bound.unit)
    if bound.low == bound.high:
        return f"exactly {low}"
    return both.format(low, high) if bound.low else at_most.format(high)


def adverb(operator: UnaryOperator, bound: Bound | None, *, inside: bool) -> str:
    """The words before what holds at another time, or at other times.

    ``inside``: they are not seen from the start of the trace, but from a time named before.
    """
    later = "later" if inside else "after the start"
    here = "that time" if inside else "the start"
    match operator, bound:
        case UnaryOperator.ALWAYS, None:
            return "from that time on always" if inside else "at all times"
        case UnaryOperator.ALWAYS, Bound():
            return f"at all times {span(bound, later)}"
        case UnaryOperator.NEVER, None:
            return f"{'from that time on ' if inside else ''}it never happens that"
        case UnaryOperator.NEVER, Bound():
            return f"at no time {span(bound, later)} does it happen that"
        case UnaryOperator.EVENTUALLY, None:
            return "at that time or later" if inside else "at some time"
        case UnaryOperator.EVENTUALLY, Bound():
            return f"at some time {span(bound, later)}"
        case UnaryOperator.NEXT, None:
            return "at the next moment"
        case UnaryOperator.NEXT, Bound():
            return span(bound, later)
        case UnaryOperator.WEAK_NEXT, None:
            return "at the next moment, if there is one,"
        case UnaryOperator.WEAK_NEXT, Bound():
            return f"{span(bound, later)}, if the trace lasts that long,"
        case UnaryOperator.ONCE, None:
            return f"at {here} or before"
        case UnaryOperator.ONCE, Bound():
            return f"at some time {span(bound, 'before')}"
        case UnaryOperator.HISTORICALLY, None:
            return f"up to {here} always"
        case UnaryOperator.HISTORICALLY, Bound():
            return f"at all times {span(bound, 'before')}"
        case UnaryOperator.PREVIOUSLY, None:
            return "at the moment before"
        case UnaryOperator.PREVIOUSLY, Bound():
            return span(bound, "before")
        case UnaryOperator.WEAK_PREVIOUSLY, None:
            return "at the moment before, if there was one,"
        case UnaryOperator.WEAK_PREVIOUSLY, Bound():
            return f"{span(bound, 'before')}, if the trace had begun,"
    raise AssertionError(f"{operator} is not about another time")


def pattern_of(operator: BinaryOperator, bound: Bound | None, *, inside: bool) -> str:
    """The pattern of a binary operator's phrase, left operand first."""
    later = "later" if inside else "after the start"
    when = "" if bound is None else f" at some time {span(bound, later)}"
    always = "at all times" if bound is None else f"at all times {span(bound, later)}"
    end = None if bound is None or bound.high is None else bound.high
    first = "" if bound is None or end is None else span(replace(bound, low=end * 0), later)
    match operator:
        case BinaryOperator.UNTIL if bound is None:
            return "{} until, sooner or later, {}"
        case BinaryOperator.UNTIL:
            return f"{{}} until,{when}, {{}}"
        case BinaryOperator.WEAK_UNTIL:
            ever = f"at all times {first}" if first else "for ever"
            return f"{{}} {ever}, or only until,{when or ' at some time'}, {{}}"
        case BinaryOperator.RELEASE:
            return f"unless released before by a moment at which {{}}, {always} {{}}"
        case BinaryOperator.STRONG_RELEASE:
            come = f", which must come {first}," if first else ", which must come,"
            return f"unless released before by a moment{come} at which {{}}, {always} {{}}"
        case BinaryOperator.SINCE:
            before = "" if bound is None else f" a moment {span(bound, 'before')} at which"
            return f"{{}} ever since{before} {{}}"
    raise ValueError(f"{operator} is no operator of time with a phrase")
