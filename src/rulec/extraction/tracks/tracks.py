"""The tracks of all participants as arrays: places, headings, velocities.

Rows are participants, in the order of the file; columns are time steps, from ``first`` on.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, fields, replace
from typing import TypeAlias

import numpy as np
import shapely
from numpy import bool_, float64
from numpy.typing import NDArray

from rulec.extraction.source_tolerances import tolerances_of
from rulec.extraction.tracks.track_motion import Poses, motion_of
from rulec.extraction.traffic_thresholds import Thresholds
from rulec.recordings.recording import Lanelet, Participant, Points, Recording, is_lane
from rulec.scenario.recorded.route import lanelet_area

Floats: TypeAlias = NDArray[float64]
Flags: TypeAlias = NDArray[bool_]


@dataclass(frozen=True, eq=False, slots=True, kw_only=True)
class Tracks:
    """Arrays of participants by steps, NaN where one is not present.

    ``x`` and ``y`` are centres (m), ``heading`` is in rad. Velocities (m/s) and accelerations
    (m/s²) are those of ``motion_of``, with their errors.
    ``on_lane`` and ``on_crosswalk``: is the middle of a vulnerable road user on a lane, of any
    direction, or on a pedestrian crossing of the map?
    """

    participants: tuple[Participant, ...]
    first: int
    present: Flags
    x: Floats
    y: Floats
    heading: Floats
    vx: Floats
    vy: Floats
    speed: Floats
    speed_error: Floats
    acceleration: Floats
    acceleration_error: Floats
    on_lane: Flags
    on_crosswalk: Flags

    def outlines(self, *, repeated: bool = False) -> Iterator[tuple[int, int, Points]]:
        """Row, column and outline of participants.

        Those that stand for good have one, unless it is to be ``repeated``.
        """
        for row, body in enumerate(self.participants):
            if body.standing:
                outline = next(iter(body.outlines.values()))
                for column in range(self.present.shape[1] if repeated else 1):
                    yield row, column, outline
                continue
            for column in np.flatnonzero(self.present[row]).tolist():
                yield row, column, body.outlines[self.first + column]

    def part(self, rows: NDArray[np.intp], columns: slice) -> Tracks:
        """The tracks of some participants in a range of steps."""
        return replace(
            self,
            participants=tuple(self.participants[row] for row in rows),
            first=self.first + columns.start,
            **{
                field.name: getattr(self, field.name)[rows][:, columns]
                for field in fields(self)
                if field.name not in ("participants", "first")
            },
        )

    def of_type(self, name: str) -> Flags:
        """Flags of participants of an object type or its subtypes."""
        return np.array([name in body.object_types for body in self.participants], dtype=bool)


_STEERED = frozenset({"vehicle", "light_rider"})


def tracks_of(recording: Recording, thresholds: Thresholds) -> Tracks:
    """The tracks of the participants of a recording that occupy something."""
    bodies = tuple(body for body in recording.participants if body.outlines)
    steps = [step for body in bodies if not body.standing for step in body.outlines]
    first, last = min(steps, default=0), max(steps, default=0)
    shape = len(bodies), last - first + 1
    x, y, heading, stated = (np.full(shape, np.nan) for _ in range(4))
    for row, body in enumerate(bodies):
        poses = _poses(body)
        if body.standing:
            x[row], y[row], heading[row], stated[row] = next(iter(poses.values()))
            continue
        at = np.fromiter(poses, dtype=int, count=len(poses)) - first
        x[row, at], y[row, at], heading[row, at], stated[row, at] = np.array([*poses.values()]).T
    present = ~np.isnan(x)
    steers = np.array([bool(_STEERED.intersection(body.object_types)) for body in bodies], bool)
    motion = motion_of(
        Poses(x, y, heading, stated, steers),
        thresholds.smoothing_s,
        recording.step_s,
        tolerances_of(recording),
    )
    vulnerable = np.array(["vulnerable_user" in body.object_types for body in bodies], dtype=bool)
    users = present & vulnerable[:, None]
    lanelets = recording.lanelets.values()
    crosswalks = (lanelet for lanelet in lanelets if "crosswalk" in lanelet.types)
    return Tracks(
        participants=bodies,
        first=first,
        present=present,
        x=x,
        y=y,
        heading=heading,
        **{field.name: getattr(motion, field.name) for field in fields(motion)},
        on_lane=_inside(users, x, y, filter(is_lane, lanelets)),
        on_crosswalk=_inside(users, x, y, crosswalks),
    )


def _inside(flags: Flags, x: Floats, y: Floats, lanelets: Iterable[Lanelet]) -> Flags:
    inside = np.zeros(flags.shape, dtype=bool)
    areas = [lanelet_area(lanelet) for lanelet in lanelets]
    rows, columns = np.nonzero(flags)
    if areas and len(rows):
        points = shapely.points(x[rows, columns], y[rows, columns])
        at, _ = shapely.STRtree(areas).query(points, predicate="intersects")
        inside[rows[at], columns[at]] = True
    return inside


def _poses(body: Participant) -> dict[int, tuple[float, float, float, float]]:
    poses = {}
    for step, outline in body.outlines.items():
        state = body.states.get(step)
        if state is None:
            x, y = outline.mean(axis=0).tolist()
            poses[step] = x, y, 0.0, 0.0
        else:
            poses[step] = state.x, state.y, state.heading, state.speed
    return poses
