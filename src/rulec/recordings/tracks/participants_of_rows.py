"""Converts the rows of any table of tracks to participants of a recording."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.diagnostics import RulecError, did_you_mean, first_of
from rulec.recordings.encodings.file_values import short
from rulec.recordings.mending import derived_motion as motion
from rulec.recordings.mending.cut_tracks import cut_remark
from rulec.recordings.mending.short_holes import HOLES_WHY, LONGEST_HOLE_S, most_steps
from rulec.recordings.mending.track_jumps import CUT_WHY, DRIVERS, jumps, parts_between
from rulec.recordings.mending.wrong_places import (
    FARTHER_M,
    Path,
    bends_of,
    wrong_places,
    wrong_places_remark,
)
from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import OBSTACLE_TYPES, Lamp, Participant, id_order
from rulec.recordings.track import Track, tracked
from rulec.recordings.tracks.road_user_types import TYPES, USUAL_TYPE, type_of, usual_size
from rulec.recordings.tracks.track_rows import MOVING_MPS, TrackRows, check_rows, speeds_that_differ

HeadingAt = Callable[[float, float], float]

_NAMED = 3
_BACKING_MPS = 0.5


@dataclass(frozen=True, slots=True)
class ReadTracks:
    """The participants of a table, which of them is ego, and what was assumed."""

    participants: tuple[Participant, ...]
    ego: str
    remarks: tuple[str, ...]


def read_tracks(rows: TrackRows, heading_at: HeadingAt) -> ReadTracks:
    """The participants of rows; one that vanishes for long and returns becomes another one.

    ``heading_at`` gives the heading of participants that do not move. Raises RulecError for an
    invalid row.
    """
    check_rows(rows)
    return _Reading(rows, heading_at).result()


class _RowsOfTrack(NamedTuple):
    """A track's id, its type, and the numbers of its rows by ascending time."""

    name: str
    kind: str
    rows: NDArray[np.intp]


class _Reading:
    """Reads one table, counting what it leaves open."""

    def __init__(self, rows: TrackRows, heading_at: HeadingAt) -> None:
        self.rows = rows
        self.heading_at = heading_at
        self.taken: Counter[str] = Counter()
        self.types = _types(rows)
        self.of_several_types: list[str] = []
        self.cut: list[str] = []
        self.jumped: list[str] = []
        self.wrong: dict[str, int] = {}
        self.ego = ""

    def result(self) -> ReadTracks:
        rows = self.rows
        steps = rows.times.steps
        tracks: list[_RowsOfTrack] = []
        for name, own in rows.track.groups(steps):
            twice = np.diff(steps[own]) == 0
            if twice.any():
                raise self._repeated_row(name, own, int(np.argmax(twice)))
            tracks.append(_RowsOfTrack(name, self._type(name, own), own))
        rough = _rough_tracks(rows, [track.rows for track in tracks])
        for number in rough:
            tracks[number] = self._without_wrong_places(tracks[number])
        cuts = jumps([self._path(tracks[number]) for number in rough], rows.times.step_s)
        cut_at = dict(zip(rough, cuts, strict=True))
        participants: list[Participant] = []
        for number, track in enumerate(tracks):
            participants += self._participants(track, cut_at.get(number, ()))
        participants.sort(key=lambda participant: id_order(participant.id))
        return ReadTracks(tuple(participants), self.ego, tuple(self._remarks()))

    def _type(self, name: str, own: NDArray[np.intp]) -> str:
        """The type of a track: that of most of its rows that have one."""
        if self.rows.type is None:
            return USUAL_TYPE
        words = self.rows.type.names
        rows_of: Counter[str] = Counter()
        for code, count in zip(
            *np.unique(self.rows.type.codes[own], return_counts=True), strict=True
        ):
            if words[code]:
                rows_of[self.types[code]] += int(count)
        rows_of = rows_of or Counter([USUAL_TYPE])
        (kind, _), *others = rows_of.most_common()
        if others:
            self.of_several_types.append(f"`{short(name)}` ({', '.join([kind, *dict(others)])})")
        return kind

    def _repeated_row(self, name: str, own: NDArray[np.intp], at: int) -> RulecError:
        first, second = sorted(own[at : at + 2].tolist())
        rows = self.rows
        when = rows.times.steps[second] * rows.times.step_s + rows.times.start_s
        why = f"track `{short(name)}` is twice at {when:.15g} s"
        earlier = int(rows.columns.rows[first])
        way_out = (
            f"it is there in row {earlier:,}, too; keep one, or give them different tracks; "
            "`rulec fleet` reads a table of several recordings in Parquet, with a column "
            "`recording`"
        )
        return rows.columns.wrong(second, why, help_text=way_out)

    def _participants(self, track: _RowsOfTrack, cuts: Sequence[int]) -> Iterator[Participant]:
        """The participants of a track: one for each part without jumps and long gaps."""
        rows = self.rows
        name, kind, own = track
        length, width = self._size(kind, own)
        if rows.ego is not None and (rows.ego[own] == 1).any():
            if self.ego:
                why = f"`{short(self.ego)}` and `{short(name)}` are both ego"
                raise rows.columns.wrong(int(own[0]), why, "expected one track with 1 in `ego`")
            self.ego = name
        standing = self._stands(own)
        gaps = np.diff(rows.times.steps[own])
        if len(gaps) > 1 and np.median(gaps) > 1:
            step_s = rows.times.step_s
            why = (
                f"track `{short(name)}` has a row every {np.median(gaps) * step_s:.4g} s, while "
                f"times of the table are {step_s:.4g} s apart"
            )
            way_out = "give every track a row at each time step, or take out the times between"
            raise rows.columns.wrong(int(own[1]), why, help_text=way_out)
        parts = [own[:1]] if standing else [*self._parts(name, own, cuts)]
        for number, part in enumerate(parts, 1):
            states = self._track(kind, part, length, width)
            lamps = self._stated_lamps(part)
            yield tracked(
                name if number == 1 else f"{name}_{number}",
                kind,
                states,
                standing=standing,
                lamps=self._lit(part, lamps),
                shows=frozenset(lamps),
                resumes=None if number == 1 else int(rows.times.steps[parts[number - 2][-1]]),
                heads_as_it_moves=self._states_no_heading(part),
            )

    def _stands(self, own: NDArray[np.intp]) -> bool:
        standing = self.rows.standing
        return standing is not None and bool((standing[own] == 1).any())

    def _parts(
        self, name: str, own: NDArray[np.intp], cuts: Sequence[int]
    ) -> Iterator[NDArray[np.intp]]:
        """The rows of each part of a track, in order."""
        times = self.rows.times
        between = parts_between(cuts, len(own), times.step_s)
        if left_out := len(own) - sum(end - start for start, end in between):
            self.wrong[name] = self.wrong.get(name, 0) + left_out
        if len(between) > 1:
            self.jumped.append(name)
        longest = max(most_steps(LONGEST_HOLE_S, times.step_s), 1)
        for start, end in between:
            part = own[start:end]
            holes = np.flatnonzero(np.diff(times.steps[part]) > longest) + 1
            if len(holes) and name not in self.cut:
                self.cut.append(name)
            yield from np.split(part, holes)

    def _path(self, track: _RowsOfTrack) -> Path:
        """The places of a track; none for who does not drive, and thus may jump."""
        rows, own = self.rows, track.rows
        if self._stands(own) or DRIVERS.isdisjoint(OBSTACLE_TYPES[track.kind]):
            own = own[:0]
        places = np.column_stack((rows.x[own], rows.y[own]))
        return Path(rows.times.steps[own], places)

    def _without_wrong_places(self, track: _RowsOfTrack) -> _RowsOfTrack:
        """A track without the places that it cannot have reached: headings follow from them."""
        rows, own = self.rows, track.rows
        if self._stands(own):
            return track
        places = np.column_stack((rows.x[own], rows.y[own]))
        wrong = wrong_places(Path(rows.times.steps[own], places), rows.times.step_s)
        if not wrong.any():
            return track
        self.wrong[track.name] = int(wrong.sum())
        return track._replace(rows=own[~wrong])

    def _size(self, kind: str, own: NDArray[np.intp]) -> tuple[float, float]:
        """Length and width: the medians of the stated ones, else the usual ones."""
        size = []
        for dimension, column, usual in zip(
            ("length", "width"), (self.rows.length, self.rows.width), usual_size(kind), strict=True
        ):
            stated = np.zeros(0) if column is None else column[own]
            stated = stated[stated > 0]
            if not len(stated):
                self.taken[f"{dimension} of a {kind} {usual:g} m"] += 1
            size.append(float(np.median(stated)) if len(stated) else usual)
        return size[0], size[1]

    def _track(self, kind: str, own: NDArray[np.intp], length: float, width: float) -> Track:
        rows, times = self.rows, self._times(own)
        places = np.column_stack((rows.x[own], rows.y[own]))
        heading = self._heading(kind, own, places)
        if rows.front:
            ahead = np.column_stack((np.cos(heading), np.sin(heading)))
            places = places - length / 2 * ahead
        moved = motion.along(motion.velocities_of(places, times), heading)
        speed = _filled(self._speed(own, heading, moved), moved)
        gained = motion.accelerations_of(speed, times)
        acceleration = gained if rows.acceleration is None else rows.acceleration[own]
        states = np.column_stack((places, heading, speed, _filled(acceleration, gained)))
        return Track(rows.times.steps[own], states, length, width)

    def _times(self, own: NDArray[np.intp]) -> Floats | float:
        """The times (s) of rows of a track; the step if it has no holes, which is exact."""
        steps, step_s = self.rows.times.steps[own], self.rows.times.step_s
        if int(steps[-1] - steps[0]) < len(steps):
            return step_s
        times: Floats = (steps * step_s).astype(float64)
        return times

    def _heading(self, kind: str, own: NDArray[np.intp], places: NDArray[float64]) -> Floats:
        stated = None if self.rows.heading is None else self.rows.heading[own]
        if stated is not None and not np.isnan(stated).any():
            return wrapped(stated)
        derived = self._by_velocity(own)
        if derived is None:
            derived = motion.headings_of(places)
        if derived is None:
            if stated is None or np.isnan(stated).all():
                self.taken[f"heading of a {kind} that does not move that of the lane"] += 1
            derived = np.full(len(own), self.heading_at(*places[0].tolist()))
        return wrapped(derived if stated is None else _filled(stated, derived))

    def _states_no_heading(self, own: NDArray[np.intp]) -> bool:
        return self.rows.heading is None or bool(np.isnan(self.rows.heading[own]).any())

    def _by_velocity(self, own: NDArray[np.intp]) -> Floats | None:
        """The direction of velocities, kept while slow; None if the track is never fast enough."""
        if self.rows.velocity is None:
            return None
        vx, vy = (component[own] for component in self.rows.velocity)
        fast = np.flatnonzero(np.hypot(vx, vy) >= MOVING_MPS / 2)
        if not len(fast):
            return None
        directions = np.unwrap(np.arctan2(vy[fast], vx[fast]))
        result: Floats = np.interp(np.arange(len(own)), fast, directions)
        return result

    def _speed(self, own: NDArray[np.intp], heading: Floats, moved: Floats) -> Floats:
        """Speeds along headings as stated, with the sign of the motion."""
        rows = self.rows
        if rows.speed is not None:
            stated = rows.speed[own]
        elif rows.velocity is not None:
            stated = motion.along(np.column_stack([part[own] for part in rows.velocity]), heading)
        else:
            return moved
        other_way = (np.abs(moved) > _BACKING_MPS) & (moved * stated < 0)
        if other_way.any():
            # Noise alone moves bodies back from step to step
            places = np.column_stack((rows.x[own], rows.y[own]))
            times = (rows.times.steps[own] * rows.times.step_s).astype(float64)
            moved = motion.along(motion.steady_velocities(places, times, _BACKING_MPS), heading)
            other_way = (np.abs(moved) > _BACKING_MPS) & (moved * stated < 0)
        return np.where(other_way, -stated, stated)

    def _stated_lamps(self, own: NDArray[np.intp]) -> dict[Lamp, Floats]:
        """The lamps of which some row says whether they are lit, with a value for each row."""
        values = {lamp: column[own] for lamp, column in self.rows.lamps.items()}
        return {lamp: column for lamp, column in values.items() if not np.isnan(column).all()}

    def _lit(
        self, own: NDArray[np.intp], lamps: Mapping[Lamp, Floats]
    ) -> dict[int, frozenset[Lamp]]:
        """The lit ones of ``lamps`` by step; steps that leave one of them open are missing."""
        if not lamps:
            return {}
        known = ~np.isnan(np.array([*lamps.values()])).any(axis=0)
        steps = self.rows.times.steps[own]
        return {
            int(steps[at]): frozenset(lamp for lamp, column in lamps.items() if column[at] == 1)
            for at in np.flatnonzero(known).tolist()
        }

    def _remarks(self) -> Iterator[str]:
        if self.rows.type is None:
            yield f"all tracks are taken to be of type `{USUAL_TYPE}`, as there is no column `type`"
        if several := self.of_several_types:
            some = first_of(several, _NAMED)
            yield f"tracks of several types are taken to be of the most frequent one: {some}"
        if self.wrong:
            yield wrong_places_remark([*self.wrong], sum(self.wrong.values()))
        if self.cut:
            yield cut_remark(self.cut, HOLES_WHY)
        if self.jumped:
            yield cut_remark(self.jumped, CUT_WHY)
        usual = [unstated for unstated, _ in self.taken.most_common()]
        if usual:
            yield f"what is not stated is taken to be as usual: {first_of(usual, _NAMED)}"
        yield from speeds_that_differ(self.rows)
        if self.rows.times.start_s:
            yield f"times count from the first one, {self.rows.times.start_s:.10g} s"


def _rough_tracks(rows: TrackRows, tracks: Sequence[NDArray[np.intp]]) -> list[int]:
    """The numbers of tracks that are not smooth; their rows are ascending by time."""
    order = np.concatenate(tracks)
    number = np.arange(len(tracks)).repeat([len(own) for own in tracks])
    bends = bends_of(rows.times.steps[order], rows.x[order], rows.y[order])
    rough = (bends > FARTHER_M**2) & (number[2:] == number[:-2])
    numbers: list[int] = np.unique(number[:-2][rough]).tolist()
    return numbers


def _filled(values: Floats, others: Floats) -> Floats:
    return np.where(np.isnan(values), others, values)


def _types(rows: TrackRows) -> Sequence[str]:
    """Our type for each of the table's types. Raises RulecError for an unknown one."""
    if rows.type is None:
        return []
    ours = []
    for code, word in enumerate(rows.type.names):
        known = type_of(word) if word else USUAL_TYPE
        if known is None and (rows.type.codes == code).any():
            row = int(np.argmax(rows.type.codes == code))
            help_text = did_you_mean(word, TYPES) or "write `unknown` for what it cannot tell"
            why = f"nobody is of type `{short(word)}`"
            some = "expected a type such as `car`, `truck`, `bus`, `bicycle`, `pedestrian`"
            raise rows.columns.wrong(row, why, some, help_text)
        ours.append(known or USUAL_TYPE)
    return ours
