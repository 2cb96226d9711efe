"""Turns an OpenDRIVE file into a map with a lanelet for each lane of each piece of a road."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Iterator, Mapping, Sequence, Set
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from rulec.diagnostics import first_of
from rulec.recordings.adjacency import side_by_lanes
from rulec.recordings.commonroad.traffic_signs import MAX_SPEED, MIN_SPEED
from rulec.recordings.encodings.file_values import short
from rulec.recordings.opendrive.content.elements import Lane, OpenDrive, record_at
from rulec.recordings.opendrive.content.file_reader import OPENDRIVE, read_file
from rulec.recordings.opendrive.crosswalks import crosswalks
from rulec.recordings.opendrive.junction_ways import Crossroads, crossroads
from rulec.recordings.opendrive.lane_furniture import (
    LaneFurniture,
    lane_furniture,
    sign_places,
)
from rulec.recordings.opendrive.lane_lines import Lines, lane_borders, places_beside, span_at
from rulec.recordings.opendrive.lane_links import LaneLinks, lane_links
from rulec.recordings.opendrive.lane_types import (
    LANE_TYPES,
    NO_LANE,
    RAMPS,
    lane_types,
    limit_at,
    mark_beside,
    road_types,
)
from rulec.recordings.opendrive.pieces import LaneKey, Pieces, RoadPiece, pieces_of
from rulec.recordings.opendrive.posted_signs import posted_on, sign_remarks
from rulec.recordings.opendrive.signal_catalogues import country_named
from rulec.recordings.opendrive.turning_speeds import without_turning_speeds
from rulec.recordings.polylines import shares_along
from rulec.recordings.recording import (
    LONGEST_M,
    REGULATING,
    Lanelet,
    ObservedLight,
    Points,
    Side,
)
from rulec.recordings.road_map import RoadMap

MOST_PLACES = 2_000_000
"""The most points of all borders of a map: some seconds, and 100 MB of memory."""

NARROWEST_M = 0.05
"""Lanes that are nowhere wider than this are left out."""

_MEETS_M, _JUMP_M = 1.0, 8.0
"""A bound meets one that begins up to the first from its end; farther than the second it is a jump.

Two lanes lie between.
"""

UNSEEN = ObservedLight({})
"""A traffic light whose states the map does not contain."""

_NAMED = 5


@dataclass(frozen=True, slots=True)
class _Whole:
    """What is known of all lanes of a file; ``borders`` has only lanes that become lanelets."""

    borders: Mapping[tuple[RoadPiece, int], Lines]
    links: LaneLinks
    furniture: Mapping[LaneKey, LaneFurniture]
    crossroads: Crossroads
    has_ramps: bool

    def is_there(self, key: LaneKey) -> bool:
        """Whether a lane has a lanelet."""
        return (key.piece, key.lane) in self.borders and key.is_driven

    def lane_keys(self) -> Iterator[LaneKey]:
        """The lanes that have a lanelet."""
        for piece, lane in self.borders:
            for forward in piece.directions(lane):
                yield LaneKey(piece, lane, forward)


def read_opendrive_map(path: Path) -> RoadMap:
    """Read the roads of an OpenDRIVE file.

    Raises RulecError R0610 for another kind of file, R0701 if it cannot be opened.
    """
    content = read_file(path)
    posted = posted_on(content)
    pieces = {
        road.id: pieces_of(road, sign_places(road, posted[road.id]))
        for road in content.roads.values()
    }
    links = lane_links(content, pieces)
    whole = _Whole(
        borders=_borders(path, pieces),
        links=links,
        furniture=lane_furniture(content, posted, pieces, links),
        crossroads=crossroads(content, links),
        has_ramps=any(
            lane.type in RAMPS
            for road in content.roads.values()
            for section in road.sections
            for lane in section.lanes.values()
        ),
    )
    within = {key.name for key in whole.lane_keys() if key.piece.road.junction}
    drawn, n_redrawn = _redrawn_to_linked_lanes({x.id: x for x in _lanelets(whole)}, within)
    lanelets, slow_turns = without_turning_speeds(drawn, within)
    for road in content.roads.values():
        for crossing in crosswalks(road, pieces[road.id], posted[road.id]):
            lanelets.setdefault(crossing.id, crossing)
    side = _side(content, lanelets)
    if not lanelets:
        raise OPENDRIVE.refused(path, "none of its roads has a lane")
    return RoadMap(
        form="OpenDRIVE map",
        lanelets=lanelets,
        side=side,
        country=_country(content),
        remarks=(*_remarks(content, side, slow_turns, n_redrawn), *sign_remarks(content, posted)),
    )


def _borders(path: Path, pieces: Pieces) -> dict[tuple[RoadPiece, int], Lines]:
    borders: dict[tuple[RoadPiece, int], Lines] = {}
    count = 0
    for road_pieces in pieces.values():
        for piece in road_pieces:
            if piece.is_short:
                continue
            try:
                borders_of = lane_borders(piece)
            except ValueError as problem:
                road = piece.road
                why = f"the road `{short(road.id)}` cannot be laid out: {problem}"
                raise OPENDRIVE.refused(path, why, road.line) from None
            for lane, lines in borders_of.items():
                count += lines.shape[1]
                wide = float(np.hypot(*(lines[1] - lines[0]).T).max()) > NARROWEST_M
                if piece.section.lanes[lane].type in NO_LANE or not wide:
                    continue
                if np.ptp(lines, axis=(0, 1)).max() > LONGEST_M:
                    why = f"a lane of the road `{short(piece.road.id)}` is longer than"
                    why = f"{why} {LONGEST_M / 1000:g} km"
                    raise OPENDRIVE.refused(path, why, piece.road.line)
                borders[piece, lane] = lines
            if count > MOST_PLACES:
                why = f"its lanes wind so much that they need over {MOST_PLACES:,} points"
                raise OPENDRIVE.refused(path, why, piece.road.line)
    return borders


def _lanelets(whole: _Whole) -> Iterator[Lanelet]:
    of_road: dict[str, set[str]] = defaultdict(set)
    for key in whole.lane_keys():
        of_road[key.piece.road.id].add(key.name)
    for key in whole.lane_keys():
        roads = whole.crossroads.yields_to.get(key.piece.road.id)
        first = None if roads is None else {name for road in roads for name in of_road[road]}
        yield _lanelet(whole, key, None if first is None else frozenset(first))


def _lanelet(whole: _Whole, key: LaneKey, first: frozenset[str] | None) -> Lanelet:
    piece, lane = key.piece, key.piece.section.lanes[key.lane]
    low, high = whole.borders[piece, key.lane]
    right, left = (low, high) if key.forward else (high[::-1], low[::-1])
    own = whole.furniture.get(key) or LaneFurniture()
    marks = [
        mark_beside(piece.section, key.lane, piece.middle, left=side == key.forward)
        for side in (True, False)
    ]
    has_own = limit_at(piece.section, lane, piece.middle) is not None
    # The lane's own limit comes before those of signs
    untold = own.untold - (own.signs & REGULATING) - ({MAX_SPEED} if has_own else set())
    return Lanelet(
        id=key.name,
        left=left,
        right=right,
        centre=(left + right) / 2,
        successors=_named(whole, whole.links.after.get(key, ())),
        predecessors=_named(whole, whole.links.before.get(key, ())),
        left_of=next(iter(_named(whole, [key.beside(left=True)])), None),
        right_of=next(iter(_named(whole, [key.beside(left=False)])), None),
        types=frozenset(_types(whole, piece, lane)),
        signs=frozenset(own.signs),
        untold_signs=frozenset(untold),
        limit_mps=None if MAX_SPEED in untold else _limit(piece, lane, own),
        minimum_mps=None if MIN_SPEED in untold else own.minimum_mps,
        lights=(UNSEEN,) if own.lit else (),
        lights_to=dict.fromkeys(_named(whole, own.lit_to), UNSEEN),
        left_mark=marks[0],
        right_mark=marks[1],
        stop_line=_stop_line(own),
        junction=whole.crossroads.junction_of.get(piece.road.id, ""),
        first=first,
    )


def _named(whole: _Whole, keys: Iterable[LaneKey]) -> tuple[str, ...]:
    """The ids of those of some lanes that have a lanelet."""
    return tuple([key.name for key in keys if whole.is_there(key)])


def _types(whole: _Whole, piece: RoadPiece, lane: Lane) -> Iterator[str]:
    road, types = piece.road, lane_types(piece.section, lane, piece.middle)
    setting = road_types(road, piece.middle)
    yield from types
    yield from setting
    if not types and "highway" in setting and whole.has_ramps:
        yield "mainCarriageWay"
    if any(x.start <= piece.middle < x.end for x in road.tunnels):
        yield "tunnel"
    if road.id in whole.crossroads.junction_of:
        yield "intersection"


def _limit(piece: RoadPiece, lane: Lane, own: LaneFurniture) -> float | None:
    """The limit of a lane: its own, or else that of a sign, or else that of the road's type."""
    limit = limit_at(piece.section, lane, piece.middle)
    if limit is None:
        limit = own.limit_mps
    kind = record_at(piece.road.types, piece.middle)
    return kind.limit_mps if limit is None and kind is not None else limit


def _stop_line(own: LaneFurniture) -> Points | None:
    if own.stop_line is None:
        return None
    key, s = own.stop_line
    low, high = span_at(key.piece, key.lane, s)
    ends = (high, low) if key.forward else (low, high)
    return places_beside(key.piece.road, [(s, t) for t in ends])


def _side(content: OpenDrive, lanelets: Mapping[str, Lanelet]) -> Side | None:
    """The side of traffic; None if it differs between roads or is unknown.

    Without a `rule` in the file it is the right side, unless all lanes show the left one. Before
    version 1.5, no file could have a `rule`, and the side is unknown unless lanes show it.
    """
    rules = {road.left_hand for road in content.roads.values()}
    if len(rules) > 1:
        return None
    if not any(road.has_rule for road in content.roads.values()):
        shown = side_by_lanes(x for x in lanelets.values() if not x.junction)
        return shown or ("right" if content.may_have_rules or _leads_both_ways(content) else None)
    return "left" if rules.pop() else "right"


def _leads_both_ways(content: OpenDrive) -> bool:
    """Whether some road has `driving` lanes on both sides; those on the right then lead forward."""
    sections = (section for road in content.roads.values() for section in road.sections)
    driven = ([x.id for x in section.lanes.values() if x.type == "driving"] for section in sections)
    return any(min(ids, default=0) < 0 < max(ids, default=0) for ids in driven)


def _country(content: OpenDrive) -> str:
    """The country that all signals and roads name; empty if they name none, or several."""
    named = {country_named(x.country) for road in content.roads.values() for x in road.signals}
    named |= {country_named(x.country) for road in content.roads.values() for x in road.types}
    codes = {x for x in named if len(x) == 3 and x.isascii() and x.isalpha()}
    return codes.pop() if len(codes) == 1 else ""


def _redrawn_to_linked_lanes(
    lanelets: Mapping[str, Lanelet], inside: Set[str]
) -> tuple[dict[str, Lanelet], int]:
    """The lanelets, and how many of them ``inside`` junctions are drawn anew.

    SUMO's netconvert draws all lanes of a way through a junction side by side, also where they
    lead into one: a link tells where such a lane leads, and its bounds go there. What is marked
    beside it is not known then. Neighbours remain, since traffic merges between such lanes.
    """
    changed, n_redrawn = dict(lanelets), 0
    for name in sorted(inside):
        own = lanelets[name]
        begin, end = (
            _misses(own, [lanelets[x] for x in names if x in lanelets], at)
            for names, at in ((own.predecessors, 0), (own.successors, -1))
        )
        if begin is None and end is None:
            continue
        begin, end = (np.zeros((2, 2)) if away is None else away for away in (begin, end))
        left, right = (
            points + (1 - share) * first + share * last
            for points, first, last in zip((own.left, own.right), begin, end, strict=True)
            for share in (shares_along(points)[:, None],)
        )
        centre = (left + right) / 2
        changed[name] = replace(
            own, left=left, right=right, centre=centre, left_mark=None, right_mark=None
        )
        n_redrawn += 1
    return changed, n_redrawn


def _misses(own: Lanelet, others: Sequence[Lanelet], at: int) -> Points | None:
    """How far the left and the right bound of the one lanelet after or before another one are off.

    None if a bound of the two meets, as where one is wider, or there is no single one.
    """
    if len(others) != 1:
        return None
    (other,) = others
    offsets = np.array([other.left[-1 - at] - own.left[at], other.right[-1 - at] - own.right[at]])
    away = np.hypot(*offsets.T)
    return offsets if away.min() > _MEETS_M and away.max() < _JUMP_M else None


def _remarks(
    content: OpenDrive, side: Side | None, slow_turns: int, n_redrawn: int
) -> Iterator[str]:
    strange: dict[str, None] = {}
    for road in content.roads.values():
        for section in road.sections:
            for lane in section.lanes.values():
                if lane.id != 0 and lane.type not in LANE_TYPES and lane.type not in NO_LANE:
                    strange[f"`{short(lane.type)}`"] = None
    if strange:
        some = first_of(list(strange), _NAMED)
        yield f"lanes of these types are treated as beside the carriageway: {some}"
    if len({road.left_hand for road in content.roads.values()}) > 1:
        yield "traffic keeps to the left on some roads of the map, and to the right on others"
    elif side is None:
        yield "the map does not give the side of traffic"
    if side == "left" and not any(road.has_rule for road in content.roads.values()):
        yield "traffic keeps to the left, as its lanes show: no road has a `rule`"
    if n_redrawn:
        yield (
            "lanes within junctions that end or begin beside those that they lead to "
            f"({n_redrawn}) are drawn anew, and what is marked beside them is taken as unknown"
        )
    if slow_turns:
        yield (
            f"limits of {slow_turns} lanes within junctions are below those before and after: they "
            "are treated as turning speeds, and those before apply"
        )
