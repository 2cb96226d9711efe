"""Atoms, comparisons, bounds and temporal operators as phrases of plain language."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from types import MappingProxyType
from typing import Literal

from rulec.logic import formula as ltl
from rulec.logic.one_point import is_none, is_some
from rulec.logic.printing import term_text
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.language import Language, SpanWords, alternative
from rulec.logic.sentences.spoken_words import SpokenAtom, SpokenQuantity

_FROM_ZERO = re.compile(r"(?<![\w.,])0 (\S+) - (\d[\d.,]*) \1(?!\S)")
"""A negative amount as rules write it, such as ``0 m/s^2 - 0.5 m/s^2``."""

_SIGN = re.compile(r"<=|>=|!=|<|>|=")


def number_text(value: Fraction, language: Language = ENGLISH) -> str:
    """An exact number as a short decimal, or else a fraction."""
    return language.number(value)


def spoken(name: str) -> str:
    """A name in spoken words: ``in_front_of`` becomes "in front of", ``R_cw`` stays."""
    several = re.fullmatch(r"[^\W\dA-Z_]+(_[^\W\dA-Z_]+)+", name)
    return name.replace("_", " ") if several else name


def listed(names: Sequence[str], language: Language = ENGLISH) -> str:
    """``a``, ``a and b``, ``a, b and c``."""
    return f" {language.and_} ".join(filter(None, [", ".join(names[:-1]), names[-1]]))


def of_objects(name: str, arguments: Sequence[str], language: Language = ENGLISH) -> str:
    """``the station of v``, ``the surface``."""
    if not arguments:
        return language.the_name.format(spoken(name))
    return language.the_name_of.format(spoken(name), listed(arguments, language))


def atom_clause(atom: ltl.Atom, language: Language, *, holds: bool) -> str:
    """A clause stating that the atom holds, or that it does not."""
    if isinstance(atom, SpokenAtom):
        return atom.affirmed if holds else atom.denied
    if atom.value is not None:
        name = of_objects(atom.name, atom.arguments, language)
        return language.value[not holds].format(name, spoken(atom.value))
    if " " in atom.name:
        return language.atom[not holds].format(str(atom))
    if not atom.arguments:
        return language.atom[not holds].format(spoken(atom.name))
    of = listed(atom.arguments, language)
    return language.atom_of[not holds].format(spoken(atom.name), of)


_NO_COUNTS: Mapping[ltl.Count, str] = MappingProxyType({})


def comparison_clause(
    comparison: ltl.Comparison,
    language: Language,
    bodies: Mapping[ltl.Count, str] = _NO_COUNTS,
    *,
    holds: bool,
) -> str:
    """A clause stating that the comparison holds, or that it does not.

    ``bodies`` has a clause for what each of its counts is about, if there is one.
    """
    whole = text = comparison_text(comparison)
    terms = [term for _, term in comparison.terms]
    counts = [term for term in terms if isinstance(term, ltl.Count)]
    # What is counted may be compared, too: its signs are not those of this comparison.
    for number, count in enumerate(counts):
        text = text.replace(term_text(count), _counted_at(number))
    signs = _SIGN.findall(text)
    if len(signs) != 1 or not all(_is_spoken(text, n, bodies, counts) for n in range(len(counts))):
        return language.truth[not holds].format(whole)
    left, right = (_aloud(side.strip(), terms, language) for side in text.split(signs[0]))
    clause = language.relations[signs[0]][not holds].format(left, right)
    for number, count in enumerate(counts):
        plural = language.type_of(count.type, spoken(count.type)).plural
        noun = language.number_of.format(plural, count.variable, bodies[count])
        clause = clause.replace(_counted_at(number), noun)
    return clause


def _counted_at(number: int) -> str:
    """The placeholder for a comparison's n-th count."""
    return chr(0xF000 + number)


def _is_spoken(
    text: str, number: int, bodies: Mapping[ltl.Count, str], counts: Sequence[ltl.Count]
) -> bool:
    return _counted_at(number) in text and counts[number] in bodies


def _aloud(text: str, terms: Sequence[ltl.Term], language: Language) -> str:
    """An arithmetic text with its quantities named in words."""
    nouns = {
        term_text(term): (
            term.noun
            if isinstance(term, SpokenQuantity)
            else of_objects(term.name, term.arguments, language)
        )
        for term in terms
        if isinstance(term, ltl.QuantityTerm)
    }
    text = _FROM_ZERO.sub(r"-\2 \1", language.decimals(text))
    if nouns:  # Replaced in one pass: a noun may contain another quantity's name.
        written = "|".join(re.escape(name) for name in sorted(nouns, key=len, reverse=True))
        text = re.sub(rf"(?<![\w.])(?:{written})(?![\w(])", lambda name: nouns[name[0]], text)
    return text.replace(" * ", f" {language.times} ")


def counted(comparison: ltl.Comparison, count: ltl.Count, language: Language) -> str:
    """The head of a counting clause: ``there are at least 8 ...``.

    In full ``there are at least 8 vehicles x for which``, to be followed by the body.
    """
    words = language.type_of(count.type, spoken(count.type))
    if is_none(comparison):
        return language.there_is_no.format(words.none, count.variable)
    if is_some(comparison):
        return language.there_is.format(words.one, count.variable)
    is_one = comparison.limit == 1 and comparison.relation != "!="
    n = language.counted[comparison.relation].format(number_text(comparison.limit, language))
    there = language.there_is if is_one else language.there_are
    return there.format(f"{n} {words.noun if is_one else words.plural}", count.variable)


def comparison_text(comparison: ltl.Comparison) -> str:
    """The comparison's own text, or else one built from its terms, without units."""
    if comparison.text:
        return comparison.text
    return f"{terms_text(comparison.terms)} {comparison.relation} {number_text(comparison.limit)}"


def terms_text(terms: Sequence[tuple[Fraction, ltl.Term]]) -> str:
    """``gap(v) - 0.5 * speed``."""
    text = ""
    for coefficient, term in terms:
        size = "" if abs(coefficient) == 1 else f"{number_text(abs(coefficient))} * "
        sign = "-" if coefficient < 0 else "+"
        joint = f" {sign} " if text else ("-" if coefficient < 0 else "")
        text += f"{joint}{size}{term_text(term)}"
    return text


def amount(value: Fraction, unit: Literal["s", "steps"], language: Language = ENGLISH) -> str:
    """``3 s``, ``1 step``, ``2 steps``."""
    steps = language.step if value == 1 else language.steps
    return f"{number_text(value, language)} {steps if unit == 'steps' else unit}"


def span(bound: ltl.Bound, beyond: str, language: Language) -> str:
    """A time span: ``from 1 s to 4 s later``. ``beyond`` is the word for later or before."""
    return f"{_between(bound, language.span, language)} {beyond}"


def lasting(bound: ltl.Bound, language: Language) -> str:
    """A duration: ``for 1 s to 4 s``."""
    return _between(bound, language.lasting, language)


def _between(bound: ltl.Bound, words: SpanWords, language: Language) -> str:
    low = amount(bound.low, bound.unit, language)
    if bound.high is None:
        return words.at_least.format(low)
    high = amount(bound.high, bound.unit, language)
    if bound.low == bound.high:
        return words.exactly.format(low)
    return words.between.format(low, high) if bound.low else words.at_most.format(high)


_PAST = (
    ltl.UnaryOperator.ONCE,
    ltl.UnaryOperator.HISTORICALLY,
    ltl.UnaryOperator.PREVIOUSLY,
    ltl.UnaryOperator.WEAK_PREVIOUSLY,
)


def adverb(
    operator: ltl.UnaryOperator, bound: ltl.Bound | None, language: Language, *, inside: bool
) -> str:
    """The words before a condition at another time, or at other times.

    ``inside``: the time is relative to a time named before, not to the start of the trace.
    """
    words = language.adverbs[operator]
    if bound is None:
        return alternative(words, 2 if inside else 1)
    later = language.later if inside else language.after_start
    beyond = language.before if operator in _PAST else later
    return alternative(words, 0).format(span(bound, beyond, language))


def pattern_of(
    operator: ltl.BinaryOperator, bound: ltl.Bound | None, language: Language, *, inside: bool
) -> str:
    """The pattern of a binary operator's phrase, with placeholders for its two sides."""
    words = language.binary[operator]
    places = {"left": "{}", "right": "{}"}
    if bound is None:
        return alternative(words, 0).format(**places)
    beyond = language.later if inside else language.after_start
    if operator is ltl.BinaryOperator.SINCE:
        beyond = language.before
    here = span(bound, beyond, language)
    first = "" if bound.high is None else span(replace(bound, low=Fraction(0)), beyond, language)
    endless = bound.high is None
    return alternative(words, 1 + endless).format(span=here, first=first, **places)
