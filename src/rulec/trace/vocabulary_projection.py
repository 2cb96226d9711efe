"""Projection of supplied values onto what a rulebook's vocabulary declares.

Recordings and partitions are not written for a particular rulebook: their objects get the most
specific type that the vocabulary declares, and names that it does not declare, or declares
differently, are dropped. What an author wrote is kept, so that validation can report it.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import replace

from rulec.trace.trace_model import State, TraceGraph, Value
from rulec.vocabulary import Declaration, Enumeration, Quantity, Signal, Vocabulary
from rulec.vocabulary.partial_values import PartialValue

RECORDED_UNITS = {
    "speed": "km/h",
    "limit": "km/h",
    "minimum_limit": "km/h",
    "speed_difference": "km/h",
    "gap": "m",
    "time_headway": "s",
    "lateral_gap": "m",
    "ahead_for": "s",
    "distance_to_crossing": "m",
    "distance_to_junction": "m",
    "distance_to_stop_line": "m",
    "time_to_stop_line": "s",
    "time_to_collision": "s",
    "acceleration": "m/s^2",
    "ego_length": "m",
    "visibility": "m",
}
"""The units of the quantities that recordings provide."""

MEASURED = RECORDED_UNITS.keys() - {"limit", "minimum_limit", "ego_length", "visibility"}
"""The recorded quantities that are measured, within a tolerance."""

UNTOLD_VALUES: Mapping[str, frozenset[str]] = {
    "light": frozenset(("flashing_amber", "flashing_red", "red_cross")),
    "lane_kind": frozenset(("branching_lane", "signposted_lane")),
    "surface": frozenset(("tram_track",)),
    "crossing_kind": frozenset(("unmarked_crossing",)),
}
"""Enumeration -> values that no format provides: where another is recorded, it may be these."""

_Signal = PartialValue | Mapping[str, PartialValue]


def known_type(types: Iterable[str], vocabulary: Vocabulary) -> str | None:
    """The first, most specific, of an object's types that the vocabulary declares; None if none."""
    return next((name for name in types if name in vocabulary.types), None)


def known_types(objects: Mapping[str, Sequence[str]], vocabulary: Vocabulary) -> dict[str, str]:
    """The type of each object that has one declared in the vocabulary."""
    types = {name: known_type(own, vocabulary) for name, own in objects.items()}
    return {name: own for name, own in types.items() if own is not None}


def is_about(declaration: Declaration, own_type: str | None, vocabulary: Vocabulary) -> bool:
    """Whether an object of a type can be the declaration's first argument, if it has any."""
    if own_type is None or own_type not in vocabulary.types:
        return False
    return not declaration.parameters or vocabulary.is_subtype(own_type, declaration.parameters[0])


def fits(name: str, values: Iterable[Value], declaration: Declaration) -> bool:
    """Whether recorded values fit a declaration, including its unit."""
    match declaration:
        case Signal():
            return all(isinstance(value, bool) for value in values)
        case Enumeration():
            return all(value in declaration.values for value in values)
        case Quantity():
            same_unit = declaration.unit == RECORDED_UNITS.get(name)
            return same_unit and all(type(value) in (int, float) for value in values)


def project_graph(
    traces: TraceGraph,
    vocabulary: Vocabulary,
    supplied: Set[str],
    recorded: Mapping[str, Sequence[str]] | None = None,
) -> TraceGraph:
    """The graph reduced to a vocabulary's names and types.

    ``supplied`` are the names that a partition supplies: they are dropped if not declared, and so
    are their values for objects that the declaration is not about. ``recorded`` gives each object's
    types, most specific first, if the scene was recorded: then all names are filtered.
    """
    objects = dict(traces.objects) if recorded is None else known_types(recorded, vocabulary)
    if not vocabulary.types:
        objects = {}
    projection = _StateProjection(vocabulary, supplied, traces.objects, recorded)
    return replace(
        traces,
        objects=objects,
        present={name: span for name, span in traces.present.items() if name in objects},
        states=tuple(tuple(map(projection.state, layer)) for layer in traces.states),
    )


class _StateProjection:
    """Projects states onto a vocabulary, each shared value only once."""

    def __init__(
        self,
        vocabulary: Vocabulary,
        supplied: Set[str],
        objects: Mapping[str, str],
        recorded: Mapping[str, Sequence[str]] | None,
    ) -> None:
        self._vocabulary = vocabulary
        self._supplied = supplied
        self._recorded = recorded is not None
        # Validation reports types written by an author that the vocabulary does not declare
        self._types: dict[str, str | None] = (
            {name: own for name, own in objects.items() if own in vocabulary.types}
            if recorded is None
            else {name: known_type(own, vocabulary) for name, own in recorded.items()}
        )
        self._excluded: dict[str, Set[str]] = {}
        self._projected: dict[tuple[str, int], tuple[_Signal, _Signal | None]] = {}

    def state(self, state: State) -> State:
        """The part of a state that the vocabulary declares."""
        kept: dict[str, _Signal] = {}
        for name, value in state.items():
            key = (name, id(value))
            if key not in self._projected:
                # Keeping the value alive prevents another one from getting its id
                self._projected[key] = (value, self._value(name, value))
            projected = self._projected[key][1]
            if projected is not None:
                kept[name] = projected
        return kept

    def _value(self, name: str, value: _Signal) -> _Signal | None:
        """A value without the objects that its name is not about; None if the name is dropped."""
        declaration = self._vocabulary.declarations.get(name)
        by_partition = name in self._supplied
        if not (by_partition or self._recorded):
            return value
        if declaration is None or not (by_partition or _fits(name, value, declaration)):
            return None
        if not isinstance(value, Mapping):
            return value
        excluded = self._others_than(name, declaration)
        if excluded.isdisjoint(value):
            return value
        return {item: inner for item, inner in value.items() if item not in excluded}

    def _others_than(self, name: str, declaration: Declaration) -> Set[str]:
        if name not in self._excluded:
            self._excluded[name] = {
                item
                for item, own in self._types.items()
                if not is_about(declaration, own, self._vocabulary)
            }
        return self._excluded[name]


_KNOWN = bool, int, float, str
"""The types of known values."""


def _fits(name: str, value: _Signal, declaration: Declaration) -> bool:
    if isinstance(value, Mapping) != bool(declaration.parameters):
        return False
    values = value.values() if isinstance(value, Mapping) else (value,)
    known = [x for x in values if isinstance(x, _KNOWN)]
    return fits(name, known, declaration)


def values_lacking(types: frozenset[str]) -> frozenset[str]:
    """The values that a map with lanelets of these types does not provide, but other maps do.

    A map without bicycle lanes may have omitted them.
    """
    return frozenset() if "bicycleLane" in types else frozenset({"cycle_lane"})


def with_told_values(
    names: frozenset[str], vocabulary: Vocabulary, lacking: frozenset[str] = frozenset()
) -> frozenset[str]:
    """The names, and the provided values of enumerations that formats provide only in part.

    Other files than this one could provide the ``lacking`` values.
    """
    tellable = set(names)
    for name in UNTOLD_VALUES.keys() & names:
        item = vocabulary.declarations.get(name)
        if isinstance(item, Enumeration):
            tellable |= {*item.values} - UNTOLD_VALUES[name] - lacking
    return frozenset(tellable)
