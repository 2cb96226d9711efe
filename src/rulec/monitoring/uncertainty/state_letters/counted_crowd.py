"""Those who may count for a rule's reads: of many of whom a state says the same, few are enough.

What reads come to does not depend on names, and beyond its highest threshold no count has another
digit. So states of dense traffic are looked at once for all that differ only in who is where.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import ceil

from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.logic import formula as ltl
from rulec.monitoring.uncertainty.state_letters.unknown_subjects import Subject
from rulec.vocabulary.partial_values import PartialValue


@dataclass(frozen=True, slots=True)
class Crowd:
    """Everybody but the objects that reads are asked of.

    ``own`` has for each of them the places of what is said of it among the values of all subjects,
    ``others`` are the places of what is said of none of them. Of objects of one type, of which the
    same is said, ``enough`` count as any larger number does.
    """

    enough: int
    own: Mapping[str, tuple[int, ...]]
    others: tuple[int, ...]

    def few(
        self, values: Sequence[PartialValue | None], there: Mapping[str, str]
    ) -> tuple[tuple[object, ...], dict[str, str]]:
        """What a state says but for names, and enough of those that are ``there``, with types."""
        kept: dict[str, str] = {}
        alike: Counter[tuple[object, ...]] = Counter()
        asked = []
        for item, kind in there.items():
            own = self.own.get(item)
            if own is None:
                asked.append(item)
            else:
                said = kind, *[values[place] for place in own]
                if alike[said] == self.enough:
                    continue
                alike[said] += 1
            kept[item] = kind
        key = tuple([values[place] for place in self.others]), tuple(asked)
        return (*key, frozenset(alike.items())), kept


def crowd_of(
    reads: Sequence[Read | NumberRead],
    subjects: Sequence[Subject],
    asked: frozenset[str],
    everybody: Mapping[str, str],
) -> Crowd | None:
    """The crowd of reads that are ``asked`` of some objects; None if it matters who is who.

    ``subjects`` are what the reads depend on.
    """
    enough = enough_alike(reads)
    if enough is None:
        return None
    own: dict[str, list[tuple[str, tuple[str, ...], int]]] = {
        item: [] for item in everybody if item not in asked
    }
    others = []
    for place, (name, items) in enumerate(subjects):
        strangers = {item for item in items if item not in asked}
        if len(strangers) > 1:
            return None
        for item in strangers:
            # In one order for all, whatever their names.
            own[item].append((name, tuple("" if x == item else x for x in items), place))
        if not strangers:
            others.append(place)
    places = {item: tuple(place for *_, place in sorted(found)) for item, found in own.items()}
    return Crowd(enough, places, tuple(others))


def enough_alike(reads: Sequence[Read | NumberRead]) -> int | None:
    """How many objects that are alike count for these reads as any larger number does.

    None if that is not known: if something is added to a count, or counts are counted.
    """
    enough = 1
    for read in reads:
        count = count_in(read)
        if count is None:
            continue
        assert isinstance(read, NumberRead), "it counts"
        if len(read.terms) > 1 or any(map(counts, ltl.atoms_of(count.body))):
            return None
        factor = abs(read.terms[0][0])
        limits = [abs(threshold.limit) / factor for threshold in read.thresholds]
        enough = max([enough, *[ceil(limit) + 1 for limit in limits]])
    return enough


def count_in(read: Read | NumberRead) -> ltl.Count | None:
    """The count that a read depends on, if it is none of single values."""
    terms = read.terms if isinstance(read, NumberRead) else ()
    return next((term for _, term in terms if isinstance(term, ltl.Count)), None)


def counts(part: ltl.Proposition) -> bool:
    """Whether a proposition compares a number of objects."""
    return isinstance(part, ltl.Comparison) and any(
        isinstance(term, ltl.Count) for _, term in part.terms
    )
