"""A rule in the sentences of a language, with the phrases of its vocabulary."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from string import ascii_uppercase

from rulec.logic.fold import fold_constants
from rulec.logic.formula import Atom, Calculated, Constant, Count, Formula, Unary, UnaryOperator
from rulec.logic.free_names import names_in, reads_in, rename_variables, variables_of
from rulec.logic.one_point import plain, replaced
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.language import Language
from rulec.logic.sentences.sentence import (
    Phrase,
    Shape,
    condition,
    exemption,
    meaning,
    phrase,
    sentence,
)
from rulec.logic.sentences.spoken_words import spoken_formula
from rulec.logic.sentences.wording import listed, spoken
from rulec.rulebook.rulebook_model import Rule, Rulebook
from rulec.rulebook.vocabulary_phrases import phrases_of

MOST_LEVELS = 3
"""Lists nested deeper are said below, by the names of definitions, or by letters."""


@dataclass(frozen=True, slots=True)
class RuleSentences:
    """What a rule requires, when it counts and does not, and what the names in these mean."""

    requirement: Phrase
    restrictions: tuple[Phrase, ...]
    definitions: tuple[Phrase, ...]

    @property
    def every(self) -> tuple[Phrase, ...]:
        """All of them, in the order in which they are said."""
        return (self.requirement, *self.restrictions, *self.definitions)


def sentences_of(rule: Rule, rulebook: Rulebook, language: Language = ENGLISH) -> RuleSentences:
    """The sentences of one of a rulebook's rules, of at most ``MOST_LEVELS`` levels each.

    What options exclude is not mentioned.
    """
    return _Speaker(rule, rulebook, language).sentences()


class _Speaker:
    """Says one rule; ``_names`` and ``_letters`` are said in the place of parts of its formulas.

    The keys of ``_letters`` are in the form in which they are said.
    """

    def __init__(self, rule: Rule, rulebook: Rulebook, language: Language) -> None:
        self._rule, self._language = rule, language
        self._phrases = phrases_of(rulebook, language.code)
        self._fits = rulebook.vocabulary.is_subtype
        self._meanings = rulebook.vocabulary.meanings
        self._own = {variable.name: variable.type for variable in rule.variables}
        self._kinds = {**counted_in(rule.formula), **self._own}
        self._names: dict[Formula, Atom] = {}
        self._letters: dict[Formula, Atom] = {}

    def sentences(self) -> RuleSentences:
        """The sentences, with the names that their levels require."""
        said = self._said()
        if any(True for _ in _too_deep(said)):
            known = ((use, fold_constants(part)) for use, part in self._rule.defined)
            self._names = {part: self._name(use) for use, part in known if self._is_long(part)}
            said = self._said()
        while deep := dict.fromkeys(_too_deep(said)):
            for part in deep:
                self._letters[part] = self._letter(part)
            said = self._said()
        return said

    def _said(self) -> RuleSentences:
        rule, language = self._rule, self._language
        required = self._spoken(rule.required or rule.formula)
        requirement = sentence(
            required,
            [*self._own.items()],
            lambda a, b: self._fits(a, b) or self._fits(b, a),
            language,
        )
        exempt = [(self._spoken(part.formula), part.scope) for part in rule.exemptions]
        exempt = [(formula, scope) for formula, scope in exempt if formula != Constant(False)]
        restrictions = [exemption(formula, scope, language) for formula, scope in exempt]
        applies = self._spoken(rule.condition or Constant(True))
        if applies == Constant(False):
            restrictions = [Phrase(language.counts_never, Shape.CLAUSE)]
        elif applies != Constant(True):
            guarding = (UnaryOperator.ALWAYS, UnaryOperator.NEVER)
            guards = isinstance(rule.required, Unary) and rule.required.operator in guarding
            restrictions.insert(0, condition(applies, language, guards=guards))
        parts = [required, applies, *(formula for formula, _ in exempt)]
        return RuleSentences(requirement, tuple(restrictions), tuple(self._definitions(parts)))

    def _spoken(self, formula: Formula, itself: Formula | None = None) -> Formula:
        """A part of the rule as it is said; ``itself`` is what gets no name in it."""
        names = {part: name for part, name in self._names.items() if part != itself}
        shorter = plain(replaced(fold_constants(formula), names), self._kinds, self._fits)
        said = spoken_formula(fold_constants(shorter), self._phrases, self._language)
        return replaced(said, self._letters)

    def _definitions(self, parts: list[Formula]) -> Iterator[Phrase]:
        """What the names in these parts mean, and the names in that."""
        known: set[str] = set()
        for part in parts:
            for use in atoms_in(part):
                # What a definition says of one object it says of any.
                said = None if use.name in known else self._meaning(use)
                if said is not None:
                    known.add(use.name)
                    parts.append(said)
                    yield meaning(use, said, self._language)

    def _meaning(self, use: Atom) -> Formula | None:
        """What a name means for the objects of this use; None if it is none."""
        for part, letter in self._letters.items():
            if letter == use:
                return replaced(part, {k: v for k, v in self._letters.items() if v != use})
        for part, name in self._names.items():
            if name.name == use.name:
                given = dict(zip(name.arguments, use.arguments, strict=True))
                return self._spoken(rename_variables(part, given), part)
        declared = self._meanings.get(use.name)
        if declared is None or isinstance(declared.formula, Calculated):
            return None
        given = dict(zip(declared.variables, use.arguments, strict=True))
        return self._spoken(rename_variables(declared.formula, given))

    def _name(self, use: Atom) -> Atom:
        """The name of a use of a definition: its words with the relations that it is given."""
        given = [spoken(word) for word in use.arguments if word not in self._kinds]
        words = f"{spoken(use.name)}{(given and f' ({listed(given, self._language)})') or ''}"
        return Atom(words, tuple([item for item in use.arguments if item in self._kinds]))

    def _is_long(self, part: Formula) -> bool:
        return bool(phrase(self._spoken(part), self._language, inside=True).items)

    def _letter(self, part: Formula) -> Atom:
        """A letter for a part, with the objects that only it speaks of."""
        taken = {letter.name for letter in self._letters.values()} | {*names_in(self._rule.formula)}
        objects = dict.fromkeys(name for name in variables_of(part) if name not in self._own)
        return Atom(next(name for name in ascii_uppercase if name not in taken), tuple(objects))


def _too_deep(said: RuleSentences) -> Iterator[Formula]:
    """The parts of sentences whose lists are on too deep a level."""
    waiting = [(0, each) for each in said.every]
    while waiting:
        level, each = waiting.pop(0)
        if level < MOST_LEVELS:
            waiting = [*((level + 1, item) for item in each.items), *waiting]
        elif each.items:
            assert each.of is not None, "every item says a formula"
            part = each.of
            while isinstance(part, Unary) and part.operator is UnaryOperator.NOT:
                part = part.operand
            yield part


def atoms_in(formula: Formula) -> Iterator[Atom]:
    """The atoms of a formula, also of what it counts, with repetitions."""
    for read in reads_in(formula):
        if isinstance(read, Atom):
            yield read
        elif isinstance(read, Count):
            yield from atoms_in(read.body)


def counted_in(formula: Formula) -> dict[str, str]:
    """The types of the objects that a formula counts, by the names of their variables."""
    kinds: dict[str, str] = {}
    for read in reads_in(formula):
        if isinstance(read, Count):
            kinds |= {read.variable: read.type, **counted_in(read.body)}
    return kinds
