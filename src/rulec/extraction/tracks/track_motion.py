"""Velocities and accelerations derived from places, and their possible errors."""

from __future__ import annotations

from dataclasses import dataclass
from math import ceil

import numpy as np
from numpy import bool_, float64, intp
from numpy.typing import NDArray

from rulec.extraction.tracks.source_tolerances import Tolerances
from rulec.trace.plain_arrays import zero_if_nan

_LEAST_PART = 0.7
"""If less motion than this is along the heading (as at 45°), the heading says nothing about it."""

_AGREES, _STANDS_MPS = 0.05, 0.1
"""Stated speeds are used if their mean differs from places' by at most this part, or this (m/s)."""

_MEANS_ELSE = 0.5
"""Stated speeds mean something else if they differ by more than this part of the longer way."""

_TURNS = 0.1
"""A participant turns if its heading changes by more than this (rad) over a window."""

_CONTRADICTS = 0.1
"""Stated speeds that differ by at most this part mean the same as places: one of both is wrong."""

_SLIP_S, _GRIP_MPS2, _HAIR = 0.3, 10.0, 1e-6
"""A track whose speed changes over ``_SLIP_S`` more than tyres allow has slipped off its vehicle.

Tyres hold about 1 g on a dry road.
"""

_BESIDE = 0.18
"""A vehicle whose middle moves to the side of its heading by more than this part of its way ahead,
as at 10°, does not roll along it: not even one that turns does so while it is fast."""

_SEAM_S, _GAINS_MPS2, _SEAM_LASTS_S = 0.5, 4.0, 1.5
"""A track that gains speed this hard for this long, and loses it as hard soon after, or the
reverse, passes a seam between two cameras' pictures: tracks are stretched or compressed there."""


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Motion:
    """Velocity (m/s), speed (its length, or its part along the heading) and acceleration (m/s²).

    A row per participant, a column per step; the errors are the largest possible ones.
    ``scale_error`` is the relative error of distances nearby: a net may draw a lane shorter than it
    states, and than vehicles drive there.
    """

    vx: NDArray[float64]
    vy: NDArray[float64]
    speed: NDArray[float64]
    speed_error: NDArray[float64]
    acceleration: NDArray[float64]
    acceleration_error: NDArray[float64]
    scale_error: NDArray[float64]


@dataclass(frozen=True, eq=False, slots=True)
class Poses:
    """Places (m), headings (rad) and stated speeds (m/s) by step; NaN where a body is absent.

    ``steers``: whether a participant moves along its heading, as a vehicle does.
    """

    x: NDArray[float64]
    y: NDArray[float64]
    heading: NDArray[float64]
    stated: NDArray[float64]
    steers: NDArray[bool_]


def motion_of(poses: Poses, smoothing_s: float, step_s: float, known: Tolerances) -> Motion:
    """Motion by central differences over ``smoothing_s``, one-sided at the ends of a track.

    Where half of that is no whole number of steps, the window's ends are interpolated linearly. The
    speed of a participant that steers is the part along its heading, or the file's stated speed if
    stated speeds are ``known`` to be more accurate and agree with its places. It is unknown which
    of both is meant where they do not quite agree, as on lanes that a net draws longer than it
    states, or where single stated speeds are impossible, as for vehicles moved by hand in a
    simulator.
    """
    present = ~np.isnan(poses.x)
    window = _Window.around(present, max(1.0, smoothing_s / 2 / step_s))
    columns = np.arange(present.shape[1], dtype=float)[None].repeat(len(present), axis=0)
    duration = window.gained(columns)
    seconds = np.where(duration > 0, duration, np.nan) * step_s
    vx, vy = window.gained(poses.x) / seconds, window.gained(poses.y) / seconds
    # A single state has no displacement: there the stated speed counts
    cos, sin, stated = np.cos(poses.heading), np.sin(poses.heading), poses.stated
    single = present & (duration == 0)
    vx, vy = np.where(single, stated * cos, vx), np.where(single, stated * sin, vy)
    speed = np.hypot(vx, vy)
    # A vehicle moves along its heading: a simulated change of lanes in one step is not speed
    forward = vx * cos + vy * sin
    along = np.abs(forward)
    steers = poses.steers & (
        zero_if_nan(along * speed).sum(axis=1) >= _LEAST_PART * zero_if_nan(speed**2).sum(axis=1)
    )
    speed = np.where(steers[:, None], along, speed)
    own = np.zeros(len(present), dtype=bool)
    differ, told = _differ(speed, stated)
    contradicts, (just_then, denied) = np.zeros(len(present)), np.zeros((2, *present.shape))
    scale_error = just_then
    if known.stated_mps is None:
        alike = poses.steers & (differ <= _CONTRADICTS * told)
        contradicts = np.where(alike, differ, 0.0)
        just_then = np.where(alike[:, None], np.abs(speed - window.mean(stated)), 0.0)
    else:
        # The middle cuts corners: it is slower there than the front, whose speed files state
        turns = np.hypot(window.gained(cos), window.gained(sin)) > _TURNS
        straight = np.where(turns & ~turns.all(axis=1, keepdims=True), np.nan, stated)
        since = _since_before(poses, speed, step_s)
        (differ, told), (differ_since, _) = (_differ(x, straight) for x in (speed, since))
        differ = np.minimum(differ, differ_since)
        own = poses.steers & (differ <= np.maximum(_AGREES * told, _STANDS_MPS))
        # Stated speeds have no direction
        way = np.where(forward < 0, -stated, stated)
        vx, vy = np.where(own[:, None], (way * cos, way * sin), (vx, vy))
        apart = np.where(_denied(poses, step_s), np.abs(stated - speed), 0.0)
        denied = np.where(apart > _GRIP_MPS2 * zero_if_nan(seconds) / 2, apart, 0.0)
        is_sure = own | ~poses.steers | (differ > _MEANS_ELSE * (told + differ))
        just_then = np.where(is_sure[:, None], 0.0, np.abs(stated - speed))
        drawn = np.minimum(np.abs(stated - speed), np.abs(stated - since))
        is_scaled = poses.steers[:, None] & (speed > 0)
        is_scaled &= drawn > np.maximum(_AGREES * stated, _STANDS_MPS)
        scale_error = np.where(is_scaled, drawn / np.where(is_scaled, speed, 1.0), 0.0)
        speed = np.where(own[:, None], stated, speed)
    # At a track's ends the mean is over a time beside the state
    begin, end = window.of(columns)
    middle = (begin + end) / 2
    beside = np.abs(middle - columns) * step_s
    apart = np.where(own[:, None], duration, window.gained(middle))
    apart = np.where(apart > 0, apart * step_s, seconds)
    gained = window.gained(speed) / apart
    error = known.speed_mps / np.where(single, 1.0, seconds)
    error += zero_if_nan(np.abs(gained) * beside)
    # Who slides has a speed along its heading, and another one by its places
    slides = (poses.steers & steers & ~own)[:, None]
    error += np.where(slides, np.hypot(along, _sliding(poses, window, step_s, along)) - along, 0.0)
    # Motion that contradicts itself has a larger error
    error = np.maximum(error + contradicts[:, None], known.joint(error, zero_if_nan(just_then)))
    # A slip may be anywhere in the time over which it shows
    steps = ceil(_SLIP_S / step_s - _HAIR)
    slips = np.maximum(_slips(poses, steps, step_s), _seams(poses, step_s))
    slips = np.where(poses.steers[:, None], slips, 0.0)
    off = slips.any(axis=1)
    if off.any():
        error[off] += np.where(
            single[off], 0.0, _most_around(slips[off], window.reach + steps) / seconds[off]
        )
    error = np.where(own[:, None], np.maximum(known.stated_mps or 0.0, denied), error)
    gained_error = known.joint(*window.of(error)) / apart
    return Motion(
        vx=vx,
        vy=vy,
        speed=speed,
        speed_error=error,
        acceleration=np.where(present, zero_if_nan(gained), np.nan),
        acceleration_error=zero_if_nan(gained_error),
        scale_error=scale_error,
    )


def _sliding(
    poses: Poses, window: _Window, step_s: float, along: NDArray[float64]
) -> NDArray[float64]:
    """The lasting speed (m/s) to the side of the heading, 0 where a vehicle could have it.

    It is to the same side before and after a state, unlike in a bend, or at a jump to another lane.
    """
    halves = []
    for column in window.outer:
        seconds = (column - np.arange(column.shape[1])) * step_s
        x, y = (way[window.rows, column] - way for way in (poses.x, poses.y))
        aside = y * np.cos(poses.heading) - x * np.sin(poses.heading)
        halves.append(aside / np.where(seconds != 0, seconds, np.nan))
    before, after = (np.where(np.isnan(own), halves[1 - k], own) for k, own in enumerate(halves))
    lasting = np.minimum(np.abs(before), np.abs(after))
    is_sliding = (before * after > 0) & (lasting > _BESIDE * along)
    return np.where(is_sliding, lasting, 0.0)


def _since_before(poses: Poses, otherwise: NDArray[float64], step_s: float) -> NDArray[float64]:
    """Mean speeds since the step before, which simulators may state; else ``otherwise``."""
    ways = np.hypot(np.diff(poses.x, axis=1), np.diff(poses.y, axis=1)) / step_s
    since: NDArray[float64] = otherwise.copy()
    since[:, 1:] = np.where(np.isnan(ways), since[:, 1:], ways)
    return since


def _denied(poses: Poses, step_s: float) -> NDArray[bool_]:
    """Mask of states whose stated speed fits neither the way to them nor the way from them."""
    ways = np.hypot(np.diff(poses.x, axis=1), np.diff(poses.y, axis=1)) / step_s
    ends = np.full((len(ways), 1), np.nan)
    both = np.concatenate((ends, ways), axis=1), np.concatenate((ways, ends), axis=1)
    beyond = np.maximum(poses.stated - np.fmax(*both), np.fmin(*both) - poses.stated)
    denied: NDArray[bool_] = beyond > _GRIP_MPS2 * step_s
    return denied


def _slips(poses: Poses, steps: int, step_s: float) -> NDArray[float64]:
    """How far (m) tracks jump along their heading; 0 where a vehicle could drive like that.

    From the second difference of places over ``_SLIP_S``, where tyres would not hold.
    """
    jumps = np.abs(_bends(poses, steps))
    return np.where(jumps > _GRIP_MPS2 * (steps * step_s) ** 2, jumps, 0.0)


def _seams(poses: Poses, step_s: float) -> NDArray[float64]:
    """How far (m) tracks are stretched or compressed at seams, from their begin to their end."""
    steps = ceil(_SEAM_S / step_s - _HAIR)
    bends, longest = _bends(poses, steps), round(_SEAM_LASTS_S / step_s)
    least = _GAINS_MPS2 * (steps * step_s) ** 2
    found = np.zeros(bends.shape)
    for row in ((bends > least).any(axis=1) & (bends < -least).any(axis=1)).nonzero()[0].tolist():
        own = bends[row]
        for sign in (1.0, -1.0):
            begins, ends = ((way * own > least).nonzero()[0] for way in (sign, -sign))
            while len(begins):
                pairs = [
                    (min(abs(own[begin]), abs(own[end])), begin - end, begin, end)
                    for begin in begins.tolist()
                    for end in ends[(ends > begin) & (ends <= begin + longest)].tolist()
                ]
                if not pairs:
                    break
                bend, _, begin, end = max(pairs)
                # This much farther within the time over which it shows, or within its duration
                stretched = bend * max(end - begin, steps) / steps
                found[row, begin : end + 1] = np.maximum(found[row, begin : end + 1], stretched)
                begins = begins[abs(begins - begin) > longest]
    return found


def _bends(poses: Poses, steps: int) -> NDArray[float64]:
    """The second difference (m) of places along the heading, over ``steps`` steps each way."""
    bends = np.zeros(poses.x.shape)
    if poses.x.shape[1] > 2 * steps:
        (x, y), inner = (
            (
                way[:, 2 * steps :] - 2 * way[:, steps:-steps] + way[:, : -2 * steps]
                for way in (poses.x, poses.y)
            ),
            poses.heading[:, steps:-steps],
        )
        bends[:, steps:-steps] = zero_if_nan(x * np.cos(inner) + y * np.sin(inner))
    return bends


def _most_around(values: NDArray[float64], reach: int) -> NDArray[float64]:
    """The greatest value of each row up to ``reach`` columns away."""
    padded = np.pad(values, ((0, 0), (reach, reach)))
    windows = np.lib.stride_tricks.sliding_window_view(padded, 2 * reach + 1, axis=1)
    most: NDArray[float64] = windows.max(axis=2)
    return most


def _differ(
    speed: NDArray[float64], stated: NDArray[float64]
) -> tuple[NDArray[float64], NDArray[float64]]:
    """By how much participants' mean speeds from places and mean stated ones differ; the latter.

    Only over steps with a stated speed.
    """
    is_stated = ~np.isnan(stated)
    count = np.maximum(is_stated.sum(axis=1), 1)
    told = zero_if_nan(stated).sum(axis=1) / count
    return np.abs(zero_if_nan(np.where(is_stated, speed, 0.0)).sum(axis=1) / count - told), told


@dataclass(frozen=True, eq=False, slots=True)
class _Window:
    """Unbroken windows around states: the columns of their ends, and those one step farther in.

    ``part`` is how far the ends are from the inner columns, as a part of a step; with 1 the ends
    are columns themselves.
    """

    rows: NDArray[intp]
    outer: tuple[NDArray[intp], NDArray[intp]]
    inner: tuple[NDArray[intp], NDArray[intp]]
    part: float
    reach: int

    @staticmethod
    def around(present: NDArray[bool_], steps: float) -> _Window:
        """Windows of up to ``steps`` steps each way, as far as the participant is present."""
        reach = ceil(steps - _HAIR)
        part = steps - (reach - 1)
        whole = part > 1.0 - _HAIR
        columns = np.arange(present.shape[1])
        absent = np.where(present, -1, columns)
        since = np.maximum.accumulate(absent, axis=1) + 1
        absent = np.where(present, len(columns), columns)
        until = np.minimum.accumulate(absent[:, ::-1], axis=1)[:, ::-1] - 1

        def ends(far: int) -> tuple[NDArray[intp], NDArray[intp]]:
            before = np.where(present, np.maximum(columns - far, since), columns)
            return before, np.where(present, np.minimum(columns + far, until), columns)

        outer = ends(reach)
        inner = outer if whole else ends(reach - 1)
        rows = np.arange(len(present))[:, None]
        return _Window(rows, outer, inner, 1.0 if whole else part, reach)

    def of(self, values: NDArray[float64]) -> tuple[NDArray[float64], NDArray[float64]]:
        """Values at both ends, by row and column."""
        begin, end = (values[self.rows, column] for column in self.outer)
        if self.part == 1.0:
            return begin, end
        inside = [values[self.rows, column] for column in self.inner]
        return begin + (inside[0] - begin) * (1 - self.part), end + (inside[1] - end) * (
            1 - self.part
        )

    def mean(self, values: NDArray[float64]) -> NDArray[float64]:
        """The mean of values between both ends, interpolated linearly between columns.

        A window without length has its own value.
        """
        whole = np.zeros(values.shape)
        half = zero_if_nan((values[:, 1:] + values[:, :-1]) / 2)
        whole[:, 1:] = half.cumsum(axis=1)
        columns = np.arange(values.shape[1], dtype=float)[None].repeat(len(values), axis=0)
        length = self.gained(columns)
        there = length > 0
        gained = self.gained(whole)
        return np.where(there, gained / np.where(there, length, 1.0), values)

    def gained(self, values: NDArray[float64]) -> NDArray[float64]:
        """The change of values from one end to the other."""
        begin, end = self.of(values)
        return end - begin
