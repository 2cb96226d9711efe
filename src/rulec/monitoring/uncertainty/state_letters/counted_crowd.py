"""Objects in counts: of many equal objects in a state, a few suffice.

Reads do not depend on names, and beyond its highest threshold a count's digit no longer changes. So
states of dense traffic that differ only in which object is where are evaluated once.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from math import ceil
from typing import Any, TypeAlias

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.monitoring.uncertainty.state_letters.joint_values import values_at
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.rulebook.rules.axiom_instances import counts
from rulec.vocabulary.partial_values import PartialValue

_Getter: TypeAlias = Callable[[Any], tuple[Any, ...]]
"""A getter of some values from those of all subjects."""


@dataclass(frozen=True, slots=True)
class Crowd:
    """All objects except those for which reads are evaluated.

    ``own`` gets the values of each of them from those of all subjects, ``others`` the values about
    none of them. Of objects of one type with the same values, ``enough`` count like any larger
    number.
    """

    enough: int
    own: Mapping[str, _Getter]
    others: _Getter

    def few(
        self, values: Sequence[PartialValue | None], there: Mapping[str, str]
    ) -> tuple[tuple[object, ...], dict[str, str]]:
        """The values of a state without names, and enough of its objects, with their types."""
        kept: dict[str, str] = {}
        alike: dict[tuple[object, ...], int] = {}
        named = []
        own, enough = self.own, self.enough
        for item, kind in there.items():
            if item in own:
                traits = kind, own[item](values)
                number = alike.get(traits, 0)
                if number == enough:
                    continue
                alike[traits] = number + 1
            else:
                named.append(item)
            kept[item] = kind
        return (self.others(values), tuple(named), frozenset(alike.items())), kept


def crowd_of(
    reads: Sequence[Read | NumberRead],
    subjects: Sequence[Subject],
    bound: frozenset[str],
    everybody: Mapping[str, str],
) -> Crowd | None:
    """The crowd of reads about ``bound`` objects and others; None if identities matter.

    ``subjects`` are what the reads depend on.
    """
    enough = enough_alike(reads)
    if enough is None:
        return None
    own: dict[str, list[tuple[str, tuple[str, ...], int]]] = {
        item: [] for item in everybody if item not in bound
    }
    others = []
    for place, (name, items) in enumerate(subjects):
        strangers = {item for item in items if item not in bound}
        if len(strangers) > 1:
            return None
        for item in strangers:
            # In one order for all objects, independent of their names.
            own[item].append((name, tuple("" if x == item else x for x in items), place))
        if not strangers:
            others.append(place)
    getters = {
        item: values_at([place for *_, place in sorted(ranked)]) for item, ranked in own.items()
    }
    return Crowd(enough, getters, values_at(others))


def enough_alike(reads: Sequence[Read | NumberRead]) -> int | None:
    """How many equal objects count for these reads like any larger number.

    None if that is unknown: if something is added to a count, or counts are counted.
    """
    enough = 1
    for read in reads:
        count = count_in(read)
        if count is None:
            continue
        assert isinstance(read, NumberRead), "it counts"
        if len(read.terms) > 1 or counts(count.body):
            return None
        factor = abs(read.terms[0][0])
        limits = [abs(threshold.limit) / factor for threshold in read.thresholds]
        enough = max([enough, *[ceil(limit) + 1 for limit in limits]])
    return enough


def count_in(read: Read | NumberRead) -> ltl.Count | None:
    """The count that a read depends on, unless it is about single values."""
    terms = read.terms if isinstance(read, NumberRead) else ()
    return next((term for _, term in terms if isinstance(term, ltl.Count)), None)
