"""Signals as they apply to lanes: lights, signs, limits, stop lines.

Lights, stop and give-way signs and stop lines belong to the lane before their junction, also where
the file puts them on the roads within the junction, at the beginning of its ways. Other signs apply
from their position to the end of their road, and never before it.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field

from rulec.recordings.commonroad.traffic_signs import (
    MAX_SPEED,
    MIN_SPEED,
    UNKNOWN,
    ZONE,
    Sign,
    effect_name,
)
from rulec.recordings.opendrive.content.elements import (
    MapRoad,
    OpenDrive,
    Orientation,
    RoadObject,
)
from rulec.recordings.opendrive.lane_lines import span_at
from rulec.recordings.opendrive.lane_links import LaneLinks
from rulec.recordings.opendrive.lane_types import NO_LANE, lane_types
from rulec.recordings.opendrive.pieces import LaneKey, Pieces, RoadPiece
from rulec.recordings.opendrive.posted_signs import Posted
from rulec.recordings.opendrive.signal_catalogues import (
    AT_LINE,
    HOLDS_ON,
    PRIORITY_SIGNS,
    is_light,
    is_stop_line,
)
from rulec.recordings.recording import NO_LANES

AT_JUNCTION_M = 40.0
"""A signal at most this far before the end of a road belongs to the junction or road after it."""

_HAIR_M = 1e-6


@dataclass(slots=True)
class LaneFurniture:
    """Signals along a lane; ``lit_to`` are the ways on that a light is for, if the file says so.

    These are in the file's order. ``untold`` are the names of signs that may apply: there is one,
    but the file does not say for whom, when, or with which number. ``stop_line`` is the lane in
    which the line lies, and its ``s``.
    """

    # Not frozen: signals are added one by one
    signs: set[str] = field(default_factory=set)
    untold: set[str] = field(default_factory=set)
    limit_mps: float | None = None
    minimum_mps: float | None = None
    lit: bool = False
    lit_to: dict[LaneKey, None] = field(default_factory=dict)
    stop_line: tuple[LaneKey, float] | None = None

    def add(self, sign: Sign) -> None:
        """Add a sign to those that are told or untold."""
        if sign.untold:
            self.untold.add(sign.untold)
        if sign.name != UNKNOWN:
            self.signs.add(sign.name)

    def hold(self, sign: Sign) -> None:
        """Let a sign apply from here on, and end those that it ends."""
        ended = HOLDS_ON.get(sign.name, frozenset())
        effect = sign.untold or effect_name(sign.name)
        self.signs -= ended
        if sign.name == UNKNOWN:
            # Whether another one still applies is unknown
            self.signs.discard(effect)
        if not sign.untold:
            self.untold -= {effect, *ended}
        if effect == MAX_SPEED or MAX_SPEED in ended:
            self.limit_mps = sign.limit_mps
        if effect == MIN_SPEED or MIN_SPEED in ended:
            self.minimum_mps = sign.limit_mps
        if MAX_SPEED in ended and ZONE in self.signs:
            # What ended was within a zone, whose limit holds again
            self.untold.add(MAX_SPEED)
        if not ended:
            self.add(sign)


@dataclass(slots=True)
class _Street:
    pieces: Pieces
    links: LaneLinks
    by_lane: dict[LaneKey, LaneFurniture] = field(default_factory=dict)

    def at(self, key: LaneKey) -> LaneFurniture:
        """The signals along a lane."""
        return self.by_lane.setdefault(key, LaneFurniture())


def sign_places(road: MapRoad, posted: Iterable[Posted]) -> list[float]:
    """The values of ``s`` at which signals make something begin or end, where the road is cut."""
    return [x.signal.s for x in posted if _parts(road, x)]


def _parts(road: MapRoad, posted: Posted) -> bool:
    if any(HOLDS_ON.keys() & {sign.name, sign.untold} for sign in posted.signs):
        return True
    left = {"+": road.length - posted.signal.s, "-": posted.signal.s}
    ahead = left.get(posted.signal.orientation, min(left.values()))
    stands_alone = ahead > AT_JUNCTION_M and not road.junction
    return stands_alone and (bool(posted.signs) or is_light(posted.signal, ()))


def lane_furniture(
    content: OpenDrive,
    posted: Mapping[str, Sequence[Posted]],
    pieces: Pieces,
    links: LaneLinks,
) -> Mapping[LaneKey, LaneFurniture]:
    """The signals along each lane that has any."""
    street = _Street(pieces, links)
    controlled = {signal for signals in content.controllers.values() for signal in signals}
    for road in content.roads.values():
        for signal in sorted(posted[road.id], key=lambda x: x.signal.s):
            _place_signal(street, road, signal, controlled)
        for backward in sorted(posted[road.id], key=lambda x: -x.signal.s):
            _hold_on(street, road, backward, forward=False)
        for thing in road.objects:
            if is_stop_line_object(thing):
                _place_line(street, road, thing)
    return street.by_lane


def _place_signal(
    street: _Street, road: MapRoad, posted: Posted, controlled: frozenset[str] | set[str]
) -> None:
    _hold_on(street, road, posted, forward=True)
    light, line = is_light(posted.signal, controlled), is_stop_line(posted.signal)
    signs = [sign for sign in posted.signs if _is_at_line(sign)]
    if not (light or line or signs):
        return
    for key in _posted_lanes(street, road, posted):
        for entry, way in _entries(street, road, key, posted.signal.s):
            own = street.at(entry)
            if light:
                own.lit = True
                if way is not None:
                    own.lit_to[way] = None
            elif line:
                own.stop_line = key, posted.signal.s
            for sign in signs:
                own.add(sign)
        for sign in signs:
            if (sign.untold or sign.name) in PRIORITY_SIGNS and not road.junction:
                for onward in _onward(street, key, posted.signal.s):
                    street.at(onward).add(sign)


def _is_at_line(sign: Sign) -> bool:
    return (sign.untold or sign.name) in AT_LINE


def _hold_on(street: _Street, road: MapRoad, posted: Posted, *, forward: bool) -> None:
    """Apply signs from their place onward, to lanes driven in the given direction of the road."""
    signs = [sign for sign in posted.signs if not _is_at_line(sign)]
    if not signs:
        return
    for key in _posted_lanes(street, road, posted):
        for onward in _onward(street, key, posted.signal.s) if key.forward == forward else ():
            for sign in signs:
                street.at(onward).hold(sign)


def _posted_lanes(street: _Street, road: MapRoad, posted: Posted) -> list[LaneKey]:
    piece = piece_at(street.pieces[road.id], posted.signal.s)
    return _lanes_at(piece, posted.signal.orientation, posted.signal.lanes)


def _lanes_at(
    piece: RoadPiece, orientation: Orientation, lanes: Sequence[tuple[int, int]] | None
) -> list[LaneKey]:
    """The lanes that a signal is for: those that it names, or else those of its direction.

    If all the lanes that it names are driven in the other direction, the names count.
    """
    keys = [
        key
        for key in drivable(piece)
        if lanes is None or any(low <= key.lane <= high for low, high in lanes)
    ]
    fitting = [key for key in keys if orientation == "none" or key.forward == (orientation == "+")]
    return fitting if fitting or lanes is None else keys


def drivable(piece: RoadPiece) -> Iterator[LaneKey]:
    """The lanes of a piece that belong to the carriageway."""
    for lane in piece.section.lanes.values():
        types = lane_types(piece.section, lane, piece.middle)
        if lane.id != 0 and lane.type not in NO_LANE and not NO_LANES.intersection(types):
            for forward in piece.directions(lane.id):
                yield LaneKey(piece, lane.id, forward)


def piece_at(pieces: Sequence[RoadPiece], s: float) -> RoadPiece:
    """The piece of a road at ``s``; beyond the ends of the road, the nearest one."""
    long = [piece for piece in pieces if not piece.is_short] or list(pieces)
    return min(long, key=lambda piece: max(piece.start - s, s - piece.end, 0.0))


def _onward(street: _Street, key: LaneKey, s: float) -> list[LaneKey]:
    """The lanes from ``s`` on to the end of the road, as long as each has only one successor."""
    return [
        x
        for x in _chain(street, key)
        if (x.piece.middle >= s - _HAIR_M if key.forward else x.piece.middle <= s + _HAIR_M)
    ]


def _chain(street: _Street, key: LaneKey, *, back: bool = False) -> list[LaneKey]:
    """The lanes of one road that follow a lane, or precede it if ``back``, without a branch."""
    links = street.links.before if back else street.links.after
    chain, seen = [key], {key}
    while True:
        following = [x for x in links.get(chain[-1], ()) if x.piece.road is key.piece.road]
        if len(following) != 1 or following[0] in seen:
            return chain
        chain += following
        seen.update(following)


def _entries(
    street: _Street, road: MapRoad, key: LaneKey, s: float
) -> Iterator[tuple[LaneKey, LaneKey | None]]:
    """The lanes at whose ends a signal at ``s`` applies, and the way on that it is for, if any."""
    if road.junction:
        first = _chain(street, key, back=True)[-1]
        for entry in street.links.before.get(first, ()):
            yield entry, first
        return
    chain = _chain(street, key)
    last = chain[-1]
    if abs(last.back.start - s) > AT_JUNCTION_M:
        # It stands away from junctions, where the road is cut
        passed = [
            x
            for x in (*reversed(_chain(street, key, back=True)), *chain[1:])
            if (x.piece.middle < s if key.forward else x.piece.middle > s)
        ]
        yield passed[-1] if passed else key, None
        return
    yield _before_junction(street, last), None


def _before_junction(street: _Street, last: LaneKey) -> LaneKey:
    """The last lane before the junction that a road leads to, past short roads in between."""
    key, way = last, 0.0
    while True:
        following = street.links.after.get(key, ())
        if len(following) != 1 or following[0].piece.road.junction:
            break
        way += following[0].piece.end - following[0].piece.start
        if way > AT_JUNCTION_M or following[0] == last:
            return last
        key = following[0]
    return key


def is_stop_line_object(thing: RoadObject) -> bool:
    """Whether an object is a stop line by its type, subtype or name."""
    words = (thing.type, thing.subtype, thing.name)
    plain = {"".join(c for c in word.lower() if c.isalpha()) for word in words}
    return "stopline" in plain


def _place_line(street: _Street, road: MapRoad, thing: RoadObject) -> None:
    reach = max(thing.length, thing.width) / 2
    spans = [t for _, t in thing.corners] if thing.on_road else [thing.t - reach, thing.t + reach]
    piece = piece_at(street.pieces[road.id], thing.s)
    low, high = min(spans), max(spans)
    for key in _lanes_at(piece, thing.orientation, None):
        if low <= sum(span_at(piece, key.lane, thing.s)) / 2 <= high:
            for entry, _ in _entries(street, road, key, thing.s):
                street.at(entry).stop_line = key, thing.s
