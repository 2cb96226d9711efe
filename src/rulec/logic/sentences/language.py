"""The words and patterns that the sentences of a language are built from."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, TypeAlias, get_args

from rulec.logic.formula import BinaryOperator, Relation, UnaryOperator
from rulec.logic.printing import number_in_words

LanguageCode: TypeAlias = Literal["en", "de", "fr"]

LANGUAGES: tuple[LanguageCode, ...] = get_args(LanguageCode)
"""The languages of sentences and documents, by their ISO 639 codes."""

Pair: TypeAlias = tuple[str, str]
"""The text where something holds, and the text where it does not."""

_MOST_PLACES = 12
"""Numbers with more decimal places are written as fractions."""

_DECIMAL_POINT = re.compile(r"(?<=\d)\.(?=\d)")


@dataclass(frozen=True, slots=True)
class TypeWords:
    """The words for objects of a type.

    ``every`` one, every ``other`` one, ``one``, ``none``; ``noun`` and ``plural`` follow a number.
    """

    every: str
    other: str
    one: str
    none: str
    noun: str
    plural: str


@dataclass(frozen=True, slots=True)
class SpanWords:
    """Patterns of durations: at least, at most, between two, exactly."""

    at_least: str
    at_most: str
    between: str
    exactly: str


@dataclass(frozen=True, slots=True, kw_only=True)
class Language:
    """The words and patterns of a language; ``{}`` is a placeholder.

    In ``adverbs``, ``[a|b|c]`` are for a condition at other times: with a time span, relative to
    the start of the trace, relative to a time named before; the last one stands for what is
    missing. Likewise in ``binary``: without a bound, with one, with one that has no upper end.

    There is no comma after a lead that ends with one of ``no_pause_after``, nor before a clause
    that begins with one of ``runs_on``.
    """

    code: LanguageCode
    semicolon: str = ";"
    decimal_mark: Literal[".", ","] = "."
    quoted: str
    inner_joints: re.Pattern[str]
    """Matches phrases that need quotation marks within a list of clauses."""
    no_pause_after: tuple[str, ...]
    runs_on: tuple[str, ...]
    and_: str
    or_: str
    then: str

    the_name: str
    the_name_of: str
    value: Pair
    value_is: str
    atom: Pair
    constants: Pair
    atom_of: Pair
    truth: Pair
    same: Pair
    kind: Pair
    relations: Mapping[Relation, Pair]
    times: str

    counted: Mapping[Relation, str]
    there_is: str
    there_is_no: str
    there_are: str
    number_of: str
    type_words: TypeWords
    plural: Callable[[str], str] = str
    types: Mapping[str, TypeWords] = field(default_factory=dict)
    for_every: str

    step: str
    steps: str
    span: SpanWords
    later: str
    after_start: str
    before: str
    lasting: SpanWords

    at_start: str
    there_at_start: str
    stretches: Mapping[str, str]
    exempt: str
    counts_only: str
    counts_never: str
    not_so: str
    adverbs: Mapping[UnaryOperator, str]
    binary: Mapping[BinaryOperator, str]
    iff: str
    xor: str
    implies: str
    means: str
    where: str
    either: str
    both: str
    all_: str
    both_of: str
    all_of: str
    one_of: str
    none_of: str
    phase_line: str
    phase: str
    phase_joint: str
    lasting_phase: str
    lasting_item: str
    phases: str

    def number(self, value: Fraction) -> str:
        """An exact number as a short decimal, or else a fraction."""
        short = 10**_MOST_PLACES % value.denominator == 0
        return self.decimals(number_in_words(value) if short else str(value))

    def decimals(self, text: str) -> str:
        """A text with this language's decimal mark in its numbers."""
        if self.decimal_mark == ".":
            return text
        return _DECIMAL_POINT.sub(self.decimal_mark, text)

    def type_of(self, name: str, noun: str) -> TypeWords:
        """The words for a type, built from its ``noun`` if the language has none of its own."""
        known = self.types.get(name)
        if known is not None:
            return known
        own = self.type_words
        return TypeWords(
            every=own.every.format(noun),
            other=own.other.format(noun),
            one=own.one.format(noun),
            none=own.none.format(noun),
            noun=own.noun.format(noun),
            plural=own.plural.format(self.plural(noun)),
        )


def alternative(pattern: str, number: int) -> str:
    """A pattern with the alternative of this number, or the last one, at each ``[a|b]``."""

    def chosen(alternatives: re.Match[str]) -> str:
        each = alternatives[1].split("|")
        return each[min(number, len(each) - 1)]

    return re.sub(r"\[([^\]]*)\]", chosen, pattern)
