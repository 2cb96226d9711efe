"""Signals implied by axioms: a parked vehicle is stationary."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from types import MappingProxyType

from rulec.logic.formula import Atom, Binary, BinaryOperator, Formula
from rulec.rulebook.rulebook_model import ExampleState
from rulec.vocabulary import Signal, Vocabulary


def with_implied(vocabulary: Vocabulary, facts: Iterable[Formula]) -> Vocabulary:
    """The vocabulary with what follows from its signals by ``facts``.

    Missing values are filled in only from axioms by which one signal implies another one of the
    same objects, neither of them a constant, since a constant's value in one state holds in all.
    """
    following: dict[str, list[str]] = {}
    for cause, effect in _implications(facts, vocabulary):
        following.setdefault(cause, []).append(effect)
    if not following:
        return vocabulary
    implied = {cause: tuple(effects) for cause, effects in following.items()}
    return replace(vocabulary, implied=MappingProxyType(implied))


def with_what_follows(given: ExampleState, vocabulary: Vocabulary) -> ExampleState:
    """The values of an example's state, and what follows from them."""
    known = dict(given)
    ahead = [name for name, value in given.items() if value is True]
    while ahead:
        cause, items = ahead.pop()
        for effect in vocabulary.implied.get(cause, ()):
            if (effect, items) not in known:
                known[effect, items] = True
                ahead.append((effect, items))
    return known


def _implications(facts: Iterable[Formula], vocabulary: Vocabulary) -> Iterator[tuple[str, str]]:
    for fact in facts:
        match fact:
            case Binary(BinaryOperator.IMPLIES, Atom() as cause, Atom() as effect):
                if cause.arguments == effect.arguments and _fits(cause, effect, vocabulary):
                    yield cause.name, effect.name


def _fits(cause: Atom, effect: Atom, vocabulary: Vocabulary) -> bool:
    """Whether both are signals that may change, and every object of the one has the other."""
    first, second = vocabulary.declarations[cause.name], vocabulary.declarations[effect.name]
    return (
        isinstance(first, Signal)
        and isinstance(second, Signal)
        and not (first.constant or second.constant)
        and len(set(cause.arguments)) == len(cause.arguments)
        and all(map(vocabulary.is_subtype, first.parameters, second.parameters))
    )
