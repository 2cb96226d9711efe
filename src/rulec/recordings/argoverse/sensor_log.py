"""Sensor logs of Argoverse 2: all participants around ego, sweep by sweep.

According to `av2.structures.cuboid` and `av2.utils.io`, annotations are boxes in ego's frame at the
time of a sweep; the poses of that frame, whose origin is the middle of ego's rear axle, are in the
city's frame, as the map is.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import partial
from pathlib import Path

import numpy as np
from numpy import float64, int64, intp
from numpy.typing import NDArray

from rulec.recordings.argoverse.argoverse_files import ANNOTATIONS, MAP, POSES, map_beside, only_in
from rulec.recordings.argoverse.city_frame import CityPoses, poses_in
from rulec.recordings.argoverse.map_archive import read_map_archive
from rulec.recordings.argoverse.object_types import (
    CATEGORIES,
    EGO_MIDDLE_M,
    EGO_SIZE_M,
    NOT_ON_THE_ROAD,
)
from rulec.recordings.argoverse.sweep_boxes import (
    NANOSECONDS,
    UNITS_PER_SECOND,
    TrackBoxes,
    check_sizes,
    participant,
    with_riders,
)
from rulec.recordings.encodings.arrow.arrow_tables import ArrowTable, Wanted, read_table
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.lane_centres.even_steps import even_steps
from rulec.recordings.recording import Recording
from rulec.trace.plain_arrays import most_frequent

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


@dataclass(frozen=True, eq=False, slots=True)
class _Sweeps:
    """The sweeps with annotations: their times (s), time steps, and ego's poses."""

    seconds: NDArray[float64]
    steps: NDArray[int64]
    poses: CityPoses


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
    seconds = (moments - moments[0]) / NANOSECONDS
    step_s, steps = even_steps(seconds, partial(SENSOR.refused, path), UNITS_PER_SECOND)
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
    others = with_riders([x for x in tracks if x.category != _EGO_CATEGORY])
    if any(x.id == ego.id for x in others):
        raise SENSOR.refused(path, f"somebody else is called `{ego.id}`, as ego is")
    log = _NAME.fullmatch(map_path.name)
    return Recording(
        name=log[1] if log else path.resolve().parent.name,
        step_s=step_s,
        lanelets=road.lanelets,
        participants=tuple(
            participant(x, CATEGORIES[x.category], sweeps.seconds, sweeps.steps)
            for x in (ego, *others)
            if len(x.sweeps)
        ),
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
    quaternions = np.stack([table.numbers[name] for name in _QUATERNION], axis=1)
    places = np.stack([table.numbers[name] for name in _PLACE], axis=1)
    return poses_in(table, np.arange(table.rows), places, quaternions)


def _tracks(table: ArrowTable, sweeps: _Sweeps, sweep_of: NDArray[intp]) -> Iterator[TrackBoxes]:
    sizes = np.stack([table.numbers["length_m"], table.numbers["width_m"]], axis=1)
    check_sizes(table, np.arange(table.rows), sizes)
    names, kinds = table.texts["track_uuid"], table.texts["category"]
    in_city = sweeps.poses.taken(sweep_of).after(_poses(table))
    for name, rows in names.groups(sweep_of):
        category, own = kinds.names[most_frequent(kinds.codes[rows])], sweep_of[rows]
        twice = np.flatnonzero(np.diff(own) == 0)
        if len(twice):
            row = int(rows[twice[0] + 1])
            raise table.refused(row, f"`{short(name)}` is twice in one sweep")
        if category in NOT_ON_THE_ROAD:
            continue
        if category not in CATEGORIES:
            raise table.refused(int(rows[0]), f"`category` is `{short(category)}`")
        length, width = np.median(sizes[rows], axis=0).tolist()
        poses = in_city.taken(rows)
        boxes = TrackBoxes(name, category, own, poses, (length, width))
        points = table.whole.get(_POINTS)
        yield boxes if points is None else boxes.measured(points[rows], sweeps.seconds)


def _ego(name: str, size: tuple[float, float], sweeps: _Sweeps) -> TrackBoxes:
    count = len(sweeps.steps)
    ahead = np.tile([EGO_MIDDLE_M, 0.0, 0.0], (count, 1))
    middle = sweeps.poses.after(CityPoses(np.tile(np.eye(3), (count, 1, 1)), ahead))
    return TrackBoxes(name, _EGO_CATEGORY, np.arange(count), middle, size)
