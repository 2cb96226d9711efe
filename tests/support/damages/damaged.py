"""A recording as a worse sensor would have made it.

A camera sees a window of the road, a car sees as far as its range and not through others, a tracker
loses whom it follows and finds them again under another id. Nobody's motion is changed.
"""

import random
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np
import shapely

from rulec.extraction.recording_parts import egos_of
from rulec.recordings.recording import Recording

ALL_RECORDED = frozenset({"arrivals"})
"""What a recording claims of its traffic, and one that leaves some of it out does not."""

FEWEST = 2
"""Who is there in fewer states is left out."""


@dataclass(frozen=True)
class Damaged:
    """A damaged recording; ``was`` has the id in the whole one of each participant in it.

    ``egos`` are those of the whole one who are worth asking for, None: all.
    """

    recording: Recording
    was: Mapping[str, str]
    egos: tuple[str, ...] | None = None


def with_states(recording, kept):
    """The recording with some of its states; ``kept``: a moving participant -> its time steps."""
    bodies = []
    for body in recording.participants:
        if body.standing or not body.outlines:
            bodies.append(body)
            continue
        steps = sorted(kept(body))
        if len(steps) >= FEWEST:
            bodies.append(_part(body, steps))
    return _of(recording, bodies)


def _part(body, steps, name=None):
    return replace(
        body,
        id=name or body.id,
        states={step: body.states[step] for step in steps if step in body.states},
        outlines={step: body.outlines[step] for step in steps},
        lamps={step: body.lamps[step] for step in steps if step in body.lamps},
    )


def _of(recording, bodies, was=None, egos=None):
    complete = recording.complete - ALL_RECORDED
    damaged = replace(recording, participants=tuple(bodies), complete=complete)
    if was is None:
        was = {body.id: body.id for body in bodies}
    return Damaged(damaged, was, egos)


def cropped(recording, share=0.5):
    """What a camera sees that stands over the traffic's middle: a square, and nothing beyond."""
    places = np.concatenate([_places(body) for body in _moving(recording)])
    middle = np.median(places, axis=0)
    away = np.abs(places - middle).max(axis=1)
    reach = np.quantile(away, share)

    def kept(body):
        steps, inside = list(body.outlines), np.abs(_places(body) - middle).max(axis=1) <= reach
        return [step for step, there in zip(steps, inside, strict=True) if there]

    return with_states(recording, kept)


def cut_in_pieces(recording, mean_s=6.0, hole_s=0.5, seed=1):
    """What a tracker makes that loses everybody every few seconds: new ids behind holes."""
    pick, bodies, was = random.Random(seed), [], {}
    for body in recording.participants:
        if body.standing or not body.outlines:
            bodies.append(body)
            was[body.id] = body.id
            continue
        steps = sorted(body.outlines)
        while steps:
            length = max(FEWEST, round(pick.uniform(0.5, 1.5) * mean_s / recording.step_s))
            piece, steps = steps[:length], steps[length + round(hole_s / recording.step_s) :]
            if len(piece) >= FEWEST:
                name = f"{body.id}~{len(was)}"
                bodies.append(_part(body, piece, name))
                was[name] = body.id
    return _of(recording, bodies, was)


def later(recording, share):
    """What whoever begins to record later has of it, from a share of its time on."""
    steps = [step for body in _moving(recording) for step in body.outlines]
    first = min(steps) + round(share * (max(steps) - min(steps)))
    rest = with_states(recording, lambda body: [x for x in body.outlines if x >= first])
    # From then on nobody is missing
    return replace(rest, recording=replace(rest.recording, complete=recording.complete))


def with_drops(recording, share=0.1, seed=1):
    """The recording without some of its states, each by itself."""
    pick = random.Random(seed)
    return with_states(recording, lambda body: [x for x in body.outlines if pick.random() >= share])


def in_range(recording, ego, range_m=40.0):
    """Whom a vehicle sees that looks so far all around."""
    own = _by_step(recording, ego)

    def kept(body):
        if body.id == ego:
            return list(body.outlines)
        seen = zip(body.outlines, _places(body), strict=True)
        return [k for k, at in seen if k in own and np.hypot(*(at - own[k])) <= range_m]

    return replace(with_states(recording, kept), egos=(ego,))


def in_view(recording, ego, range_m=150.0):
    """Whom a vehicle sees that does not see through others: their middles are in its view."""
    own, moving = _by_step(recording, ego), [x for x in recording.participants if x.outlines]
    hidden, by_step = set(), {}
    for number, body in enumerate(moving):
        if body.id != ego:
            for step in body.outlines:
                by_step.setdefault(step, []).append(number)
    for step, at in own.items():
        numbers = by_step.get(step, [])
        if not numbers:
            continue
        outlines = [moving[k].outlines[step] for k in numbers]
        areas = np.array([shapely.MultiPoint(x).convex_hull for x in outlines])
        middles = np.array([x.mean(axis=0) for x in outlines])
        rays = np.array([shapely.LineString([at, middle]) for middle in middles])
        meets = shapely.intersects(rays[:, None], areas[None, :])
        np.fill_diagonal(meets, False)
        away = np.hypot(*(middles - at).T)
        hidden |= {
            (number, step)
            for number, behind, far in zip(numbers, meets.any(axis=1), away, strict=True)
            if behind or far > range_m
        }
    rows = {body.id: number for number, body in enumerate(moving)}

    def kept(body):
        if body.id == ego:
            return list(body.outlines)
        return [
            step for step in body.outlines if step in own and (rows[body.id], step) not in hidden
        ]

    return replace(with_states(recording, kept), egos=(ego,))


def _moving(recording):
    return [body for body in recording.participants if body.outlines and not body.standing]


def _places(body):
    return np.array([outline.mean(axis=0) for outline in body.outlines.values()])


def _by_step(recording, ego):
    (body,) = (body for body in recording.participants if body.id == ego)
    return dict(zip(body.outlines, _places(body), strict=True))


def _of_each(damage):
    """A damage that is another one for each vehicle that looks around."""

    def every(recording, most=None, named=()):
        egos = egos_of(recording)
        chosen = egos[:: max(1, len(egos) // most) if most else 1]
        for ego in dict.fromkeys((*chosen, *named)):
            yield damage(recording, ego)

    return every


def _of_all(damage):
    def one(recording, most=None, named=()):
        yield damage(recording)

    return one


DAMAGES: dict[str, Callable] = {
    "window": _of_all(cropped),
    "narrow_window": _of_all(lambda recording: cropped(recording, 0.2)),
    "pieces": _of_all(cut_in_pieces),
    "pieces_without_holes": _of_all(lambda recording: cut_in_pieces(recording, 4.0, 0.0)),
    "drops_5": _of_all(lambda recording: with_drops(recording, 0.05)),
    "drops_20": _of_all(lambda recording: with_drops(recording, 0.2)),
    "later_40": _of_all(lambda recording: later(recording, 0.4)),
    "later_70": _of_all(lambda recording: later(recording, 0.7)),
    "range_40": _of_each(in_range),
    "range_60": _of_each(lambda recording, ego: in_range(recording, ego, 60.0)),
    "view": _of_each(in_view),
}
"""Name -> what makes damaged recordings of a whole one.

Of those that are others for each ego about ``most`` are made, and those of egos that are named.
"""
