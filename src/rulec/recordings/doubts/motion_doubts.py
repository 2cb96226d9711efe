"""Plausibility of tracks: units, steps and axes that contradict the positions, and limits.

Speeds that no vehicle can have, such as simulators give to newly inserted vehicles, are replaced.
Limits that nobody or everybody breaks may be in the wrong unit.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from math import isfinite

import numpy as np
import shapely
from numpy import float64, intp
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.recordings.doubts.long_ways import LongWays, long_ways
from rulec.recordings.doubts.road_doubts import road_doubts
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.mending.derived_motion import accelerations_of, along, velocities_of
from rulec.recordings.polylines import places_in, wrapped
from rulec.recordings.recording import Lanelet, Participant, Recording, is_lane
from rulec.recordings.track import Track, TrackStates

_MOST_MPS = 150.0
"""The highest plausible speed: no vehicle on a road drives 540 km/h."""

_BORNE_OUT = 0.5
"""A stated speed is confirmed if the positions show at least this share of it."""

_MOST_PART = 0.5
"""If a larger share of a track's speeds is impossible, their unit is wrong, not single values."""


def without_impossible_speeds(recording: Recording) -> Recording:
    """The recording with impossible speeds replaced by those of positions, and a remark.

    A participant with a single state is left unchanged, since nothing else is known of it.
    """
    bodies: list[Participant] = []
    mended, fastest = 0, 0.0
    for body in recording.participants:
        track = body.states.track if isinstance(body.states, TrackStates) else None
        if track is not None and len(rows := _impossible(track, recording.step_s)):
            mended += len(rows)
            fastest = max(fastest, float(np.abs(track.rows[rows, 3]).max()))
            body = replace(body, states=TrackStates(_mended(track, rows, recording.step_s)))
        bodies.append(body)
    if not mended:
        return recording
    some = "one speed is" if mended == 1 else f"{mended:,} speeds are up to"
    remark = (
        f"{some} {fastest * KMH_PER_MPS:,.0f} km/h, where places say otherwise: "
        "there it is the speeds of places that count"
    )
    return replace(recording, participants=tuple(bodies), remarks=(*recording.remarks, remark))


def _impossible(track: Track, step_s: float) -> NDArray[np.intp]:
    """The rows whose stated speed is impossible and not confirmed by positions."""
    stated = np.abs(track.rows[:, 3])
    rows = np.flatnonzero(stated > _MOST_MPS)
    # Most often there is none
    if not 0 < len(rows) <= _MOST_PART * len(stated):
        return rows[:0]
    moved = np.abs(_by_places(track, step_s))
    return rows[moved[rows] < _BORNE_OUT * stated[rows]]


def _by_places(track: Track, step_s: float) -> NDArray[float64]:
    """Speeds along headings (m/s), from the positions before and after."""
    velocities = velocities_of(track.rows[:, :2], (track.steps * step_s).astype(float64))
    return along(velocities, track.rows[:, 2])


def _mended(track: Track, impossible: NDArray[np.intp], step_s: float) -> Track:
    mended = track.rows.copy()
    mended[impossible, 3] = _by_places(track, step_s)[impossible]
    mended[impossible, 4] = accelerations_of(mended[:, 3], (track.steps * step_s).astype(float64))[
        impossible
    ]
    return replace(track, rows=mended)


_HIGHEST_KMH = 162.0
"""The highest plausible limit: 160 km/h is the highest of any country's roads."""

_FEWEST_FAST, _FEWEST_SLOW = 5, 10
_TOO_FAST = 1.5
"""The ratio of speed to limit above which limits are doubted.

A mile is 1.609 km. In recordings without doubtful limits, the median ratio is 1.35.
"""

_TOO_SLOW = 0.55
"""The ratio of speed to limit below which limits are doubted.

27 m/s are 60 mph, and 60 m/s are 2.2 times as much. Queues may be as slow, so limits are doubted
only if they are multiples of 5 m/s, as limits in km/h and mph taken for m/s are.
"""

_EVERY_S = 1.0
"""The interval at which vehicles are sampled."""

_ROUND_MPS = 5.0
_ALMOST_MPS = 0.005
_FAST = 0.9
"""A vehicle counts as fast from this quantile of its own speeds on."""

_RAILS = frozenset({"rail", "tram"})


def limit_doubts(recording: Recording, tracks: Sequence[Track]) -> Iterator[str]:
    """Remarks on a recording's limits; ``tracks`` are those of moving vehicles."""
    lanes = [lanelet for lanelet in recording.lanelets.values() if _has_limit(lanelet)]
    if not lanes:
        return
    limits = np.array([lanelet.limit_mps for lanelet in lanes], dtype=float)
    highest = float(limits.max()) * KMH_PER_MPS
    if highest > _HIGHEST_KMH:
        yield f"limits are up to {highest:.0f} km/h: they may be in another unit than m/s"
        return
    if len(tracks) < _FEWEST_FAST:
        return
    most, least = _shares(tracks, recording.step_s, lanes, limits)
    if len(most) >= _FEWEST_FAST and (usual := float(np.median(np.array(most)))) > _TOO_FAST:
        yield (
            f"half of the vehicles drive {usual:.2g} times the limit or faster: limits "
            "may be in another unit, such as mph or m/s in the place of km/h"
        )
    is_round = (np.abs(limits - np.round(limits / _ROUND_MPS) * _ROUND_MPS) < _ALMOST_MPS).all()
    fast = float(np.quantile(np.array(least), _FAST)) if least else np.inf
    if is_round and len(least) >= _FEWEST_SLOW and fast < _TOO_SLOW:
        yield (
            f"nine in ten vehicles drive {fast:.2g} times the limit or slower, "
            "and limits are whole numbers of m/s: they may be in km/h or mph"
        )


def _has_limit(lanelet: Lanelet) -> bool:
    limit = lanelet.limit_mps
    is_road = is_lane(lanelet) and not lanelet.types & _RAILS
    return is_road and limit is not None and isfinite(limit) and limit > 0


def _shares(
    tracks: Sequence[Track], step_s: float, lanes: Sequence[Lanelet], limits: NDArray[float64]
) -> tuple[list[float], list[float]]:
    """The ratio of each vehicle's speed to the limit where it is fast.

    Where lanes overlap, once by the highest of their limits and once by the lowest.
    """
    outlines = [
        shapely.Polygon(np.vstack((lanelet.left, lanelet.right[::-1]))) for lanelet in lanes
    ]
    usual = max(1, round(_EVERY_S / step_s))
    shares: tuple[list[float], list[float]] = ([], [])
    for track in tracks:
        every = min(usual, len(track.steps) - 1)
        places = track.rows[::every, :2]
        # Over so long, noise does not make anybody fast
        ways = np.hypot(*np.diff(places, axis=0).T)
        speeds = ways / (np.diff(track.steps[::every]) * step_s)
        rows, lane = places_in(outlines, *places[:-1].T)
        if not len(rows):
            continue
        highest, lowest = np.zeros(len(speeds)), np.full(len(speeds), np.inf)
        np.maximum.at(highest, rows, limits[lane])
        np.minimum.at(lowest, rows, limits[lane])
        on = highest > 0
        for share, limit in zip(shares, (highest, lowest), strict=True):
            share.append(float(np.quantile(speeds[on] / limit[on], _FAST)))
    return shares


_MOST_BODIES = 60
_FEWEST_BODIES = 3
_LEAST_M = 5.0
"""Vehicles that move less far are not considered."""

_ALIKE = 1.5
"""Speeds and positions that differ by a smaller factor are merely measured badly."""

_ASKEW_DEG, _ACROSS_DEG = 20.0, 45.0
"""Angles that cars in bends, or badly measured ones, do not exceed on average."""

_CONTRADICTING, _MOST = 2.0, 0.75
"""If speeds of so many bodies differ by this factor, units or time steps are wrong."""

_FASTEST_MPS = 100.0
"""The highest plausible median speed (360 km/h)."""

_LONGEST_CAR_M = 8.0
"""Longer than any car, and shorter than most cars measured in feet."""

_SPEEDS = "speeds are"


def with_doubts(
    recording: Recording, refused: Callable[..., RulecError], *, sure: bool = False
) -> Recording:
    """The recording, with a remark on each quantity that contradicts the motion of bodies.

    ``refused`` makes the error for an unreadable recording. Raises it (R0610) if most vehicles move
    across or against their headings, or if speeds contradict places and times, unless somebody is
    ``sure`` of the time steps.
    """
    recording = without_impossible_speeds(recording)
    tracks = _tracks(recording)
    moving = [moved.track for moved in tracks]
    doubts = (*limit_doubts(recording, moving), *road_doubts(recording.lanelets, tracks))
    recording = replace(recording, remarks=(*recording.remarks, *doubts)) if doubts else recording
    if len(tracks) < _FEWEST_BODIES:
        return recording
    angle = float(np.median(np.array([_askew_deg(moved) for moved in tracks])))
    if angle > _ACROSS_DEG:
        why = (
            f"headings do not fit the motion: vehicles move {angle:.0f}° away from them in the "
            "median; axes may be exchanged, or headings be in degrees, or be counted from north"
        )
        raise refused(why)
    ratios = np.array([_speed_ratio(moved, recording.step_s) for moved in tracks])
    if not sure and (factor := _contradiction(ratios)):
        why = (
            f"{_SPEEDS} {factor:.3g} times what places and times say: time steps of "
            f"{recording.step_s:.4g} s, or units of speeds or places, are wrong"
        )
        raise refused(why, help_text=_way_out(factor, recording))
    remarks = (*recording.remarks, *_doubts(tracks, recording, angle, float(np.median(ratios))))
    return replace(recording, remarks=remarks) if remarks != recording.remarks else recording


def _contradiction(ratios: NDArray[float64]) -> float:
    """The factor by which the speeds of most bodies contradict their places; 0 if they do not."""
    low, middle, high = (float(np.quantile(ratios, part)) for part in (1 - _MOST, 0.5, _MOST))
    return middle if low > _CONTRADICTING or 0 < high < 1 / _CONTRADICTING else 0.0


def _way_out(factor: float, recording: Recording) -> str:
    rate = 1 / recording.step_s
    of_columns = [x.partition(": ")[2] for x in recording.remarks if x.startswith(_SPEEDS)]
    if recording.form == "tracks as a table":
        of_columns.append(f"say `--frame-rate {rate * factor:.4g}` if speeds and places are right")
    by_places = f"say `--frame-rate {rate:.6g}` if time steps are, and it is judged by places"
    return "; or ".join([*of_columns, by_places])


def _tracks(recording: Recording) -> list[LongWays]:
    """The first tracks of vehicles that move far enough."""
    tracks: list[LongWays] = []
    for body in recording.participants:
        if "vehicle" in body.object_types and isinstance(body.states, TrackStates):
            rows = body.states.track.rows
            if len(rows) > 1 and np.hypot(*np.ptp(rows[:, :2], axis=0)) > _LEAST_M:
                moved = long_ways(body.states.track)
                if len(moved.ways):
                    tracks.append(moved)
                if len(tracks) == _MOST_BODIES:
                    break
    return tracks


def _doubts(
    tracks: list[LongWays], recording: Recording, angle: float, ratio: float
) -> Iterator[str]:
    if angle > _ASKEW_DEG:
        yield f"vehicles move {angle:.0f}° off their headings, which may be in degrees"
    fastest = float(np.median(np.array([_mean_mps(moved, recording.step_s) for moved in tracks])))
    if fastest > _FASTEST_MPS:
        yield (
            f"half of the vehicles move at {fastest * KMH_PER_MPS:,.0f} km/h or more: columns, or "
            "units of times or places, may be wrong"
        )
    # Tables have said so themselves, of all their rows
    already_said = any(remark.startswith(_SPEEDS) for remark in recording.remarks)
    if ratio > 0 and not 1 / _ALIKE <= ratio <= _ALIKE and not already_said:
        yield (
            f"{_SPEEDS} {ratio:.3g} times what places and times say, by which it is judged: "
            "time steps, or units of speeds or places, may be wrong"
        )
    if np.mean([moved.track.length < moved.track.width for moved in tracks]) > 0.5:
        yield "most vehicles are wider than long: lengths and widths may be exchanged"
    cars = (body.states for body in recording.participants if body.type == "car")
    lengths = [states.track.length for states in cars if isinstance(states, TrackStates)]
    if lengths and (middle := float(np.median(np.array(lengths)))) > _LONGEST_CAR_M:
        yield f"cars are {middle:.3g} m long in the median: lengths may be in feet or centimetres"


def _mean_mps(moved: LongWays, step_s: float) -> float:
    """The mean speed of a track by its positions."""
    took = float(np.ptp(moved.track.steps[moved.rows])) * step_s
    return float(np.hypot(*moved.ways.T).sum() / took)


def _askew_deg(moved: LongWays) -> float:
    """The mean angle between a track's motion and its headings, weighted by distance.

    A vehicle that reverses, by its own speeds, moves the opposite way.
    """
    dx, dy = moved.ways.T
    heading = moved.track.rows[:, 2]
    cos, sin = (_sums(own, moved.rows) for own in (np.cos(heading), np.sin(heading)))
    backs = _driven(moved) < 0
    turned = np.abs(wrapped(np.arctan2(dy, dx) - np.arctan2(sin, cos) + np.pi * backs))
    return float(np.degrees(np.average(turned, weights=np.hypot(dx, dy))))


def _speed_ratio(moved: LongWays, step_s: float) -> float:
    """The ratio of the distance by speeds to the distance between positions."""
    by_speed = np.abs(_driven(moved)) * step_s
    return float(by_speed.sum() / np.hypot(*moved.ways.T).sum())


def _driven(moved: LongWays) -> NDArray[float64]:
    """The distance driven on each way, by speeds (m/s) and time steps."""
    speed = moved.track.rows[:, 3]
    driven = (speed[1:] + speed[:-1]) / 2 * np.diff(moved.track.steps)
    return _sums(np.append(0.0, driven), moved.rows)


def _sums(values: NDArray[float64], rows: NDArray[intp]) -> NDArray[float64]:
    """The sums of values between rows, without each first one."""
    sums: NDArray[float64] = np.diff(values.cumsum()[rows])
    return sums
