"""What the simulator says of everybody at every step: lane, place on it, speed, leader, lights."""

import xml.etree.ElementTree as ElementTree
from dataclasses import dataclass, field
from functools import cached_property

import numpy as np

from support.worlds.net_state import NetState

LENGTH_M, WIDTH_M = 4.5, 1.8
"""Of all vehicles in these worlds."""

_CHANGE_S, _ASKEW_DEG = 4.0, 8.0


@dataclass
class Track:
    """Columns of one road user: ``lane`` is an edge for walkers, ``pos`` that of the front."""

    id: str
    kind: str
    step: list = field(default_factory=list)
    lane: list = field(default_factory=list)
    leader: list = field(default_factory=list)
    rows: list = field(default_factory=list)

    def column(self, name):
        return self._table[:, _COLUMNS.index(name)]

    @cached_property
    def _table(self):
        return np.array(self.rows)

    @cached_property
    def inside(self):
        """Where it is within a junction."""
        return np.array([lane.startswith(":") for lane in self.lane])

    def at(self, step):
        """The row of a step; None where it is not there."""
        k = step - self.step[0]
        return k if 0 <= k < len(self.step) else None


_COLUMNS = ("x", "y", "angle", "speed", "pos", "gap", "leader_speed")


@dataclass(frozen=True)
class Crossing:
    """A vehicle's way over a junction: ``row`` is the first one beyond the line."""

    track: Track
    link: object
    row: int


class WorldState:
    """A world by its files."""

    def __init__(self, files, step_s, book="de"):
        self.book = book
        self.net = NetState(files.net)
        self.step_s = step_s
        self.vehicles, self.walkers = {}, {}
        for _, moment in ElementTree.iterparse(files.data):
            if moment.tag == "timestep":
                step = round(float(moment.get("time")) / step_s)
                for one in moment:
                    self._add(one, step)
                moment.clear()
        self.lights = _lights(files.lights, step_s) if files.lights.exists() else {}

    def _add(self, one, step):
        home = self.vehicles if one.tag == "vehicle" else self.walkers
        key = one.get("id")
        track = home.get(key)
        if track is None:
            track = home[key] = Track(key, one.get("type"))
        track.step.append(step)
        track.lane.append(one.get("lane") or one.get("edge"))
        track.leader.append(one.get("leaderID", ""))
        names = ("x", "y", "angle", "speed", "pos", "leaderGap", "leaderSpeed")
        track.rows.append([float(one.get(name, "nan")) for name in names])

    def time(self, track, row):
        return track.step[row] * self.step_s

    @cached_property
    def crossings(self):
        """Every way over a junction, in each of its links."""
        return [one for track in self.vehicles.values() for one in self._crossings_of(track)]

    def _crossings_of(self, track):
        for row in range(1, len(track.lane)):
            link = self.net.links.get(track.lane[row])
            # Who changes lanes at the line comes from the one beside
            if link is not None and self._same_road(track.lane[row - 1], link.start):
                yield Crossing(track, link, row)

    @cached_property
    def changing(self):
        """Vehicle -> rows within so many seconds of a change of lanes, or while it is askew.

        Who has to stop while it changes lanes stands askew, and its body is in both.
        """
        return {key: self._changing(track) for key, track in self.vehicles.items()}

    def _changing(self, track):
        lanes = [self.net.lanes[lane] for lane in track.lane]
        reach = round(_CHANGE_S / self.step_s)
        turned = track.column("angle") - [
            one.heading_at(pos) for one, pos in zip(lanes, track.column("pos"), strict=True)
        ]
        mask = ~track.inside & (np.abs((turned + 180.0) % 360.0 - 180.0) > _ASKEW_DEG)
        for row in range(1, len(lanes)):
            if lanes[row].edge == lanes[row - 1].edge and lanes[row] is not lanes[row - 1]:
                mask[max(0, row - reach) : row + reach + 1] = True
        return mask

    def along(self, crossing):
        """The front's place on a way over a junction and beyond, 0 at the line; else NaN."""
        link, track = crossing.link, crossing.track
        pos = track.column("pos")
        before = {link.start: -self.net.lanes[link.start].length}
        done = 0.0
        for lane in link.inner:
            before[lane] = done
            done += self.net.lanes[lane].length
        before[link.end] = done
        # A lane beside the one where the way ends is as far on
        offsets = [before.get(lane, self._beside(lane, link, done)) for lane in track.lane]
        placed = np.array(offsets) + pos
        first = next(k for k, lane in enumerate(track.lane) if lane in before)
        placed[:first] = np.nan
        return placed

    def _beside(self, lane, link, done):
        return done if self._same_road(lane, link.end) else np.nan

    def _same_road(self, *lanes):
        return len({self.net.lanes[lane].edge for lane in lanes}) == 1


def _lights(file, step_s):
    """Light -> state at each step."""
    found = {}
    for one in ElementTree.parse(file).getroot():
        step = round(float(one.get("time")) / step_s)
        found.setdefault(one.get("id"), {})[step] = one.get("state")
    return found
