"""A recording written in another way, which means the same: whatever is true, so is the verdict."""

import math
import random
from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np

from rulec.recordings.recording import Light, Recording, is_lane
from rulec.recordings.track import Track, TrackOutlines, TrackStates, outlines_on_track


@dataclass(frozen=True)
class Rewritten:
    """A rewritten recording; ``was`` has the former id of each of its participants.

    It begins ``later_s`` (s) later than before.
    """

    recording: Recording
    was: dict = field(default_factory=dict)
    later_s: float = 0.0


def _with_lanelets(recording, change):
    lanelets = map(change, recording.lanelets.values())
    return replace(recording, lanelets={one.id: one for one in lanelets})


def _with_bodies(recording, change):
    return replace(recording, participants=tuple(map(change, recording.participants)))


def _on_track(body, change):
    """The participant with another track, which ``change`` makes of copies of steps and rows."""
    track = outlines_on_track(body).track
    steps, rows = change(track.steps.copy(), track.rows.copy())
    other = Track(steps, rows, track.length, track.width, track.shift)
    return replace(body, states=TrackStates(other), outlines=TrackOutlines(other))


def placed(recording, move, by_rad=0.0):
    """The world with each place where ``move`` puts it, and turned by an angle (rad)."""

    def lanelet(one):
        line = None if one.stop_line is None else move(one.stop_line)
        lines = {name: move(getattr(one, name)) for name in ("left", "right", "centre")}
        return replace(one, **lines, stop_line=line)

    def moved(steps, rows):
        rows[:, :2] = move(rows[:, :2])
        rows[:, 2] += by_rad
        return steps, rows

    recording = _with_lanelets(recording, lanelet)
    return _with_bodies(recording, lambda body: _on_track(body, moved))


def turned(recording, pick):
    angle = pick.uniform(-math.pi, math.pi)
    cos, sin = math.cos(angle), math.sin(angle)
    return Rewritten(placed(recording, lambda at: at @ np.array([[cos, sin], [-sin, cos]]), angle))


def far_away(recording, pick):
    by = np.array([pick.choice([-1, 1]) * 1e6, 5e5]) + pick.random()
    return Rewritten(placed(recording, lambda at: at + by))


def in_other_order(recording, pick):
    lanelets, bodies = list(recording.lanelets.values()), list(recording.participants)
    pick.shuffle(lanelets)
    pick.shuffle(bodies)
    lanelets = [replace(one, successors=one.successors[::-1]) for one in lanelets]
    lanelets = {one.id: one for one in lanelets}
    return Rewritten(replace(recording, lanelets=lanelets, participants=tuple(bodies)))


def _lanelets_renamed(recording, name):
    """The recording with other ids of lanelets and junctions, as ``name`` makes them."""

    def of(ids):
        return None if ids is None else type(ids)(map(name, ids))

    def lanelet(one):
        beside = {side: getattr(one, side) for side in ("left_of", "right_of")}
        groups = ("successors", "predecessors", "foes", "first")
        return replace(
            one,
            id=name(one.id),
            junction=one.junction and name(one.junction),
            lights_to={name(to): light for to, light in one.lights_to.items()},
            **{side: other and name(other) for side, other in beside.items()},
            **{group: of(getattr(one, group)) for group in groups},
        )

    return _with_lanelets(recording, lanelet)


def renamed(recording, pick):
    """Ids are huge numbers, or no numbers at all, in another order than before."""
    form = pick.choice(["{}000000000000000007", "Straße {}", "道{}_2", "x.{}"])
    numbers = pick.sample(range(10_000), len(recording.lanelets) + len(recording.participants))
    lanes = dict(zip(recording.lanelets, map(form.format, numbers), strict=False))
    bodies = [one.id for one in recording.participants]
    names = dict(zip(bodies, map(form.format, numbers[len(lanes) :]), strict=True))
    found = _lanelets_renamed(recording, lambda own: lanes.get(own, f"j {own}"))
    found = _with_bodies(found, lambda body: replace(body, id=names[body.id]))
    return Rewritten(found, {new: old for old, new in names.items()})


def later(recording, pick):
    """Time has another origin."""
    by = pick.randrange(100, 5000)

    def light(one):
        if isinstance(one, Light):
            return replace(one, begin=one.begin + by)
        return replace(one, colours={step + by: colour for step, colour in one.colours.items()})

    def lanelet(one):
        to = {name: light(own) for name, own in one.lights_to.items()}
        return replace(one, lights=tuple(map(light, one.lights)), lights_to=to)

    def body(one):
        lamps = {step + by: lit for step, lit in one.lamps.items()}
        one = _on_track(one, lambda steps, rows: (steps + by, rows))
        return replace(one, lamps=lamps)

    found = _with_bodies(_with_lanelets(recording, lanelet), body)
    return Rewritten(found, later_s=by * recording.step_s)


def _between(line, at):
    """Points of a line at places that count its corners."""
    before = np.minimum(at.astype(int), len(line) - 2)
    part = (at - before)[:, None]
    return line[before] * (1 - part) + line[before + 1] * part


def _lines(lanelet, at):
    return {name: _between(getattr(lanelet, name), at) for name in ("left", "right", "centre")}


def with_more_points(recording, pick):
    """Lines have further points between their corners."""

    def lanelet(one):
        count = len(one.centre)
        more = [pick.uniform(0, count - 1) for _ in range(count)]
        return replace(one, **_lines(one, np.sort([*range(count), *more])))

    return Rewritten(_with_lanelets(recording, lanelet))


def in_pieces(recording, pick):
    """Lanes outside of junctions are in two pieces each, cut across the road.

    What holds on a lane holds on both; its line, and its lights, are at the end of the second.
    """
    known, shares = recording.lanelets, {}
    for name, one in known.items():
        if name in shares or not is_lane(one) or one.junction or len(one.centre) != 2:
            continue
        beside = [name]
        for own in beside:
            others = (known[own].left_of, known[own].right_of)
            beside += [other for other in others if other and other not in beside]
        share = pick.uniform(0.3, 0.7)
        if not any(known[own].junction or len(known[own].centre) != 2 for own in beside):
            shares |= dict.fromkeys(beside, share)
    found = {}
    for name, one in known.items():
        befores = tuple(f"{own}~" if own in shares else own for own in one.predecessors)
        whole = replace(one, predecessors=befores)
        if name not in shares:
            found[name] = whole
            continue
        sides = {side: getattr(one, side) for side in ("left_of", "right_of")}
        half = {side: other and f"{other}~" for side, other in sides.items()}
        first, second = (
            _lines(one, np.array([0, shares[name]])),
            _lines(one, np.array([shares[name], 1])),
        )
        begin = {"successors": (f"{name}~",), "stop_line": None, "lights_to": {}}
        found[name] = replace(whole, **first, **begin)
        found[f"{name}~"] = replace(one, id=f"{name}~", predecessors=(name,), **half, **second)
    assert shares
    return Rewritten(replace(recording, lanelets=found))


def beside_its_copy(recording, pick):
    """Far away there is the same world again, whose ids end in a star."""
    by = np.array([pick.uniform(9e3, 1e4), 0.0])
    copy = _lanelets_renamed(placed(recording, lambda at: at + by), "{}*".format)
    bodies = tuple(replace(body, id=f"{body.id}*") for body in copy.participants)
    every = bodies + recording.participants
    lanelets = {**copy.lanelets, **recording.lanelets}
    return Rewritten(replace(recording, lanelets=lanelets, participants=every))


WAYS: dict[str, Callable[[Recording, random.Random], Rewritten]] = {
    one.__name__: one
    for one in (
        *(turned, far_away, in_other_order, renamed, later),
        *(with_more_points, in_pieces, beside_its_copy),
    )
}
