"""CommonRoad's files read from their XML alone, for labels that know nothing of rulec."""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

_LIMIT_SIGNS = {"274", "R2-1", "274.1"}
_OVER_S = 1.0
_MOTORWAYS = "US101", "DEU_A9"
"""Files from these roads; few say so themselves."""


@dataclass
class RawLanelet:
    """A lanelet: bounds, limits (m/s) by its signs, ids of its lights."""

    id: str
    left: np.ndarray
    right: np.ndarray
    after: tuple
    types: frozenset
    limits: list
    lights: tuple
    stop_line: np.ndarray | None

    @cached_property
    def centre(self):
        return (self.left + self.right) / 2

    @cached_property
    def _along(self):
        return np.append(0.0, np.hypot(*np.diff(self.centre, axis=0).T).cumsum())

    def frame(self, places):
        """Places as (along, to the left) of the centre line; beyond its ends straight on."""
        starts, ends = self.centre[:-1], self.centre[1:]
        ahead = ends - starts
        lengths = np.hypot(*ahead.T)
        ahead = ahead / lengths[:, None]
        offset = places[:, None] - starts[None]
        along = np.einsum("psk,sk->ps", offset, ahead)
        free = along.copy()
        low = np.zeros(len(lengths))
        high = lengths.copy()
        low[0], high[-1] = -np.inf, np.inf
        along = np.clip(along, low, high)
        foot = starts[None] + along[..., None] * ahead[None]
        best = np.hypot(*np.moveaxis(places[:, None] - foot, -1, 0)).argmin(axis=1)
        rows = np.arange(len(places))
        x, y = offset[rows, best].T
        aside = ahead[best, 0] * y - ahead[best, 1] * x
        inner = np.clip(free[rows, best], low[best], high[best])
        return self._along[best] + inner, aside

    def contains(self, places):
        """Which places are between its bounds."""
        corners = np.concatenate((self.left, self.right[::-1]))
        x, y = np.asarray(places, dtype=float).T[:, :, None]
        x1, y1 = corners.T
        x2, y2 = np.roll(corners, -1, axis=0).T
        with np.errstate(divide="ignore", invalid="ignore"):
            hits = ((y1 > y) != (y2 > y)) & (x < (x2 - x1) * (y - y1) / (y2 - y1) + x1)
        return hits.sum(axis=1) % 2 == 1

    @property
    def length(self):
        return float(self._along[-1])


@dataclass
class RawTrack:
    """Who was where: a row for each step from ``first`` on."""

    id: str
    type: str
    length: float
    width: float
    first: int
    places: np.ndarray
    headings: np.ndarray
    on: dict = field(default_factory=dict)

    @property
    def last(self):
        return self.first + len(self.places) - 1

    def at(self, step):
        k = step - self.first
        return k if 0 <= k < len(self.places) else None

    def speeds(self, step_s):
        """Speeds from places over a second around."""
        reach = max(1, round(_OVER_S / step_s / 2))
        k = np.arange(len(self.places))
        one, other = np.maximum(k - reach, 0), np.minimum(k + reach, len(k) - 1)
        way = np.hypot(*(self.places[other] - self.places[one]).T)
        return way / np.maximum((other - one) * step_s, 1e-9)


class RawRecording:
    """A file of CommonRoad; participants with gaps or areas instead of places are left out."""

    def __init__(self, file):
        root = ElementTree.parse(file).getroot()
        self.step_s = float(root.get("timeStepSize"))
        self.abroad = not file.name.startswith("DEU")
        self.motorway = any(name in file.name for name in _MOTORWAYS)
        signs = {one.get("id"): _limits(one) for one in root.iter("trafficSign")}
        self.lights = {one.get("id"): _cycle(one) for one in root.iter("trafficLight")}
        lanelets = (_lanelet(one, signs) for one in root.findall("lanelet"))
        self.lanelets = {one.id: one for one in lanelets if one is not None}
        found = (_track(one) for tag in ("dynamicObstacle", "obstacle") for one in root.iter(tag))
        self.tracks = {one.id: one for one in found if one is not None}
        for track in self.tracks.values():
            for key, lanelet in self.lanelets.items():
                inside = lanelet.contains(track.places)
                if inside.any():
                    track.on[key] = inside

    def colour(self, light, step):
        """A light's colour at a step; None if the file does not say it."""
        if light not in self.lights:
            return None
        phases, offset = self.lights[light]
        total = sum(duration for duration, _ in phases)
        left = (step - offset) % total if total else 0
        for duration, colour in phases:
            if left < duration:
                return colour
            left -= duration
        return None


def _points(bound):
    places = [(float(one.find("x").text), float(one.find("y").text)) for one in bound.iter("point")]
    return np.array(places)


def _lanelet(one, signs):
    left, right = (_points(one.find(name)) for name in ("leftBound", "rightBound"))
    if len(left) != len(right) or len(left) < 2:
        return None
    limits = [limit for ref in one.findall("trafficSignRef") for limit in signs[ref.get("ref")]]
    old = one.find("speedLimit")
    limits += [float(old.text)] if old is not None else []
    return RawLanelet(
        one.get("id"),
        left,
        right,
        tuple(ref.get("ref") for ref in one.findall("successor")),
        frozenset(kind.text for kind in one.findall("laneletType")),
        limits,
        tuple(ref.get("ref") for ref in one.findall("trafficLightRef")),
        _stop_line(one.find("stopLine")),
    )


def _stop_line(element):
    """Its two points; without any, nobody has measured where it lies."""
    points = [] if element is None else element.findall("point")
    return _points(element) if len(points) == 2 else None


def _limits(sign):
    return [
        float(value.text)
        for element in sign.findall("trafficSignElement")
        if element.find("trafficSignID").text in _LIMIT_SIGNS
        for value in element.findall("additionalValue")[:1]
    ]


def _cycle(light):
    phases = [
        (int(one.find("duration").text), one.find("color").text)
        for one in light.iter("cycleElement")
    ]
    offset = light.find("cycle/timeOffset")
    return phases, int(offset.text) if offset is not None else 0


def _track(one):
    role = one.find("role")
    shape = one.find("shape/rectangle")
    if shape is None or (role is not None and role.text != "dynamic"):
        return None
    states = [one.find("initialState"), *one.findall("trajectory/state")]
    rows = [_row(state) for state in states]
    if None in rows or len(rows) < 3:
        return None
    if rows[0][0] == rows[1][0]:
        del rows[0]
    steps = [row[0] for row in rows]
    if steps != list(range(steps[0], steps[0] + len(steps))):
        return None
    values = np.array([row[1:] for row in rows])
    length, width = (float(shape.find(name).text) for name in ("length", "width"))
    kind = one.find("type").text
    return RawTrack(one.get("id"), kind, length, width, steps[0], values[:, :2], values[:, 2])


def _row(state):
    names = "time/exact", "position/point/x", "position/point/y", "orientation/exact"
    parts = [state.find(name) for name in names]
    if any(part is None for part in parts):
        return None
    return (int(float(parts[0].text)), *(float(part.text) for part in parts[1:]))
