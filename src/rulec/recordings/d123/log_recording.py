"""Logs of 123D as recordings.

According to the writers of py123d 0.7, boxes and ego's poses are in the frame of the map (m);
vectors are x, y, z and a quaternion (w, x, y, z), for boxes also length, width and height. Each
modality has its own times (µs).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.recordings.adjacency import with_untold_neighbours
from rulec.recordings.argoverse.city_frame import CityPoses, poses_in, rotations
from rulec.recordings.argoverse.sweep_boxes import (
    NANOSECONDS,
    UNITS_PER_SECOND,
    TrackBoxes,
    check_sizes,
    participant,
    with_riders,
)
from rulec.recordings.commonroad.countries import side_in
from rulec.recordings.d123 import log_files as files
from rulec.recordings.d123.log_files import LOG
from rulec.recordings.d123.map_lanes import read_d123_map, with_lights
from rulec.recordings.d123.object_labels import LABELS, LEFT_OUT, type_of
from rulec.recordings.encodings.arrow.arrow_tables import ArrowTable, Wanted, read_table
from rulec.recordings.encodings.arrow.nested_columns import Nested
from rulec.recordings.encodings.file_values import LARGEST, short
from rulec.recordings.lane_centres.even_steps import even_steps
from rulec.recordings.recording import Participant, Recording
from rulec.trace.plain_arrays import most_frequent

EGO = "ego"
"""The id of ego, which has no box."""

_MICROSECOND_NS = 1000
_POSE, _BOX = 7, 10
_FARTHEST_S = 0.5
"""Ego's pose is known at times at most this far (s) from a recorded pose."""

_COLOURS = {0: "green", 1: "yellow", 2: "red", 3: "inactive"}
"""States of lights by number; a light may also be unknown."""

_SOURCES = (("av2", "Argoverse 2"), ("wod", "Waymo"))
"""Name prefix and title of the data sets whose position errors are known better than others'."""


@dataclass(frozen=True, eq=False, slots=True)
class _Sweeps:
    """The times of boxes: in ns, in seconds since the first, and as time steps."""

    moments: NDArray[int64]
    seconds: NDArray[float64]
    steps: NDArray[int64]
    step_s: float


def read_d123(path: Path, map_path: Path | None = None) -> Recording:
    """Read a log from its ``sync.arrow`` or its folder, on the given map or its own.

    Raises RulecError R0610 for a file that is not a log, R0614 without a map, R0701 if a file
    cannot be opened, R0706 without pyarrow, and as reading the map does.
    """
    path = path / files.SYNC if path.is_dir() else path
    about = files.said_in(read_table(path, LOG, Wanted(whole=("sync.timestamp_us",))))
    data_set, place = files.word(about, "dataset"), files.word(about, "location")
    boxes = _table(
        path.with_name(files.BOXES),
        Nested(name="bounding_box_se3", kind="number", listed=True, width=_BOX),
        Nested(name="label", kind="whole", listed=True),
        Nested(name="track_token", kind="text", listed=True),
    )
    key = _key(boxes)
    moments = boxes.whole[f"{key}.timestamp_us"] * _MICROSECOND_NS
    if (np.diff(moments) <= 0).any() or not len(moments):
        raise LOG.refused(boxes.path, "its moments are not in ascending order")
    seconds = (moments - moments[0]) / NANOSECONDS
    step_s, steps = even_steps(seconds, partial(LOG.refused, boxes.path), UNITS_PER_SECOND)
    sweeps = _Sweeps(moments, seconds, steps, step_s)
    own = _ego(path.with_name(files.EGO), sweeps)
    others = with_riders(list(_tracks(boxes, files.said_in(boxes))))
    if any(x.id == own.id for x in others):
        raise LOG.refused(boxes.path, f"somebody else is called `{own.id}`, as ego is")
    road = read_d123_map(map_path or files.map_of(path, data_set, place))
    lights = _lights(path.with_name(files.LIGHTS), sweeps)
    country = files.country_of(data_set, place)
    recording = Recording(
        name=files.word(about, "log_name") or path.resolve().parent.name,
        step_s=sweeps.step_s,
        lanelets=with_lights(road.lanelets, lights),
        participants=tuple(_participants([own, *others], sweeps)),
        form=_form(data_set),
        side=road.side or side_in(country),
        country=road.country or country,
        complete=road.complete,
        remarks=road.remarks,
        ego=own.id,
    )
    return with_untold_neighbours(recording)


def _form(data_set: str) -> str:
    for begin, title in _SOURCES:
        if data_set.lower().startswith(begin):
            return f"123D log of {title}"
    return "123D log"


def _participants(tracks: list[TrackBoxes], sweeps: _Sweeps) -> Iterator[Participant]:
    for boxes in tracks:
        if len(boxes.sweeps):
            yield participant(boxes, type_of(boxes.category), sweeps.seconds, sweeps.steps)


def _table(path: Path, *nested: Nested) -> ArrowTable:
    """A modality's file, whose columns begin with its name. Raises RulecError R0610, R0701."""
    if not path.is_file():
        raise LOG.refused(path.with_name(files.SYNC), f"there is no `{path.name}` beside it")
    key = path.name.partition(".")[0]
    named = tuple([replace(column, name=f"{key}.{column.name}") for column in nested])
    return read_table(path, LOG, Wanted(whole=(f"{key}.timestamp_us",), nested=named))


def _key(table: ArrowTable) -> str:
    return table.path.name.partition(".")[0]


def _tracks(table: ArrowTable, about: Mapping[Any, Any]) -> Iterator[TrackBoxes]:
    key = _key(table)
    scheme = files.word(about, "box_detection_label_class").rpartition(".")[2]
    if scheme not in LABELS:
        why = f"its labels are those of `{short(scheme)}`"
        raise LOG.refused(table.path, why, expected=f"expected one of {', '.join(LABELS)}")
    boxes, labels, tokens = (
        table.nested[f"{key}.{name}"] for name in ("bounding_box_se3", "label", "track_token")
    )
    if not (
        np.array_equal(boxes.starts, labels.starts) and np.array_equal(boxes.starts, tokens.starts)
    ):
        raise LOG.refused(table.path, "it has not as many labels and tracks as boxes")
    sweep_of, values = boxes.row_of, boxes.values
    sizes = values[:, 7:9]
    check_sizes(table, sweep_of, sizes)
    poses = poses_in(table, sweep_of, values[:, :3], values[:, 3:7])
    for name, rows in tokens.values.groups(sweep_of):
        own, label = sweep_of[rows], most_frequent(labels.values[rows])
        twice = np.flatnonzero(np.diff(own) == 0)
        if len(twice):
            row = int(own[twice[0]])
            raise table.refused(row, f"`{short(name)}` is twice in one moment")
        if label not in LABELS[scheme]:
            raise table.refused(int(own[0]), f"a label is {label}, which `{scheme}` has not")
        category = LABELS[scheme][label]
        if category != LEFT_OUT:
            length, width = np.median(sizes[rows], axis=0).tolist()
            yield TrackBoxes(name, category, own, poses.taken(rows), (length, width))


def _ego(path: Path, sweeps: _Sweeps) -> TrackBoxes:
    """Ego's body at the times of boxes, interpolated between its recorded states."""
    table = _table(path, Nested(name="imu_se3", kind="number", width=_POSE))
    key, about = _key(table), files.said_in(table)
    size = _number(table, about.get("length")), _number(table, about.get("width"))
    middle = about.get("center_to_imu_se3")
    if not isinstance(middle, list) or len(middle) != _POSE:
        raise LOG.refused(path, "it does not say where ego's middle is (`center_to_imu_se3`)")
    ahead = np.array([[_number(table, value, least=-LARGEST) for value in middle]])
    # Poses less than a microsecond apart have the same time
    moments, rows = np.unique(table.whole[f"{key}.timestamp_us"], return_index=True)
    if not len(moments):
        raise LOG.refused(path, "there is no pose in it")
    moments = moments * _MICROSECOND_NS
    values = table.nested[f"{key}.imu_se3"].values[rows]
    ahead = np.repeat(ahead, len(values), axis=0)
    centre, body = (poses_in(table, rows, x[:, :3], x[:, 3:7]) for x in (ahead, values))
    body = body.after(centre)
    at = np.searchsorted(moments, sweeps.moments)
    before, after = moments[np.maximum(at - 1, 0)], moments[np.minimum(at, len(moments) - 1)]
    near = np.minimum(np.abs(sweeps.moments - before), np.abs(after - sweeps.moments))
    there = np.flatnonzero(near <= _FARTHEST_S * NANOSECONDS)
    wanted, known = ((x - moments[0]).astype(float) for x in (sweeps.moments[there], moments))
    places = np.column_stack([np.interp(wanted, known, body.translations[:, k]) for k in range(3)])
    turned = np.interp(wanted, known, np.unwrap(body.headings))
    zero = np.zeros_like(turned)
    flat = rotations(np.column_stack((np.cos(turned / 2), zero, zero, np.sin(turned / 2))))
    return TrackBoxes(EGO, "car", there, CityPoses(flat, places), size)


def _number(table: ArrowTable, value: object, least: float = 0.0) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not least < value < LARGEST:
        raise LOG.refused(table.path, "its `metadata` do not say ego's length, width and middle")
    return float(value)


def _lights(path: Path, sweeps: _Sweeps) -> dict[str, dict[int, str]]:
    """Lane -> time step -> state of its light, from the last record up to that time."""
    if not path.is_file():
        return {}
    table = _table(
        path, *(Nested(name=name, kind="whole", listed=True) for name in ("lane_id", "status"))
    )
    key = _key(table)
    lanes, shown = (table.nested[f"{key}.{name}"] for name in ("lane_id", "status"))
    if not np.array_equal(lanes.starts, shown.starts):
        raise LOG.refused(path, "it has not as many lights as lanes")
    moments = table.whole[f"{key}.timestamp_us"] * _MICROSECOND_NS
    if (np.diff(moments) <= 0).any():
        raise LOG.refused(path, "its moments are not in ascending order")
    half = round(sweeps.step_s * NANOSECONDS / 2)
    colours_of: dict[str, dict[int, str]] = {}
    latest = np.searchsorted(moments, sweeps.moments, side="right") - 1
    for step, row, moment in zip(
        sweeps.steps.tolist(), latest.tolist(), sweeps.moments.tolist(), strict=True
    ):
        if row < 0 or moment - int(moments[row]) > half:
            continue
        part = slice(lanes.starts[row], lanes.starts[row + 1])
        for lane, status in zip(
            lanes.values[part].tolist(), shown.values[part].tolist(), strict=True
        ):
            own = colours_of.setdefault(str(lane), {})
            if status in _COLOURS:
                own[step] = _COLOURS[status]
    return colours_of
