"""Small worlds with meaning: ways that meet with random lags, near misses, turns back.

Written down before the words were looked at: what must not matter to a verdict, of any book.

1. A cut only opens verdicts. Of a part of the time: who violates a rule there violates it in the
   whole; and what is violated in the whole at a moment that the part has is violated or open in it,
   if the part begins at the beginning, or so long before that moment as a rule looks back.
2. Left and right: the words of the mirror image are the mirror's words.
3. The origin of time and of places, the order of participants and of lanelets, names, further
   points of lines, another world far away.
4. One recording alone or beside others, in one file or in two; one drive alone or with all.
5. A future is scored as it is judged when it has been recorded.
"""

from dataclasses import dataclass

import numpy as np

import rulec

STEP_S = 0.5
LANE_M = 3.5
REACH_M, EDGE_M = 90.0, 12.0
"""How far the arms of a junction reach, and where it begins (m)."""

SIZES = {
    "car": (4.6, 1.9),
    "truck": (9.5, 2.5),
    "bus": (12.0, 2.5),
    "motorcycle": (2.1, 0.8),
    "bicycle": (1.8, 0.6),
    "pedestrian": (0.5, 0.5),
    "unknown": (4.0, 1.8),
}
_SIGNS = ("STOP", "YIELD", "PRIORITY")
_COMPLETE = frozenset({"STOP", "YIELD", "PRIORITY", "light", "lanes", "rail", "roundabout"})
_TYPES = (("urban",), ("country",), ("highway", "mainCarriageWay"))


@dataclass(frozen=True)
class Way:
    """A line that one may drive along, by its corners (m)."""

    points: np.ndarray

    @property
    def places(self):
        """The arc length (m) at each corner."""
        return np.append(0.0, np.hypot(*np.diff(self.points, axis=0).T).cumsum())

    def at(self, places, aside):
        """x, y and heading at arc lengths; straight on beyond both ends.

        ``aside``: how far to the left (m) at an arc length. Nobody moves aside who stands.
        """
        more = 0.01
        slope = np.arctan2(aside(places + more) - aside(places), more)
        aside = aside(places)
        own = self.places
        ahead = np.unwrap(np.arctan2(*np.diff(self.points, axis=0).T[::-1]))
        middles = (own[:-1] + own[1:]) / 2
        heading = np.interp(places, middles, ahead)
        x, y = (np.interp(places, own, part) for part in self.points.T)
        beyond = places - places.clip(0, own[-1])
        x = x + beyond * np.cos(heading) - aside * np.sin(heading)
        y = y + beyond * np.sin(heading) + aside * np.cos(heading)
        return x, y, heading + slope


def small_world(pick):
    """A recording of right-hand traffic; vehicles are called by numbers."""
    return (_junction if pick.random() < 0.65 else _road)(pick)


def _times(pick):
    return STEP_S * np.arange(pick.randrange(8, 33))


def _driven(pick, t, meets, at_m, speed):
    """Arc lengths (m) of one that is at a place at a time (s), and brakes, waits or speeds up."""
    speeds = np.full(len(t), speed)
    begin, lasts = pick.uniform(-1, t[-1]), pick.uniform(0.5, 5)
    match pick.randrange(6):
        case 0:  # brakes to a stand, waits, and goes on
            down = speed / pick.uniform(1.5, 4)
            speeds = np.interp(
                t,
                [begin, begin + down, begin + down + lasts, begin + 2 * down + lasts],
                [speed, 0, 0, speed],
            )
        case 1:
            speeds = np.interp(t, [begin, begin + lasts], [speed, speed * pick.uniform(0.2, 0.9)])
        case 2:
            speeds = np.interp(t, [begin, begin + lasts], [speed, speed * pick.uniform(1.1, 1.6)])
        case 3 if pick.random() < 0.5:
            speeds = np.interp(t, [begin, begin + 3], [0, speed])
    way = np.append(0.0, ((speeds[1:] + speeds[:-1]) / 2 * STEP_S).cumsum())
    return way - np.interp(meets, t, way) + at_m, speeds


def _kept(aside):
    return lambda places: aside + 0 * places


_MIDDLE = _kept(0.0)


def _body(pick, name, kind, t, way, motion, aside=_MIDDLE):
    """A participant on a way; some are there only for a part of the time."""
    places, _ = motion
    x, y, heading = way.at(places, aside)
    length, width = SIZES[kind]
    begin, end = 0, len(t)
    if pick.random() < 0.15:
        begin, end = sorted(pick.sample(range(len(t) + 1), 2))
    own = slice(begin, end)
    lamps = None
    if kind not in {"pedestrian", "bicycle"} and pick.random() < 0.5:
        names = ("left_indicator", "right_indicator", "hazard_lights", "brake_light")
        lamps = {lamp: [pick.random() < 0.1] * (end - begin) for lamp in names}
    return rulec.build_participant(
        name, kind, t[own], x[own], y[own], step_s=STEP_S, heading=heading[own],
        length=length, width=width, lamps=lamps,
    )  # fmt: skip


def _named(pick, lanes, bodies):
    complete = pick.choice((frozenset(), _COMPLETE, _COMPLETE | {"arrivals", "officer"}))
    whole = max(len(body.states) for body in bodies)
    if "arrivals" in complete and any(len(body.states) < whole for body in bodies):
        complete = _COMPLETE
    return rulec.build_recording(
        lanes, bodies, step_s=STEP_S, side="right", complete=complete, country="DEU"
    )


def _kind(pick):
    return pick.choice(("car",) * 6 + ("truck", "bus", "motorcycle", "bicycle", "unknown"))


# A junction ----------------------------------------------------------------------------------


def _across(angle):
    """The direction to the right of one that drives away from the middle of the junction."""
    return np.array([np.sin(angle), -np.cos(angle)])


def _bent(start, end, begins, arrives):
    """A quadratic Bézier curve between two lines; straight where they have one direction."""
    turned = np.sin(arrives - begins)
    middle = (start + end) / 2
    if abs(turned) > 0.2:
        gap = end - start
        ahead = np.array([np.cos(begins), np.sin(begins)])
        back = np.array([np.cos(arrives), np.sin(arrives)])
        middle = start + ahead * (gap[0] * back[1] - gap[1] * back[0]) / turned
    part = np.linspace(0, 1, 9)[:, None]
    return (1 - part) ** 2 * start + 2 * part * (1 - part) * middle + part**2 * end


def _junction(pick):
    t = _times(pick)
    angles = [0, np.pi / 2, np.pi, 3 * np.pi / 2]
    if pick.random() < 0.4:
        angles = [angle + pick.uniform(-0.35, 0.35) for angle in angles]
    arms = sorted(pick.sample(range(4), pick.choice((2, 3, 3, 4, 4, 4))))
    lanes_in = {arm: pick.choice((1, 1, 2)) for arm in arms}
    scheme, first = pick.randrange(5), pick.choice(arms) % 2
    about = {"types": pick.choice(_TYPES[:2]), "limit_mps": pick.choice((30, 50, 70)) / 3.6}
    lanes, ways, outs = [], {}, {}

    def lines(arm, number, *, away):
        angle = angles[arm]
        out, off = np.array([np.cos(angle), np.sin(angle)]), LANE_M * (number + 0.5)
        beside = _across(angle) * (off if away else -off)
        near, far = out * EDGE_M + beside, out * REACH_M + beside
        return np.array([near, far] if away else [far, near])

    for arm in arms:
        outs[arm] = lines(arm, 0, away=True)
        lanes.append(rulec.build_lanelet(f"o{arm}", outs[arm], LANE_M, **about))
    for arm in arms:
        for number in range(lanes_in[arm]):
            line = lines(arm, number, away=False)
            sign, more = (), {}
            if scheme in {1, 2}:
                sign = ("PRIORITY",) if arm % 2 == first else (_SIGNS[scheme - 1],)
            if scheme == 3:
                phases = (("green", 12), ("yellow", 6), ("red", 14))
                begin = 0 if arm % 2 == first else 16
                more = {"lights": [rulec.Light(begin - pick.randrange(4) * 0, phases)]}
            if scheme in {1, 2, 3} and pick.random() < 0.7:
                end, side = line[-1], _across(angles[arm]) * LANE_M / 2
                more["stop_line"] = [end + side, end - side]
            targets = [other for other in arms if other != arm]
            names = [f"w{arm}.{number}.{other}" for other in targets]
            beside = {}
            if lanes_in[arm] == 2:
                beside = {"left_of": f"i{arm}.1"} if number == 0 else {"right_of": f"i{arm}.0"}
            lanes.append(
                rulec.build_lanelet(
                    f"i{arm}.{number}", line, LANE_M, successors=names, signs=sign, **about,
                    **beside, **more,
                )
            )  # fmt: skip
            for name, other in zip(names, targets, strict=True):
                bend = _bent(line[-1], outs[other][0], angles[arm] + np.pi, angles[other])
                lanes.append(
                    rulec.build_lanelet(
                        name, bend, LANE_M, successors=[f"o{other}"], junction="j", **about
                    )
                )
                ways[name] = Way(np.concatenate((line[:-1], bend, outs[other][1:])))
    if pick.random() < 0.4:
        arm = pick.choice(arms)
        out, side = np.array([np.cos(angles[arm]), np.sin(angles[arm])]), _across(angles[arm])
        walk = Way(np.array([out * 16 - side * 9, out * 16 + side * 9]))
        lanes.append(rulec.build_lanelet("z", walk.points, 4.0, types=["crosswalk"]))
    else:
        walk = None
    meets, bodies = pick.uniform(0.2, 1.0) * t[-1], []
    for number in range(pick.choice((2, 2, 3, 4))):
        kind, name = _kind(pick), pick.choice(sorted(ways))
        way = ways[name]
        speed = pick.uniform(3, 6) if kind == "bicycle" else pick.uniform(4, 15)
        middle = float(way.places[-1]) / 2
        lag = pick.choice((0.0, pick.uniform(-1, 1), pick.uniform(-5, 5)))
        motion = _driven(pick, t, meets + lag, middle, speed)
        aside = pick.uniform(-1.4, -0.9) if kind == "bicycle" else pick.uniform(-0.3, 0.3)
        bodies.append(_body(pick, str(number + 1), kind, t, way, motion, _kept(aside)))
    if walk is not None:
        motion = _driven(pick, t, meets + pick.uniform(-4, 4), 9.0, pick.uniform(0.8, 2.0))
        bodies.append(_body(pick, "p", "pedestrian", t, walk, motion))
    return _named(pick, lanes, bodies)


# A road --------------------------------------------------------------------------------------


def _road(pick):
    t, count, back = _times(pick), pick.randrange(1, 5), pick.choice((0, 1, 1, 2))
    kind = pick.choice(_TYPES)
    limit = {"urban": 50, "country": 100, "highway": 120}[kind[0]] / 3.6
    about = {"types": kind, "limit_mps": pick.choice((limit, None))}
    inner = pick.choice(("solid", "broken", None))
    lanes, middles = [], {}
    for k in range(count):
        y = LANE_M * (k - count + 0.5)
        middles[f"e{k}"] = Way(np.array([(-150.0, y), (500.0, y)]))
        lanes.append(
            rulec.build_lanelet(
                f"e{k}", middles[f"e{k}"].points, LANE_M,
                left_of=f"e{k + 1}" if k + 1 < count else None,
                right_of=f"e{k - 1}" if k else None,
                left_mark="broken" if k + 1 < count else inner,
                right_mark="broken" if k else "solid", **about,
            )
        )  # fmt: skip
    for k in range(back):
        y = LANE_M * (back - k - 0.5)
        middles[f"b{k}"] = Way(np.array([(500.0, y), (-150.0, y)]))
        lanes.append(
            rulec.build_lanelet(
                f"b{k}", middles[f"b{k}"].points, LANE_M,
                left_of=f"b{k + 1}" if k + 1 < back else None,
                right_of=f"b{k - 1}" if k else None,
                left_mark="broken" if k + 1 < back else inner,
                right_mark="broken" if k else "solid", **about,
            )
        )  # fmt: skip
    if pick.random() < 0.3:
        ends = [(150.0, -LANE_M * count - 3), (150.0, LANE_M * back + 3)]
        lanes.append(rulec.build_lanelet("z", ends, 4.0, types=["crosswalk"]))
    bodies = [_on_road(pick, str(n + 1), t, middles, limit) for n in range(pick.randrange(2, 7))]
    if pick.random() < 0.25:
        walk = Way(np.array([(150.0, -LANE_M * count - 3), (150.0, LANE_M * back + 3)]))
        motion = _driven(pick, t, pick.uniform(0, t[-1]), 6.0, pick.uniform(0.8, 2.0))
        bodies.append(_body(pick, "p", "pedestrian", t, walk, motion))
    return _named(pick, lanes, bodies)


def _on_road(pick, name, t, middles, limit):
    lane, kind = pick.choice(sorted(middles)), _kind(pick)
    way = middles[lane]
    speed = pick.uniform(3, 7) if kind == "bicycle" else limit * pick.uniform(0.4, 1.2)
    start = pick.uniform(100, 260) + (200 if lane[0] == "b" else 0)
    motion = _driven(pick, t, 0.0, start, speed)
    off = pick.uniform(-0.3, 0.3)
    aside = _kept(off)
    turn = pick.random()
    if turn < 0.45 and speed > 4:
        by = LANE_M * pick.choice((-1, 1, 1, 2)) * pick.choice((1.0, 1.0, 0.5))
        begin = start + speed * pick.uniform(-2, t[-1])
        length, back = speed * pick.uniform(2.5, 5), pick.choice((0.0, 0.0, 1.0))

        def aside(places):
            there, again = (
                (1 - np.cos(np.pi * ((places - at) / length).clip(0, 1))) / 2
                for at in (begin, begin + 1.3 * length)
            )
            return off + by * (there - back * again)

    elif turn < 0.5:
        motion = 2 * start - motion[0], -motion[1]  # backwards
    elif turn < 0.58 and "b0" in middles and "e0" in middles:
        y0 = middles["e0"].points[0, 1]
        y1 = middles["b0"].points[0, 1]
        bend = np.linspace(-np.pi / 2, np.pi / 2, 13)
        x = start - 150 + pick.uniform(10, 60)
        radius = (y1 - y0) / 2
        arc = np.column_stack((x + radius * np.cos(bend), (y0 + y1) / 2 + radius * np.sin(bend)))
        way = Way(np.concatenate(([(-150.0, y0)], arc, [(-150.0, y1)])))
        motion = _driven(pick, t, pick.uniform(0, t[-1]), x + 150 + radius, pick.uniform(2, 5))
        kind, aside = "car", _kept(0.0)
    return _body(pick, name, kind, t, way, motion, aside)
