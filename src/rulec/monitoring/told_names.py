"""Which names a source tells, which their meanings give from these, and which remain unknown."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence, Set
from dataclasses import replace
from fractions import Fraction
from typing import Any, NamedTuple

from rulec.logic import formula as ltl
from rulec.logic.fold import Algebra, fold
from rulec.logic.formula import operands_of
from rulec.logic.free_names import names_of
from rulec.logic.linear_comparison import stands
from rulec.vocabulary import Enumeration, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN

NEVER_TRUE, NEVER_FALSE = " is true", " is false"
"""Behind the name of a word: the value that its meaning never gives in traces of a source."""


def words_meant(vocabulary: Vocabulary, told: frozenset[str] | None) -> tuple[str, ...]:
    """The words that their meanings give in traces of a source, in their order.

    A source that names what it tells leaves out their names, but not all names that decide them;
    any other tells all words that have a default.
    """
    return tuple(_meant(vocabulary, told))


def with_meant(told: frozenset[str] | None, vocabulary: Vocabulary) -> frozenset[str] | None:
    """What a source tells whose states have been extended by the words that are meant.

    Words of which only one value may be known are left to be found again, and their rules told so.
    """
    if told is None:
        return None
    return told.union(name for name, own in _meant(vocabulary, told).items() if all(own))


class _Known(NamedTuple):
    """Whether something may be known to be true, and whether it may be known to be false."""

    true: bool
    false: bool


def _meant(vocabulary: Vocabulary, told: frozenset[str] | None) -> dict[str, _Known]:
    """The words that their meanings give, with what may be known of each."""
    declared = vocabulary.declarations
    if told is None or not vocabulary.meanings:
        none = [name for name in vocabulary.meanings if declared[name].default is None]
        return dict.fromkeys(none, _Known(true=True, false=True))
    known = {*told, *(name for name, item in declared.items() if item.presumed)}
    meant: dict[str, _Known] = {}
    for name, meaning in vocabulary.meanings.items():
        own = _may_be_known(meaning.formula, known, meant)
        if name not in told and any(own):
            known.add(name)
            meant[name] = own
    return meant


def _may_be_known(formula: ltl.Formula, known: Set[str], meant: Mapping[str, _Known]) -> _Known:
    """What may be known of a formula if these names are, some only as they are ``meant``."""

    def of(asked: ltl.Proposition) -> _Known:
        if isinstance(asked, ltl.Atom) and asked.name in meant:
            return meant[asked.name]
        match asked:
            case ltl.Comparison(((_, ltl.Count(body=body)),), relation, limit):
                if not _may_be_known(body, known, meant).true:
                    none_counts = stands(Fraction(0), relation, limit)
                    return _Known(none_counts, not none_counts)
        return _Known(*[names_of(asked) <= known] * 2)

    def of_time(operation: ltl.Unary | ltl.Binary, part: Callable[..., _Known]) -> _Known:
        *left, right = [part(operand) for operand in operands_of(operation)]
        if not left or operation.bound is None or not operation.bound.low:
            return right
        return _Known(left[0].true and right.true, left[0].false or right.false)

    return fold(
        formula,
        Algebra(
            proposition=of,
            identity=lambda _: _Known(true=True, false=True),
            constant=lambda value: _Known(value, not value),
            negation=lambda part: _Known(part.false, part.true),
            conjunction=lambda x, y: _Known(x.true and y.true, x.false or y.false),
            disjunction=lambda x, y: _Known(x.true or y.true, x.false and y.false),
            equivalence=lambda x, y: _Known(*[any(x) and any(y)] * 2),
            operation=of_time,
        ),
    )


def names_behind(
    names: Set[str], vocabulary: Vocabulary, meant: Sequence[str] | None = None
) -> frozenset[str]:
    """The names, and those that their meanings are made of; of those ``meant``, if given."""
    found = {*names}
    for name in reversed([*(vocabulary.meanings if meant is None else meant)]):
        if name in found:
            found |= vocabulary.meanings[name].reads
    return frozenset(found)


def names_lacking(
    names: Sequence[str], vocabulary: Vocabulary, untold: Set[str]
) -> tuple[str, ...]:
    """The names, with those behind what is calculated, and the only one that a meaning lacks."""
    found: dict[str, None] = {}
    for name in names:
        word = name.removesuffix(NEVER_TRUE).removesuffix(NEVER_FALSE)
        meaning = vocabulary.meanings.get(word)
        behind = names_behind(frozenset({word}), vocabulary) & untold - {word}
        is_calculated = meaning and isinstance(meaning.formula, ltl.Calculated)
        only = word != name and len(behind) == 1
        found |= dict.fromkeys(sorted(behind) if is_calculated or only else [word])
    return tuple(found)


def with_defaulted(told: frozenset[str], vocabulary: Vocabulary) -> frozenset[str]:
    """What a source tells if all else takes its default, or means what it is defined as."""
    return told | (vocabulary.declarations.keys() - vocabulary.meanings)


def untold_names(vocabulary: Vocabulary, told: frozenset[str] | None) -> frozenset[str]:
    """The names that a source which provides ``told`` lacks, and that are not presumed."""
    if told is None:
        return frozenset()
    meant = _meant(vocabulary, told)
    told = frozenset((*told, *meant))
    untold = [name + NEVER_TRUE for name, own in meant.items() if not own.true]
    untold += [name + NEVER_FALSE for name, own in meant.items() if not own.false]
    for name, item in vocabulary.declarations.items():
        if name not in told:
            untold += [] if item.presumed else [name]
        elif isinstance(item, Enumeration) and not told.isdisjoint(item.values):
            untold += [value for value in item.values if value not in told]
    return frozenset(untold)


def untold_types(vocabulary: Vocabulary, told: frozenset[str] | None) -> frozenset[str]:
    """The types of objects that a source which provides others by name never provides."""
    types = vocabulary.types.keys()
    return frozenset() if told is None or types.isdisjoint(told) else frozenset(types - {*told})


def with_untold(vocabulary: Vocabulary, untold: frozenset[str]) -> Vocabulary:
    """The vocabulary in which untold names are unknown where no state contains them."""
    if not untold:
        return vocabulary
    unknown: Any = UNKNOWN
    declarations = {
        name: replace(item, default=unknown) if name in untold else item
        for name, item in vocabulary.declarations.items()
    }
    return replace(vocabulary, declarations=declarations)
