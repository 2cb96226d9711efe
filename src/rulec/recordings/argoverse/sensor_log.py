"""Sensor logs of Argoverse 2: all participants around ego, sweep by sweep.

According to `av2.structures.cuboid` and `av2.utils.io`, annotations are boxes in ego's frame at the
time of a sweep; the poses of that frame, whose origin is the middle of ego's rear axle, are in the
city's frame, as the map is.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

import numpy as np
from numpy import bool_, float64, int64, intp
from numpy.typing import NDArray

from rulec.array_types import Floats
from rulec.recordings.argoverse.argoverse_files import ANNOTATIONS, MAP, POSES, map_beside, only_in
from rulec.recordings.argoverse.map_archive import read_map_archive
from rulec.recordings.argoverse.object_types import (
    CATEGORIES,
    EGO_MIDDLE_M,
    EGO_SIZE_M,
    NOT_ON_THE_ROAD,
    RIDES,
    tracks_in,
)
from rulec.recordings.encodings.arrow.arrow_tables import ArrowTable, Wanted, read_table
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.lane_centres.even_steps import even_steps
from rulec.recordings.mending.derived_motion import accelerations_of, along, velocities_of
from rulec.recordings.recording import Participant, Recording
from rulec.recordings.track import Track, tracked

SENSOR = FileFormat(
    "a sensor log of Argoverse 2",
    "it is `annotations.feather`, with `city_SE3_egovehicle.feather` beside it, as the data set "
    "has them",
)
FORM = "Argoverse 2 sensor log"

EGO = "AV"
"""The id of ego if it has no annotation, as in motion forecasting."""

_EGO_CATEGORY = "EGO_VEHICLE"
_QUATERNION, _PLACE = ("qw", "qx", "qy", "qz"), ("tx_m", "ty_m", "tz_m")
_POSES = Wanted(numbers=(*_QUATERNION, *_PLACE), whole=("timestamp_ns",))
_POINTS = "num_interior_pts"
_BOXES = Wanted(
    numbers=(*_QUATERNION, *_PLACE, "length_m", "width_m"),
    whole=("timestamp_ns", _POINTS),
    texts=("track_uuid", "category"),
    optional=frozenset({_POINTS}),
)
_NAME = re.compile(MAP.replace("*", r"([0-9A-Za-z-]+)_*.*").replace(".json", r"\.json"))
_REMARK = (
    f"ego's middle is not in the log; it is assumed to be {EGO_MIDDLE_M:g} m ahead of its rear axle"
)


_NANOSECONDS = 1_000_000_000

_UNITS_PER_SECOND = 100
"""Time steps are rounded to 0.01 s: sweeps are 0.1 s apart to within a millisecond."""

_LARGEST_M = 200.0
_RIDDEN_M = 1.0
"""A rider belongs to a vehicle if the middles of their boxes are at most this far apart (m)."""

_UNEVEN_S = 0.01
"""Tolerance (s): sweeps are 0.1 s apart to within a millisecond."""

_UNSEEN_S, _STAYED_M = 1.0, 0.5
"""A box between two sweeps with lidar points counts as measured within these limits.

The sweeps are at most this time apart (s), or the box moves by at most this far (m) between them.
Speeds, too, are means over a second.
"""


@dataclass(frozen=True, eq=False, slots=True)
class CityPoses:
    """Rotations (3 x 3 matrices) and translations (m), one row each."""

    rotations: Floats
    translations: Floats

    @property
    def headings(self) -> Floats:
        """The directions (rad) of the x axes in the plane."""
        headings: Floats = np.arctan2(self.rotations[:, 1, 0], self.rotations[:, 0, 0])
        return headings

    def taken(self, rows: NDArray[intp]) -> CityPoses:
        """The poses in the given rows."""
        return CityPoses(self.rotations[rows], self.translations[rows])

    def after(self, inner: CityPoses) -> CityPoses:
        """Poses in these frames, converted to these frames' outer frame, row by row."""
        moved = np.einsum("nij,nj->ni", self.rotations, inner.translations) + self.translations
        return CityPoses(np.einsum("nij,njk->nik", self.rotations, inner.rotations), moved)


@dataclass(frozen=True, eq=False, slots=True)
class _Sweeps:
    """The sweeps with annotations: their times (s), time steps, and ego's poses."""

    seconds: NDArray[float64]
    steps: NDArray[int64]
    poses: CityPoses


@dataclass(frozen=True, eq=False, slots=True)
class TrackBoxes:
    """The boxes of a track: each box's sweep, its pose in the city, and the size (m)."""

    id: str
    category: str
    sweeps: NDArray[intp]
    poses: CityPoses
    size: tuple[float, float]

    def kept(self, flags: NDArray[bool_]) -> TrackBoxes:
        """The track, reduced to the boxes whose flag is set."""
        rows = np.flatnonzero(flags)
        return replace(self, sweeps=self.sweeps[rows], poses=self.poses.taken(rows))

    def measured(self, points: NDArray[int64], seconds: NDArray[float64]) -> TrackBoxes:
        """The track without guessed boxes: those of a moving object that contain no lidar point."""
        seen = np.flatnonzero(points > 0)
        if len(seen) in (0, len(points)):
            return self if len(seen) else self.kept(points > 0)
        moments, places = seconds[self.sweeps], self.poses.translations[:, :2]
        after = np.searchsorted(seen, np.arange(len(points)))
        before = np.searchsorted(seen, np.arange(len(points)), side="right") - 1
        previous, following = (seen[np.clip(at, 0, len(seen) - 1)] for at in (before, after))
        between = (before >= 0) & (after < len(seen))
        short = between & (moments[following] - moments[previous] <= _UNSEEN_S + _UNEVEN_S)
        stayed = np.all(
            [np.hypot(*(places - places[at]).T) <= _STAYED_M for at in (previous, following)],
            axis=0,
        )
        return self.kept((points > 0) | short | stayed)


def read_sensor_log(path: Path, map_path: Path | None = None) -> Recording:
    """Read a log from its annotations or their folder, on the given map or the one next to it.

    Raises RulecError R0610 for a file that is not a log or has no poses or map, R0701 if a file
    cannot be opened, R0706 without pyarrow.
    """
    path = only_in(path, ANNOTATIONS, SENSOR)
    boxes = read_table(path, SENSOR, _BOXES)
    if not boxes.rows:
        raise SENSOR.refused(path, "it contains no road users")
    moments, sweep_of = np.unique(boxes.whole["timestamp_ns"], return_inverse=True)
    seconds = (moments - moments[0]) / _NANOSECONDS
    step_s, steps = even_steps(seconds, partial(SENSOR.refused, path), _UNITS_PER_SECOND)
    at = path.parent / POSES
    if not at.is_file():
        raise SENSOR.refused(path, f"there is no `{POSES}` beside it")
    poses = _poses_at(read_table(at, SENSOR, _POSES), moments)
    sweeps = _Sweeps(seconds, steps, poses)
    tracks = list(_tracks(boxes, sweeps, sweep_of.reshape(-1)))
    map_path = map_path or map_beside(path, SENSOR)
    road = read_map_archive(map_path)
    own = next((x for x in tracks if x.category == _EGO_CATEGORY), None)
    ego = _ego(EGO if own is None else own.id, EGO_SIZE_M if own is None else own.size, sweeps)
    others = _with_riders([x for x in tracks if x.category != _EGO_CATEGORY])
    if any(x.id == ego.id for x in others):
        raise SENSOR.refused(path, f"somebody else is called `{ego.id}`, as ego is")
    log = _NAME.fullmatch(map_path.name)
    return Recording(
        name=log[1] if log else path.resolve().parent.name,
        step_s=step_s,
        lanelets=road.lanelets,
        participants=tuple(_participant(x, sweeps) for x in (ego, *others) if len(x.sweeps)),
        form=FORM,
        side=road.side,
        country=road.country,
        remarks=(_REMARK,),
        ego=ego.id,
    )


def _poses_at(table: ArrowTable, moments: NDArray[int64]) -> CityPoses:
    """Ego's poses at the times of annotations, each of which must have a pose."""
    known = table.whole["timestamp_ns"]
    order = np.argsort(known, kind="stable")
    rows = np.searchsorted(known, moments, sorter=order)
    have_pose = np.append(known[order], -1)[rows] == moments
    if not have_pose.all():
        missing = int(moments[np.argmin(have_pose)])
        raise SENSOR.refused(table.path, f"it has no pose at {missing} ns, a moment of annotations")
    return _poses(table).taken(order[rows])


def _poses(table: ArrowTable) -> CityPoses:
    """The poses in a table. Raises RulecError R0610 for a quaternion of 0."""
    quaternions = np.stack([table.numbers[name] for name in _QUATERNION], axis=1)
    flat = np.abs(quaternions).max(axis=1, initial=0.0) < 1e-6
    if flat.any():
        raise table.refused(int(np.argmax(flat)), "its quaternion is 0")
    places = np.stack([table.numbers[name] for name in _PLACE], axis=1)
    return CityPoses(_rotations(quaternions), places)


def _rotations(quaternions: Floats) -> Floats:
    """The rotation matrices of quaternions (w, x, y, z) of any length except 0."""
    w, x, y, z = (quaternions / np.linalg.norm(quaternions, axis=1)[:, None]).T
    rows = (
        (x * x - y * y - z * z + w * w, 2 * (x * y - z * w), 2 * (x * z + y * w)),
        (2 * (x * y + z * w), -x * x + y * y - z * z + w * w, 2 * (y * z - x * w)),
        (2 * (x * z - y * w), 2 * (y * z + x * w), -x * x - y * y + z * z + w * w),
    )
    matrices: Floats = np.stack([np.stack(row, axis=-1) for row in rows], axis=1)
    return matrices


def _tracks(table: ArrowTable, sweeps: _Sweeps, sweep_of: NDArray[intp]) -> Iterator[TrackBoxes]:
    sizes = np.stack([table.numbers["length_m"], table.numbers["width_m"]], axis=1)
    odd = ((sizes <= 0) | (sizes > _LARGEST_M)).any(axis=1)
    if odd.any():
        row = int(np.argmax(odd))
        raise table.refused(row, f"a box is {sizes[row, 0]:g} m by {sizes[row, 1]:g} m")
    in_city = sweeps.poses.taken(sweep_of).after(_poses(table))
    named = tracks_in(table, "track_uuid", "category", sweep_of, "one sweep")
    for name, category, rows in named:
        if category in NOT_ON_THE_ROAD:
            continue
        if category not in CATEGORIES:
            raise table.refused(int(rows[0]), f"`category` is `{short(category)}`")
        length, width = np.median(sizes[rows], axis=0).tolist()
        boxes = TrackBoxes(name, category, sweep_of[rows], in_city.taken(rows), (length, width))
        points = table.whole.get(_POINTS)
        yield boxes if points is None else boxes.measured(points[rows], sweeps.seconds)


def _ego(name: str, size: tuple[float, float], sweeps: _Sweeps) -> TrackBoxes:
    count = len(sweeps.steps)
    ahead = np.tile([EGO_MIDDLE_M, 0.0, 0.0], (count, 1))
    middle = sweeps.poses.after(CityPoses(np.tile(np.eye(3), (count, 1, 1)), ahead))
    return TrackBoxes(name, _EGO_CATEGORY, np.arange(count), middle, size)


def _with_riders(boxes: Sequence[TrackBoxes]) -> list[TrackBoxes]:
    """The boxes, with rider and ridden vehicle merged into one box that covers both."""
    ridden = {x.id: np.zeros(len(x.sweeps), dtype=bool) for x in boxes}
    sizes = {x.id: x.size for x in boxes}
    for rider in boxes:
        for device in boxes:
            if device.category != RIDES.get(rider.category):
                continue
            _, on, under = np.intersect1d(rider.sweeps, device.sweeps, return_indices=True)
            apart = rider.poses.translations[on, :2] - device.poses.translations[under, :2]
            near = np.hypot(*apart.T) <= _RIDDEN_M
            if near.any():
                ridden[device.id][under[near]] = True
                own, other = sizes[rider.id], device.size
                sizes[rider.id] = max(own[0], other[0]), max(own[1], other[1])
    return [replace(x, size=sizes[x.id]).kept(~ridden[x.id]) for x in boxes]


def _participant(box: TrackBoxes, sweeps: _Sweeps) -> Participant:
    places, heading = box.poses.translations[:, :2], box.poses.headings
    moments = sweeps.seconds[box.sweeps]
    speed = along(velocities_of(places, moments), heading)
    rows = np.column_stack((places, heading, speed, accelerations_of(speed, moments)))
    track = Track(sweeps.steps[box.sweeps], rows, *box.size)
    return tracked(box.id, CATEGORIES[box.category], track)
