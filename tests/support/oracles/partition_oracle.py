"""The partition and its graph once more, straight from the definitions, with polygons.

Slow and unoptimised on purpose: it shares no code with ``rulec.partition`` and is what that is
compared with. Lengths below ``HAIR`` count as nothing.
"""

from dataclasses import dataclass

import shapely
from shapely import Polygon
from shapely.affinity import translate

from rulec.scenario import Footprints, Obstacle, Scenario, Trajectory

HAIR = 1e-5
FAR = 1000.0
CLEARANCE = 0.25


@dataclass(frozen=True)
class BookCell:
    surface: str
    signature: tuple
    polygon: Polygon

    @property
    def key(self):
        """For comparing; shifted a little, so that no figure is halfway between two roundings."""
        figures = (*self.polygon.bounds, self.polygon.area)
        return self.surface, self.signature, *(round(x + 0.00137, 2) for x in figures)


def rectangle(s0, s1, d0, d1):
    return shapely.box(s0, d0, s1, d1)


def centre(obstacle: Obstacle, t: float):
    m = obstacle.motion
    if isinstance(m, Trajectory):
        for (t0, s0, d0), (t1, s1, d1) in zip(m.points, m.points[1:], strict=False):
            if t0 <= t <= t1:
                return s0 + (s1 - s0) * (t - t0) / (t1 - t0), d0 + (d1 - d0) * (t - t0) / (t1 - t0)
        return None
    acceleration = m.acceleration if m.speed != 0 or m.acceleration > 0 else 0.0
    moving = t
    if m.speed * acceleration < 0 and abs(m.speed) < abs(acceleration) * t:
        moving = abs(m.speed / acceleration)
    s = m.s + (m.speed + (m.speed + acceleration * moving)) / 2 * moving
    d = m.d + m.lateral_speed * moving
    if m.until_d is not None and (d - m.until_d) * m.lateral_speed > 0:
        d = m.until_d
    return s, d


def footprint(motion: Footprints, t: float):
    """Bounds at a time; None if one of those that they lie between is not known."""
    known = dict(zip(motion.times, motion.boxes, strict=True))
    before = max((x for x in known if x <= t), default=None)
    after = min((x for x in known if x >= t), default=None)
    if before is None or after is None or known[before] is None or known[after] is None:
        return None
    one, other = (
        (box.s_min, box.s_max, box.d_min, box.d_max) for box in (known[before], known[after])
    )
    part = 0.0 if before == after else (t - before) / (after - before)
    return tuple((1 - part) * x + part * y for x, y in zip(one, other, strict=True))


def body(obstacle: Obstacle, start: float, end: float):
    """Bounds of what is swept, from the centre where a piece of the motion begins or ends."""
    times = {start, end}
    if isinstance(obstacle.motion, Footprints):
        times |= {t for t in obstacle.motion.times if start <= t <= end}
        boxes = [box for t in times if (box := footprint(obstacle.motion, t)) is not None]
        if not boxes:
            return None
        lows, highs = zip(*[((b[0], b[2]), (b[1], b[3])) for b in boxes], strict=True)
        low, high = (
            [min(x) for x in zip(*lows, strict=True)],
            [max(x) for x in zip(*highs, strict=True)],
        )
        return low[0], high[0], low[1], high[1]
    if isinstance(obstacle.motion, Trajectory):
        times |= {p[0] for p in obstacle.motion.points if start <= p[0] <= end}
    centres = [c for t in times if (c := centre(obstacle, t)) is not None]
    if not centres:
        return None
    ss, ds = [c[0] for c in centres], [c[1] for c in centres]
    length, width = obstacle.length / 2, obstacle.width / 2
    return min(ss) - length, max(ss) + length, min(ds) - width, max(ds) + width


def lanes(scenario: Scenario):
    """Per lane its bounds and its polygon, without the parts that are missing."""
    road = scenario.road
    for i, (right, left) in enumerate(zip(road.lanes, road.lanes[1:], strict=False), start=1):
        piece = rectangle(*road.s, right, left)
        for gap in road.missing:
            if gap.lane == i:
                piece = piece.difference(rectangle(*gap.s, right, left))
        yield right, left, piece


def width(scenario: Scenario, extent: str):
    """How far from its centre ego keeps the road's outer bounds."""
    ego = scenario.ego
    own = {
        "lane": 0.0,
        "body": ego.width,
        "clearance": ego.width or (ego.bounds and ego.bounds.width),
    }
    return (own[extent] or 0.0) / 2


def aside(scenario: Scenario, extent: str):
    """How far from its centre ego keeps others."""
    return width(scenario, extent) + (CLEARANCE if extent == "clearance" else 0.0)


def road_for(scenario: Scenario, extent: str):
    """Where ego's centre may be: the road, without what is too close to the verge for ego.

    Where ego starts closer to a verge than that, it may stay as close.
    """
    low, high = scenario.road.lanes[0], scenario.road.lanes[-1]
    wide = width(scenario, extent)
    right = low + min(wide, scenario.ego.d - low)
    left = high - min(wide, high - scenario.ego.d)
    road = shapely.union_all([piece for _, _, piece in lanes(scenario)])
    return road.intersection(rectangle(-FAR, FAR, right, left))


def taken(scenario, obstacle, start: float, end: float, partition: str, extent: str):
    """Rectangle and direction ("s" or a walking angle); None if it is not on the road."""
    swept = body(obstacle, start, end)
    if swept is None:
        return None
    s0, s1, d0, d1 = swept
    touched = [
        (right, left)
        for right, left, piece in lanes(scenario)
        if piece.intersection(rectangle(*swept)).area > HAIR * HAIR
        and min(left, d1) - max(right, d0) > HAIR
    ]
    if not touched:
        return None
    wide = (s0, s1, min(x[0] for x in touched), max(x[1] for x in touched))
    half = aside(scenario, extent)
    if extent == "body":
        wide = (s0, s1, d0 - half, d1 + half)
    if extent == "clearance":
        # Of the outermost lanes that it touches, each that its middle is beside, and ego fits in
        outermost = [min(touched), max(touched)]
        free = [(outermost[0][0], d0), (d1, outermost[1][1])]
        fits = [high - low >= 2 * half - 1e-6 for low, high in free]
        beside = [(d0 + d1) / 2 > outermost[0][1], (d0 + d1) / 2 < outermost[1][0]]
        right = d0 - half if fits[0] and beside[0] else outermost[0][0]
        left = d1 + half if fits[1] and beside[1] else outermost[1][1]
        wide = (s0, s1, right, left)
    if partition == "fine" or obstacle.type != "pedestrian":
        return wide, 0
    turned = {0: 0, 45: 90, 90: 90, 180: 180, -90: -90, -135: -90}[obstacle.walking_direction]
    if turned in (0, 180):
        return wide, turned
    for stretch in scenario.road.surfaces if extent != "body" else ():
        c0, c1 = stretch.s
        if min(c1, s1) - max(c0, s0) > HAIR:
            s0, s1 = min(s0, c0), max(s1, c1)
    beside = half if extent == "body" else 0.0
    return (s0, s1, d0 - beside, d1 + beside), turned


def regions(box, angle, partition):
    """Letter -> polygon, for one obstacle."""
    s0, s1, d0, d1 = box
    if partition == "fine":
        stations = {"behind": (-FAR, s0), "beside": (s0, s1), "in_front_of": (s1, FAR)}
        laterals = {"right_of": (-FAR, d0), "same_lane": (d0, d1), "left_of": (d1, FAR)}
        return {
            (a, b): rectangle(*stations[a], *laterals[b])
            for a in stations
            for b in laterals
            if (a, b) != ("beside", "same_lane")
        }
    if angle in (0, 180):
        low, high = rectangle(-FAR, s0, d0, d1), rectangle(s1, FAR, d0, d1)
        right, left = rectangle(-FAR, FAR, -FAR, d0), rectangle(-FAR, FAR, d1, FAR)
        if angle == 0:
            return {"b": low, "f": high, "l": left, "r": right}
        return {"b": high, "f": low, "l": right, "r": left}
    below, above = rectangle(s0, s1, -FAR, d0), rectangle(s0, s1, d1, FAR)
    before, after = rectangle(-FAR, s0, -FAR, FAR), rectangle(s1, FAR, -FAR, FAR)
    if angle == 90:
        return {"b": below, "f": above, "l": before, "r": after}
    return {"b": above, "f": below, "l": after, "r": before}


def parts(geometry):
    return [p for p in getattr(geometry, "geoms", [geometry]) if p.area > HAIR]


def free_space(scenario: Scenario, start: float, end: float, partition: str, extent: str):
    road = road_for(scenario, extent)
    for obstacle in scenario.obstacles:
        found = taken(scenario, obstacle, start, end, partition, extent)
        if found is not None:
            road = road.difference(rectangle(*found[0]))
    return road


def cells(
    scenario: Scenario, start: float, end: float, partition: str, extent: str
) -> list[BookCell]:
    road = road_for(scenario, extent)
    crossings = shapely.union_all(
        [rectangle(*x.s, -FAR, FAR) for x in scenario.road.surfaces] or [Polygon()]
    )
    pieces = [("carriageway", (), p) for p in parts(road.difference(crossings))] + [
        ("crossing", (), p) for p in parts(road.intersection(crossings))
    ]
    for obstacle in scenario.obstacles:
        found = taken(scenario, obstacle, start, end, partition, extent)
        if found is None:
            continue
        pieces = [
            (surface, (*signature, (obstacle.id, letter)), part)
            for surface, signature, polygon in pieces
            for letter, region in regions(*found, partition).items()
            for part in parts(polygon.intersection(region))
        ]
    return [BookCell(*piece) for piece in pieces]


def is_step(a: Polygon, b: Polygon, adjacency: str) -> bool:
    """May one go from a to b?"""
    if a.distance(b) > HAIR / 8:
        return False
    border = a.buffer(HAIR / 4, cap_style="square", join_style="mitre").intersection(b)
    if adjacency == "touch":
        return True
    segments = [p.bounds for p in getattr(border, "geoms", [border])]
    sideways = any(s1 - s0 > HAIR for s0, _, s1, _ in segments)
    if sideways or adjacency == "forward":
        return sideways or translate(a, xoff=HAIR / 2).intersection(b).area > HAIR * HAIR
    return any(d1 - d0 > HAIR for _, d0, _, d1 in segments)


def continues(a: Polygon, b: Polygon, instant: list[BookCell]) -> bool:
    return any(
        a.intersection(i.polygon).area > HAIR and b.intersection(i.polygon).area > HAIR
        for i in instant
    )
