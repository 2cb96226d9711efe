"""Signals of an OpenDRIVE file as signs: what plates, boards and semantics leave of them.

A sign that may limit the speed, but not for everybody, not always, or with a number that is not
read, hides the limit: neither that of the sign before it nor that of the road is certain there.
"""

from __future__ import annotations

from collections import Counter, defaultdict
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import replace
from itertools import product
from typing import NamedTuple

from rulec.diagnostics import first_of
from rulec.recordings.commonroad.traffic_signs import (
    LIMITS,
    MAX_SPEED,
    MIN_SPEED,
    UNKNOWN,
    ZONE,
    Sign,
    effect_name,
    with_plates,
)
from rulec.recordings.encodings.file_values import short
from rulec.recordings.opendrive.content.elements import OpenDrive, RoadSignal, SignalSpeed
from rulec.recordings.opendrive.signal_catalogues import (
    LEAST_SPEED_END,
    NO_SIGN,
    catalogue_sign,
    country_named,
    has_catalogue,
    is_german_plate,
    may_limit,
    plate_number,
)

_BAN = "NO_OVERTAKING_START"
_SPEEDS: Mapping[str, str] = {
    "maximum": MAX_SPEED,
    "maximumEnd": "MAX_SPEED_END",
    "zone": ZONE,
    "zoneEnd": "MAX_SPEED_ZONE_END",
    "minimum": MIN_SPEED,
    "minimumEnd": LEAST_SPEED_END,
}
"""Semantics of speeds (since 1.8) -> the sign; the others are recommendations."""

_ON_POST_M = 0.5
"""Signals on the same side of a road are on one post if they are not farther apart."""

_ALMOST_MPS = 0.01
_NAMED = 5


class Posted(NamedTuple):
    """A road's own signal, or a referenced one with the place and lanes where it applies.

    ``signs`` are those that it shows. If it hides a number or a condition, they are ``untold``.
    """

    signal: RoadSignal
    signs: tuple[Sign, ...]


def posted_on(content: OpenDrive) -> dict[str, list[Posted]]:
    """Road -> the signals that apply on it."""
    by_id = {x.id: x for road in content.roads.values() for x in road.signals}
    linked = _linked_plates(by_id)
    own: dict[str, list[Posted]] = {}
    signs: dict[str, tuple[Sign, ...]] = {}
    for road in content.roads.values():
        posts = _posts(road.signals)
        own[road.id] = []
        for signal in road.signals:
            plates = *_below(signal, posts), *linked.get(signal.id, ())
            signs[signal.id] = _shown(signal, plates)
            own[road.id].append(Posted(signal, signs[signal.id]))
    for road in content.roads.values():
        own[road.id] += [
            Posted(
                replace(by_id[x.id], s=x.s, orientation=x.orientation, lanes=x.lanes), signs[x.id]
            )
            for x in road.references
            if x.id in by_id
        ]
    return own


def _linked_plates(by_id: Mapping[str, RoadSignal]) -> dict[str, list[str]]:
    """Signal -> the numbers of plates that it is linked with, in either direction."""
    plates: dict[str, list[str]] = defaultdict(list)
    for signal in by_id.values():
        for other in signal.linked:
            if other not in by_id:
                # What is not in the file may be a plate of any kind
                plates[signal.id].append("")
            elif number := plate_number(by_id[other]):
                plates[signal.id].append(number)
            elif number := plate_number(signal):
                plates[other].append(number)
    return plates


_Place = tuple[int, int]


def _posts(signals: Iterable[RoadSignal]) -> dict[_Place, list[tuple[RoadSignal, str]]]:
    """Places along a road -> the plates there, and their numbers."""
    posts: dict[_Place, list[tuple[RoadSignal, str]]] = defaultdict(list)
    for signal in signals:
        if number := plate_number(signal):
            posts[_place(signal)].append((signal, number))
    return posts


def _place(signal: RoadSignal) -> _Place:
    return round(signal.s / _ON_POST_M), round(signal.t / _ON_POST_M)


def _below(
    signal: RoadSignal, posts: Mapping[_Place, Iterable[tuple[RoadSignal, str]]]
) -> Iterator[str]:
    """The numbers of plates on a signal's post that do not face the other way."""
    s, t = _place(signal)
    for ahead, aside in product((-1, 0, 1), repeat=2):
        for plate, number in posts.get((s + ahead, t + aside), ()):
            faces = {signal.orientation, plate.orientation} != {"+", "-"}
            if faces and plate is not signal:
                yield number


def _shown(signal: RoadSignal, plates: Iterable[str]) -> tuple[Sign, ...]:
    """The signs that a signal shows, without ``UNKNOWN`` ones that hide nothing."""
    if is_german_plate(signal):
        return ()
    signs = _by_meaning(signal)
    if signal.dynamic:
        # What it shows now is not in the file
        signs = [_hidden(sign) for sign in signs if _effect(sign) in {MAX_SPEED, MIN_SPEED, _BAN}]
    below = (*plates, "") if signal.is_qualified else tuple(plates)
    signs = [with_plates(sign, below) for sign in signs]
    on_board = [sign for each in signal.board for sign in _by_meaning(each)]
    # Boards are for single lanes, or say what holds farther on
    signs += [_hidden(sign) for sign in on_board if _effect(sign) == MAX_SPEED]
    if signal.has_variable_board:
        signs.append(Sign(UNKNOWN, untold=MAX_SPEED))
    return tuple(sign for sign in signs if sign.name != UNKNOWN or sign.untold)


def _by_meaning(signal: RoadSignal) -> list[Sign]:
    """The signs by the catalogue and by semantics; untold if the two contradict each other."""
    own = catalogue_sign(signal)
    meant = [_meant(speed) for speed in signal.speeds if speed.type in _SPEEDS]
    if not meant:
        hides = own.name == UNKNOWN and may_limit(signal)
        return [Sign(UNKNOWN, untold=MAX_SPEED) if hides else own]
    if own.limit_mps is not None:
        limits = [x.limit_mps for x in meant if x.limit_mps is not None and x.name == own.name]
        if any(abs(limit - own.limit_mps) > _ALMOST_MPS for limit in limits):
            return [_hidden(own)]
        meant = [own if x.name == own.name else x for x in meant]
    same = own.name == UNKNOWN or _effect(own) in {_effect(sign) for sign in meant}
    return meant if same else [own, *meant]


def _meant(speed: SignalSpeed) -> Sign:
    name = _SPEEDS[speed.type]
    numbered = name in LIMITS | {MIN_SPEED}
    return Sign(
        name,
        speed.value_mps if numbered else None,
        effect_name(name) if numbered and speed.value_mps is None else "",
    )


def _effect(sign: Sign) -> str:
    return sign.untold or effect_name(sign.name)


def _hidden(sign: Sign) -> Sign:
    return Sign(UNKNOWN, untold=_effect(sign))


def sign_remarks(content: OpenDrive, posted: Mapping[str, Iterable[Posted]]) -> Iterator[str]:
    """Remarks on signs, and parts of the file, that are not read."""
    foreign = Counter(
        country_named(x.country)
        for road in content.roads.values()
        for x in road.signals
        if not (x.dynamic or x.speeds or x.type in NO_SIGN or has_catalogue(x))
    )
    if foreign:
        named = [f"{count} of {short(name)}" for name, count in foreign.most_common(_NAMED)]
        more = len(foreign) - len(named)
        some = ", ".join(named + ([f"{more} more countries"] if more else []))
        yield f"signs of countries whose catalogue is not known here are left out: {some}"
    hiding = sum(
        any(sign.untold == MAX_SPEED for sign in x.signs) for each in posted.values() for x in each
    )
    if hiding:
        yield (
            f"{hiding} signs limit the speed, or may do so, and the map does not tell how: their "
            "number or unit is not read, a plate limits them, they change, or are on boards; "
            "the limit behind them is unknown"
        )
    if content.included:
        names = first_of([f"`{short(name)}`" for name in content.included], _NAMED)
        yield f"files that the map includes are not read: {names}"
