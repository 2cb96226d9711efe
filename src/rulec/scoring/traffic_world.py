"""The world in which futures of one vehicle are scored: a map, the others, and ego's body."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import floor

import numpy as np
import shapely
from numpy import bool_, float64
from numpy.typing import ArrayLike, NDArray

from rulec.diagnostics import SourceLocation, did_you_mean
from rulec.diagnostics.argument_kinds import expected, finite
from rulec.extraction.candidate_drives import Block, CandidateDrives
from rulec.extraction.possible_types import PossibleTypes
from rulec.extraction.recording_parts import egos_of, span_of, whole_recording
from rulec.extraction.selection import (
    RequestedDrives,
    chosen_side,
    with_drives_otherwise,
    with_night_assumed,
)
from rulec.extraction.traces.recorded_drive import Drive, NoDrive
from rulec.extraction.traces.to_trace import TraceWriter
from rulec.extraction.tracks.mirror import mirrored_recording
from rulec.extraction.tracks.source_tolerances import tolerances_of
from rulec.recordings.encodings.file_values import LARGEST
from rulec.recordings.encodings.speed_units import MPS_PER_KMH
from rulec.recordings.mending.derived_motion import accelerations_of
from rulec.recordings.mending.mended_recording import mended
from rulec.recordings.recording import HEADINGS, Participant, Recording, is_lane
from rulec.recordings.recording_messages import NOT_IN_RECORDING
from rulec.recordings.track import Track, TrackOutlines, TrackStates, rectangles
from rulec.rulebook.rulebook_model import Traffic
from rulec.scenario.recorded.route import lanelet_area
from rulec.scoring.scoring_messages import BAD_CANDIDATES
from rulec.value_display import short_repr

_COLUMNS = ("x", "y", "heading", "speed")
_NO_STATES = 0, len(_COLUMNS)
_BESIDE_M = 0.5
"""Greatest distance (m) from the lanes; 1 of 1,900 states of recorded vehicles is farther away."""

_NUMBERS = "iufO"
"""The kinds of NumPy arrays that may hold numbers."""


@dataclass(frozen=True, eq=False)
class TrafficWorld:
    """A recorded or live world, prepared once for any number of futures of ``ego``.

    The ``recording`` has the map and all participants with everything known or predicted of them;
    ego is one of them, by default the one that the file names. The present is the last step not
    after ``now_s`` (s of the recording), by default ego's last one; ego's later states are ignored.
    ``wanted`` gives thresholds and assumptions; its egos are ignored. Raises RulecError R0612 if
    ego is not in the recording, or nobody is there at that time.
    """

    __repr__ = short_repr

    recording: Recording
    ego: str = ""
    now_s: float | None = None
    wanted: RequestedDrives = field(default_factory=RequestedDrives)
    _prepared: dict[object, DrivesByType] = field(
        default_factory=dict, init=False, repr=False, compare=False
    )

    def __post_init__(self) -> None:
        expected("recording", "Recording", self.recording)
        expected("ego", "str", self.ego)
        finite("now_s", self.now_s)
        expected("wanted", "RequestedDrives", self.wanted)
        name = self.ego or self.recording.ego
        known = {body.id: body for body in self.recording.participants if body.states}
        drivers = [own for own in egos_of(self.recording) if own in known]
        if name not in drivers:
            raise NOT_IN_RECORDING.error(
                SourceLocation(self.recording.name),
                f"there is no vehicle `{name}` that drives"
                if name
                else "the recording does not say which vehicle is ego",
                help=did_you_mean(name, drivers) or "name a vehicle of the recording",
            )
        object.__setattr__(self, "ego", name)
        spans = [span_of(body) for body in known.values() if not body.standing]
        first, last = min(low for low, _ in spans) - 1, max(high for _, high in spans)
        if not first <= self.now <= last:
            step_s = self.recording.step_s
            raise NOT_IN_RECORDING.error(
                SourceLocation(self.recording.name),
                f"at {self.now_s:g} s nobody is recorded",
                help=f"choose a time from {first * step_s:g} to {last * step_s:g} s",
            )

    def __reduce__(self) -> tuple[type[TrafficWorld], tuple[object, ...]]:
        return TrafficWorld, (self.recording, self.ego, self.now_s, self.wanted)

    @cached_property
    def now(self) -> int:
        """The present time step."""
        if self.now_s is None:
            return max(self._body.states)
        # A state is not known before its time; a step's own time may be a float just below it
        return floor(max(-1e18, min(self.now_s / self.recording.step_s, 1e18)) + 1e-6)

    @cached_property
    def past(self) -> NDArray[float64]:
        """Ego's states up to the present without a gap, one row each: x, y, heading, speed."""
        rows = []
        step = self.now
        while (state := self._body.states.get(step)) is not None:
            rows.append((state.x, state.y, state.heading, state.speed))
            step -= 1
        return np.array(rows[::-1], dtype=float).reshape(-1, len(_COLUMNS))

    def recording_of(self, candidate: ArrayLike, after: ArrayLike | None = None) -> Recording:
        """The recording in which ego drives a candidate, after its past.

        Ego is the last of its participants. Raises RulecError R0780.
        """
        future = _numbers("a candidate", candidate, 2)
        body = self.body_along(future, self.past_of(after))
        return self._with_ego(body)

    def past_of(self, after: ArrayLike | None) -> NDArray[float64]:
        """The past as an array, with no rows for None. Raises RulecError R0780."""
        return _numbers("the past", [] if after is None else after, 2, or_none=True)

    def candidates_of(self, candidates: ArrayLike) -> NDArray[float64]:
        """Candidates as an array. Raises RulecError R0780."""
        return _numbers("candidates", candidates, 3)

    def beside_lanes(self, paths: NDArray[float64]) -> NDArray[bool_]:
        """Mask of the states in which ego's middle is clearly beside all lanes, as on a verge."""
        x, y = paths[..., 0].ravel(), paths[..., 1].ravel()
        beside = np.ones(len(x), dtype=bool)
        for number in self._lanes.query(shapely.box(x.min(), y.min(), x.max(), y.max())).tolist():
            area = self._lanes.geometries[number]
            left, low, right, high = area.bounds
            own = (beside & (x >= left) & (x <= right) & (y >= low) & (y <= high)).nonzero()[0]
            beside[own] = ~shapely.intersects_xy(area, x[own], y[own])
        # Distances cost ten times as much, so only the states left need them
        off = beside.nonzero()[0]
        if not len(off):
            return beside.reshape(paths.shape[:-1])
        points = shapely.points(x[off], y[off])
        near, _ = self._lanes.query(points, predicate="dwithin", distance=_BESIDE_M)
        beside[off[near]] = False
        return beside.reshape(paths.shape[:-1])

    def drives_back(self, paths: NDArray[float64], past: NDArray[float64]) -> NDArray[bool_]:
        """Mask of the states reached by driving against ego's heading faster than at walking pace.

        Such states cannot be judged by the lanes, which lead in the direction of the heading.
        """
        before = np.empty_like(paths)
        before[:, 1:] = paths[:, :-1]
        before[:, 0] = past[-1] if len(past) else paths[:, 0]
        x, y = (paths - before).transpose(2, 0, 1)[:2]
        is_back = x * np.cos(paths[..., 2]) + y * np.sin(paths[..., 2]) < 0
        most_mps = self.wanted.thresholds.walking_pace_kmh * MPS_PER_KMH
        back: NDArray[bool_] = is_back & (np.hypot(x, y) > most_mps * self.recording.step_s)
        return back

    def body_along(self, future: NDArray[float64], past: NDArray[float64]) -> Participant:
        """Ego driving a candidate, after its past."""
        return self.body_at(np.concatenate((past, future)), self.now + 1 - len(past))

    def bodies_along(self, futures: NDArray[float64], past: NDArray[float64]) -> list[Participant]:
        """Ego driving each candidate, after its past."""
        before = past[None].repeat(len(futures), axis=0)
        return self._bodies(np.concatenate((before, futures), axis=1), self.now + 1 - len(past))

    def body_at(self, rows: NDArray[float64], first: int) -> Participant:
        """Ego in states from step ``first`` on. Its lamps are known up to the present."""
        (body,) = self._bodies(rows[None], first)
        return body

    def _bodies(self, rows: NDArray[float64], first: int) -> list[Participant]:
        n_bodies, n_states, _ = rows.shape
        if self._trusts_speeds:
            rows = _with_driven_speeds(rows, self.now + 1 - first, self.recording.step_s)
        gained = accelerations_of(rows[..., 3], self.recording.step_s)
        rows = np.concatenate((rows, gained[..., None]), axis=2)
        size = self._size
        every = rows.reshape(-1, rows.shape[2])
        # All at once: twenty times as fast as one by one
        outlines = rectangles(every[:, :2], every[:, 2], *size).reshape(n_bodies, n_states, -1, 2)
        steps = np.arange(first, first + n_states, dtype=np.int64)
        lamps = self._body.lamps
        lit = {step: own for step, own in lamps.items() if first <= step <= self.now}
        bodies = []
        for own, laid_out in zip(rows, outlines, strict=True):
            track = Track(steps, own, *size)
            outline = TrackOutlines(track, [laid_out])
            bodies.append(
                replace(self._body, states=TrackStates(track), outlines=outline, lamps=lit)
            )
        return bodies

    def drives(self, traffic: Traffic, first: int, last: int) -> tuple[DrivesByType, bool]:
        """The data prepared for rules of a side of traffic, and candidates of a range of steps.

        The second result is whether all of it is mirrored.
        """
        side, mirrored = chosen_side(self.recording, self.wanted, traffic)
        low, high = self._span or (first, last)
        span = min(first, low), max(last, high)
        key = side, mirrored, span, first == span[0]
        if key not in self._prepared:
            # Ego exists only while a candidate does, not in its recorded states before
            there = np.zeros((last + 1 - first, len(_COLUMNS)))
            recording = self._with_ego(self.body_at(there, first))
            if mirrored:
                recording = mirrored_recording(recording)
            self._prepared.clear()
            drives = CandidateDrives(recording, side, self.wanted.thresholds, span)
            self._prepared[key] = DrivesByType(drives)
        return self._prepared[key], mirrored

    def _with_ego(self, body: Participant) -> Recording:
        found = replace(self._known, participants=(*self._others, body), ego=self.ego)
        # A jerky candidate must not raise the noise estimated from the recording
        known = whole_recording(self._known)
        whole = replace(whole_recording(found), noise_m=known.noise_m, noise_rad=known.noise_rad)
        return replace(found, whole=whole)

    @cached_property
    def _lanes(self) -> shapely.STRtree:
        # Some maps also have sidewalks, verges and parking places, which are not lanes
        lanes = filter(is_lane, self.recording.lanelets.values())
        areas = [*map(lanelet_area, lanes)]
        shapely.prepare(areas)
        return shapely.STRtree(areas)

    @cached_property
    def _known(self) -> Recording:
        recording = with_night_assumed(self.recording, self.wanted.assumed)
        found = mended(recording, self.wanted.thresholds.away_s)
        # A planned future always has ego's headings
        return replace(found, complete=found.complete | {HEADINGS})

    @cached_property
    def _trusts_speeds(self) -> bool:
        """Whether the recording's speeds count, as SUMO's do; a candidate's could be any."""
        return tolerances_of(self._known, self.wanted.thresholds).stated_mps is not None

    @cached_property
    def _body(self) -> Participant:
        return next(body for body in self._known.participants if body.id == self.ego)

    @cached_property
    def _others(self) -> tuple[Participant, ...]:
        return tuple(body for body in self._known.participants if body.id != self.ego)

    @cached_property
    def _span(self) -> tuple[int, int] | None:
        """The first and the last step of the other moving participants."""
        steps = [list(body.outlines) for body in self._others if not body.standing]
        ends = [(min(own), max(own)) for own in steps if own]
        if not ends:
            return None
        return min(low for low, _ in ends), max(high for _, high in ends)

    @cached_property
    def _size(self) -> tuple[float, float, float]:
        """Ego's length and width (m), and how far (m) its centre is ahead of its middle."""
        outlines = self._body.outlines
        if isinstance(outlines, TrackOutlines):
            return outlines.track.length, outlines.track.width, outlines.track.shift
        step, state = next(iter(self._body.states.items()))
        cos, sin = np.cos(state.heading), np.sin(state.heading)
        x, y = (outlines[step] - (state.x, state.y)).T
        ahead, aside = x * cos + y * sin, y * cos - x * sin
        return float(np.ptp(ahead)), float(np.ptp(aside)), -float(ahead.min() + ahead.max()) / 2


def _with_driven_speeds(rows: NDArray[float64], n_past: int, step_s: float) -> NDArray[float64]:
    """States of which those after the past have the speeds (m/s) that their places show."""
    n_states = rows.shape[1]
    if n_states < 2:
        return rows
    order = min(n_states - 1, 2)
    x, y = (np.gradient(rows[..., k], step_s, axis=1, edge_order=order) for k in (0, 1))
    driven: NDArray[float64] = rows.copy()
    driven[:, n_past:, 3] = np.hypot(x, y)[:, n_past:]
    return driven


def _numbers(
    what: str, values: ArrayLike, n_axes: int, *, or_none: bool = False
) -> NDArray[float64]:
    try:
        given = np.array(values, subok=True)
        # NumPy would convert texts, dates and masked values to numbers
        is_masked = type(given) is not np.ndarray and np.ma.is_masked(given)
        is_odd = is_masked or given.dtype.kind not in _NUMBERS
        found = np.array([] if is_odd else given, dtype=float)
    except (TypeError, ValueError, OverflowError):
        is_odd = True
    if is_odd:
        way_out = "give lists of numbers of equal length, or `numpy.array(…, dtype=float)`"
        raise BAD_CANDIDATES.error(None, f"{what}: this is not an array of numbers", help=way_out)
    # An empty past is allowed, also as a list
    if or_none and found.shape in {(0,), _NO_STATES}:
        return np.empty(_NO_STATES)
    shape = "(candidates, states, 4)" if n_axes == 3 else "(states, 4)"
    if found.ndim != n_axes or found.shape[-1] != len(_COLUMNS) or not found.size:
        message = f"{what}: an array of shape {found.shape}"
        way_out = f"give {', '.join(_COLUMNS)} of each state, and at least one state"
        if n_axes == found.ndim == 3 and not len(found):
            way_out = "give at least one candidate"
        if n_axes == 3 and found.ndim == 2 and found.shape[-1] == len(_COLUMNS):
            way_out = "put a single candidate into a list: `[candidate]`"
        if n_axes == 2 and found.ndim == 3:
            way_out = "give one of them, such as `paths[0]`"
        raise BAD_CANDIDATES.error(None, message, expected=f"expected shape {shape}", help=way_out)
    bad = ~(np.abs(found) < LARGEST)
    if bad.any():
        at = tuple(int(axis[0]) for axis in bad.nonzero())
        place = ", ".join(map(str, at))
        message = f"{what}: the number at [{place}] is {found[at]:g}"
        expected = f"expected a number below {LARGEST:.0e}"
        way_out = "leave out candidates that have no place in some state"
        raise BAD_CANDIDATES.error(None, message, expected=expected, help=way_out)
    return found


@dataclass(frozen=True)
class DrivesByType:
    """The drives of candidates among others, each with those of ``otherwise``.

    As in a recording, these are for candidates that have a participant of unknown type near them.
    """

    drives: CandidateDrives

    @cached_property
    def _types(self) -> PossibleTypes:
        return PossibleTypes(self.drives.recording)

    @cached_property
    def _otherwise(self) -> Sequence[CandidateDrives]:
        """The drives among the same others, if those of unknown type had one that they may have."""
        own = self.drives
        return [
            CandidateDrives(recording, own.side, own.thresholds, own.span)
            for recording in self._types.recordings()
        ]

    def in_blocks(self, candidates: Sequence[Participant], writer: TraceWriter) -> Iterator[Block]:
        """The drives of candidates, block by block; the first contains the first candidate."""
        for block in self.drives.in_blocks(candidates, writer):
            if writer.defaults:
                yield block
                continue
            reach_m = 2 * self.drives.thresholds.near_m
            near = [x for x, _ in block if self._types.is_near(candidates[x], reach_m)]
            yield self._with_others(block, near, candidates, writer) if near else block

    def _with_others(
        self,
        block: Block,
        near: Sequence[int],
        candidates: Sequence[Participant],
        writer: TraceWriter,
    ) -> Block:
        bodies = [candidates[number] for number in near]
        writer = replace(writer, bare=True)
        found = [
            dict(zip(near, drives.of(bodies, writer), strict=True)) for drives in self._otherwise
        ]

        def of(number: int, own: tuple[Drive | NoDrive, ...]) -> tuple[Drive | NoDrive, ...]:
            others = [of_type[number] for of_type in found if number in of_type]
            return tuple(with_drives_otherwise(own, others))

        return [(number, of(number, own)) for number, own in block]
