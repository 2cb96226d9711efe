"""Plausibility of tracks: units, steps and axes that contradict the positions."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy import float64, intp
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.recordings.doubts.impossible_speeds import without_impossible_speeds
from rulec.recordings.doubts.limit_doubts import limit_doubts
from rulec.recordings.doubts.long_ways import LongWays, long_ways
from rulec.recordings.doubts.road_doubts import road_doubts
from rulec.recordings.encodings.speed_units import KMH_PER_MPS
from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import Recording
from rulec.recordings.track import TrackStates
from rulec.trace.plain_arrays import median, quantile

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
    angle = median(np.array([_askew_deg(moved) for moved in tracks]))
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
    remarks = (*recording.remarks, *_doubts(tracks, recording, angle, median(ratios)))
    return replace(recording, remarks=remarks) if remarks != recording.remarks else recording


def _contradiction(ratios: NDArray[float64]) -> float:
    """The factor by which the speeds of most bodies contradict their places; 0 if they do not."""
    low, middle, high = (quantile(ratios, part) for part in (1 - _MOST, 0.5, _MOST))
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
    fastest = median(np.array([_mean_mps(moved, recording.step_s) for moved in tracks]))
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
    if lengths and (middle := median(np.array(lengths))) > _LONGEST_CAR_M:
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
