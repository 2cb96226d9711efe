"""Constants while a trace runs: a value given in one state holds from then on."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from types import MappingProxyType
from typing import Any, NamedTuple

import msgspec

from rulec.diagnostics import SourceLocation
from rulec.monitoring.constant_values import Subject, agreed_value, changed, display, values_in
from rulec.monitoring.state_validation import check_state
from rulec.monitoring.state_view import put
from rulec.trace import State
from rulec.vocabulary import Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, Interval

KnownConstants = Mapping[str, Mapping[Subject, Any]]
"""Name -> the objects that a value is about -> the value; UNKNOWN if only that was given."""


NO_CONSTANTS: KnownConstants = MappingProxyType({})


class Arrival(NamedTuple):
    """A state that arrives: its ``number``, the objects in it and in the state before."""

    number: int
    objects: Mapping[str, str]
    before: Mapping[str, str]
    place: SourceLocation | None

    def was_there(self, subject: Subject) -> bool:
        """Whether objects were present in the state before, the world in any."""
        stayed = (self.before.get(item) == self.objects[item] for item in subject)
        return self.number > 0 and all(stayed)


def with_known_constants(
    state: State, arrival: Arrival, known: KnownConstants, vocabulary: Vocabulary
) -> tuple[State, KnownConstants]:
    """The state with the constants that earlier states have given, and those known after it.

    A constant that was left out so far had its default. The second item is ``known`` itself if
    nothing changes. Raises RulecError R0503 for another value than before, R0502 to R0505 if a
    state that gives a new value does not fit the vocabulary.
    """
    after: dict[str, Mapping[Subject, Any]] = {}
    filled: dict[str, Any] = {}
    for name in vocabulary.constants:
        given, own = state.get(name), known.get(name, {})
        if given is None and not own:
            continue
        default = vocabulary.declarations[name].default
        stays = {
            subject: value
            for subject, value in own.items()
            if all(arrival.objects.get(item) == arrival.before.get(item) for item in subject)
        }
        values = dict(values_in(given, len(vocabulary.declarations[name].parameters)))
        if {**stays, **values} != stays:
            where = f"state {arrival.number}"
            check_state(state, arrival.objects, vocabulary, where, arrival.place)
            stays |= _merged(name, values, (stays, default), arrival)
        if stays:
            after[name] = stays
        value: Any = given
        # What is unknown of all objects stays so
        known_of = stays if given is not UNKNOWN or () in stays else {}
        for subject, own_value in known_of.items():
            if own_value != default or subject in values:
                value = put(value, subject, own_value)
        if value != given:
            filled[name] = value
    return {**state, **filled} if filled else state, known if after == known else after


def _merged(
    name: str,
    values: Mapping[Subject, Any],
    known: tuple[Mapping[Subject, Any], Any],
    arrival: Arrival,
) -> dict[Subject, Any]:
    """The values that a state gives, together with those known before, and the default."""
    stated, default = known
    merged = {}
    for subject, value in values.items():
        before = stated.get(subject)
        why, way_out = "an earlier state says", "give the same value in all states"
        together = value if before is None else agreed_value(before, value)
        rests_on_default = default is not None and default is not UNKNOWN
        if before is None and rests_on_default and arrival.was_there(subject):
            before, together = default, value if value == default else None
            why = "without it before it counted as"
            way_out = f"give `{name}` from the first state on, if unknown as such"
        if together is None:
            says = "that it is unknown" if value is UNKNOWN else display(value)
            message = f"state {arrival.number} says {says}, {why} {display(before)}"
            raise changed(name, subject, message, arrival.place, way_out)
        merged[subject] = together
    return merged


def constants_of_world(known: KnownConstants) -> dict[str, Any]:
    """The exactly known values of constants that are about no objects."""
    values = {name: own[()] for name, own in known.items() if () in own}
    return {name: own for name, own in values.items() if type(own) not in UNKNOWN_TYPES}


class SavedConstant(msgspec.Struct, forbid_unknown_fields=True):
    """The value of a constant for some objects, as in a state of a trace."""

    name: str
    objects: tuple[str, ...]
    value: bool | float | str | dict[str, float] | None


def to_data(known: KnownConstants) -> list[dict[str, Any]]:
    """Constants as data for JSON."""
    return [
        {"name": name, "objects": list(subject), "value": _value_to_data(value)}
        for name, own in known.items()
        for subject, value in own.items()
    ]


def _value_to_data(value: Any) -> Any:
    if isinstance(value, Interval):
        return {"from": value.low, "to": value.high}
    return None if value is UNKNOWN else value


def from_data(
    saved: Iterable[SavedConstant], objects: Mapping[str, str], vocabulary: Vocabulary
) -> KnownConstants:
    """Constants from data. Raises LookupError, ValueError or RulecError if they do not fit."""
    known: dict[str, dict[Subject, Any]] = {}
    for own in saved:
        if own.name not in vocabulary.constants:
            raise ValueError
        value: Any = UNKNOWN if own.value is None else own.value
        if isinstance(value, dict):
            value = Interval(value["from"], value["to"])
        check_state({own.name: put(None, own.objects, value)}, objects, vocabulary, "", None)
        known.setdefault(own.name, {})[own.objects] = value
    return known
