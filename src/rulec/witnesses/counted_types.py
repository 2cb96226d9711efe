"""The types of objects that may be counted, and what the facts about such an object depend on.

A fact such as ``loud(v) implies horn`` makes the horn decide whether a loud object can be there.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from functools import lru_cache

from rulec.automata.alphabet import reads_of
from rulec.logic.formula import Count, Formula
from rulec.vocabulary import Vocabulary
from rulec.witnesses.letter_functions import (
    Digits,
    LetterFunction,
    all_digits,
    can_be_true,
    plain_body_of,
    speaks_of_extra,
)
from rulec.witnesses.object_universe import EXTRA, Itself, ObjectUniverse
from rulec.witnesses.relevant_axioms import GroundAxiom, axioms_about, relevant_axioms


def facts_beside(counts: Sequence[Count], universe: ObjectUniverse) -> list[LetterFunction]:
    """What the facts about an object that may be counted depend on besides that object.

    Two states with equal values of these functions allow the same such objects. Raises
    UndecidedError.
    """
    vocabulary = universe.vocabulary
    functions: dict[LetterFunction, None] = {}
    for kind in types_counted(counts, (), vocabulary):
        bodies = tuple(bodies_for(kind, counts, vocabulary).values())
        if can_add(bodies):
            about = axioms_about(kind, universe)
            functions |= dict.fromkeys(_beside(bodies, about, Itself(vocabulary)))
    return list(functions)


# Cached: most rules of two rulebooks are compared with the same objects and axioms.
@lru_cache(maxsize=1024)
def _beside(
    bodies: tuple[Formula, ...], axioms: tuple[GroundAxiom, ...], vocabulary: Itself[Vocabulary]
) -> tuple[LetterFunction, ...]:
    relevant = relevant_axioms(axioms, [reads_of(body, vocabulary.item) for body in bodies])
    functions = [_beside_extra(axiom.function) for axiom in relevant]
    return tuple([function for function in functions if function.reads])


def types_counted(
    counts: Sequence[Count], types: Sequence[str], vocabulary: Vocabulary
) -> list[str]:
    """The ``types`` and those of objects that may be counted, most general ones first."""
    fitting = [
        kind
        for kind in vocabulary.types
        if kind in types or any(vocabulary.is_subtype(kind, count.type) for count in counts)
    ]
    return sorted(fitting, key=lambda fit: len(list(vocabulary.ancestors(fit))))


def bodies_for(kind: str, counts: Sequence[Count], vocabulary: Vocabulary) -> dict[int, Formula]:
    """By the place of each count to which an object of a type may add: what it then satisfies."""
    return {
        place: plain_body_of(count, (EXTRA, kind), Itself(vocabulary))
        for place, count in enumerate(counts)
        if vocabulary.is_subtype(kind, count.type)
    }


def can_add(bodies: Iterable[Formula]) -> bool:
    """Whether an additional object may satisfy any of the bodies of counts."""
    return any(map(can_be_true, bodies))


def _beside_extra(function: LetterFunction) -> LetterFunction:
    """What a function depends on besides an additional object.

    Letters of the other reads are in one class if they leave the same function of the object.
    """
    places = [place for place, read in enumerate(function.reads) if not speaks_of_extra(read)]
    left: dict[Digits, list[int]] = {}
    for digits, value in zip(all_digits(function.reads), function.letters, strict=True):
        left.setdefault(tuple([digits[place] for place in places]), []).append(value)
    reads = tuple([function.reads[place] for place in places])
    classes: dict[tuple[int, ...], int] = {}
    letters = [
        classes.setdefault(tuple(left[digits]), len(classes)) for digits in all_digits(reads)
    ]
    return LetterFunction(reads, tuple(letters))
