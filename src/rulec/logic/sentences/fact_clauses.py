"""Facts of a state as clauses, such as ``the gap is 19.8 m``."""

from __future__ import annotations

from collections.abc import Iterable, Mapping

from rulec.logic.formula import Atom, QuantityTerm
from rulec.logic.sentences.english import ENGLISH
from rulec.logic.sentences.spoken_words import (
    SpokenAtom,
    SpokenQuantity,
    spoken_formula,
    spoken_term,
)
from rulec.logic.sentences.wording import atom_clause, listed, of_objects
from rulec.vocabulary import Enumeration, Quantity, Vocabulary


def facts_in_words(
    facts: Iterable[tuple[str, bool | str | float, str]],
    vocabulary: Vocabulary,
    phrases: Mapping[str, str],
) -> str:
    """Facts joined to one text; empty if no phrase is known for any of them.

    Each fact is a subject such as ``gap(2)``, its value, and the value's text, used for numbers
    only.
    """
    clauses = []
    has_phrase = False
    for about, value, shown in facts:
        name, _, rest = about.partition("(")
        if rest and not rest.endswith(")"):
            # No word: a comparison that is calculated, or a word of one of two rulebooks
            clauses.append(atom_clause(Atom(about), ENGLISH, holds=value is True))
            continue
        items = tuple(rest.removesuffix(")").split(", ")) if rest else ()
        item = vocabulary.declarations.get(name)
        # An object's name may contain the separator of arguments.
        if item is None or len(items) != len(item.parameters):
            continue
        if isinstance(item, Quantity):
            term = spoken_term(QuantityTerm(name, items), phrases, ENGLISH)
            spoken = isinstance(term, SpokenQuantity)
            noun = term.noun if isinstance(term, SpokenQuantity) else ""
            number = f"{ENGLISH.decimals(shown)} {item.unit}"
            clauses.append(
                ENGLISH.value_is.format(noun or of_objects(name, items, ENGLISH), number)
            )
        else:
            named = str(value) if isinstance(item, Enumeration) else None
            atom = spoken_formula(Atom(name, items, named), phrases, ENGLISH)
            assert isinstance(atom, Atom), "an atom that is spoken stays one"
            spoken = isinstance(atom, SpokenAtom)
            clauses.append(atom_clause(atom, ENGLISH, holds=named is not None or value is True))
        has_phrase |= spoken
    return listed(clauses, ENGLISH) if has_phrase else ""
