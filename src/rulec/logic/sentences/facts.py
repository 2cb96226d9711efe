"""What a state says, as clauses: ``ego is behind 2 and the gap from ego to 2 is 19.8 m``."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping

from rulec.logic.formula import Atom, QuantityTerm
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.language import Language
from rulec.logic.sentences.spoken_words import SpokenQuantity, spoken_formula, spoken_term
from rulec.logic.sentences.wording import atom_clause, listed
from rulec.vocabulary import Declaration, Enumeration, Quantity, Vocabulary


def facts_in_words(
    facts: Iterable[tuple[str, bool | str | float, str]],
    vocabulary: Vocabulary,
    phrases: Mapping[str, str],
    language: Language = ENGLISH,
) -> str:
    """Facts, joined; those whose words have no phrase are left out.

    Each is what it is about, such as ``gap(2)``, its value, and how the value is written, which
    only numbers need.
    """
    clauses: list[str] = []
    for about, value, shown in facts:
        name, _, rest = about.partition("(")
        items = tuple(rest.removesuffix(")").split(", ")) if rest else ()
        item = vocabulary.declarations.get(name)
        # The name of an object may hold what stands between two of them.
        if item is not None and len(items) == len(item.parameters):
            clauses += _clauses(Atom(name, items), (item, value, shown), phrases, language)
    return listed(clauses, language) if clauses else ""


def _clauses(
    atom: Atom,
    told: tuple[Declaration, bool | str | float, str],
    phrases: Mapping[str, str],
    language: Language,
) -> Iterator[str]:
    item, value, shown = told
    if isinstance(item, Quantity):
        term = spoken_term(QuantityTerm(atom.name, atom.arguments), phrases, language)
        if isinstance(term, SpokenQuantity):
            yield language.value_is.format(term.noun, f"{language.decimals(shown)} {item.unit}")
        return
    said = str(value) if isinstance(item, Enumeration) else None
    if (said or atom.name) in phrases:
        named = spoken_formula(Atom(atom.name, atom.arguments, said), phrases, language)
        assert isinstance(named, Atom), "an atom that is spoken stays one"
        yield atom_clause(named, language, holds=said is not None or value is True)
