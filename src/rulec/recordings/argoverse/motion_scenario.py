"""Scenarios of Argoverse 2's motion forecasting.

A table (`scenario_*.parquet`) with a row for each object and time step, and the map next to it.
According to `av2.datasets.motion_forecasting`, a position is the middle of the object's box, a
heading refers to the map's frame, and a velocity is instantaneous.
"""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.recordings.argoverse.argoverse_files import SCENARIO, map_beside, only_in
from rulec.recordings.argoverse.map_archive import read_map_archive
from rulec.recordings.argoverse.object_types import (
    ASSUMED_ERROR,
    EGO_SIZE_M,
    MOTION_TYPES,
    OTHER_SIZE_M,
    USUAL_SIZES_M,
    tracks_in,
)
from rulec.recordings.encodings.arrow.arrow_tables import ArrowTable, Wanted, read_table
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.mending.derived_motion import accelerations_of, along
from rulec.recordings.recording import MOST_STEPS, Participant, Recording
from rulec.recordings.track import Track, tracked

MOTION = FileFormat(
    "a motion forecasting scenario of Argoverse 2",
    "it is `scenario_*.parquet`, as the data set has it",
)

EGO = "AV"
"""The track id of the recording vehicle."""

FORM = "Argoverse 2 motion forecasting"

_STEP_S = 0.1
"""The time step (s): the data set has ten per second."""

_WANTED = Wanted(
    numbers=("position_x", "position_y", "heading", "velocity_x", "velocity_y"),
    whole=("timestep",),
    texts=("track_id", "object_type", "scenario_id"),
    optional=frozenset({"scenario_id"}),
)


def read_motion(path: Path, map_path: Path | None = None) -> Recording:
    """Read a scenario, or the one in a folder, on the given map or the one next to it.

    Raises RulecError R0610 for a file that is not a scenario or has no map, R0701 if a file cannot
    be opened, R0706 without pyarrow.
    """
    path = only_in(path, SCENARIO, MOTION)
    table = read_table(path, MOTION, _WANTED)
    if not table.rows:
        raise MOTION.refused(path, "it contains no road users")
    road = read_map_archive(map_path or map_beside(path, MOTION))
    participants = tuple(_participants(table))
    names = table.texts["scenario_id"].names if "scenario_id" in table.texts else ()
    return Recording(
        name=names[0] if names else path.stem.removeprefix("scenario_"),
        step_s=_STEP_S,
        lanelets=road.lanelets,
        participants=participants,
        form=FORM,
        side=road.side,
        country=road.country,
        remarks=(_REMARK,),
        ego=EGO if any(body.id == EGO for body in participants) else "",
    )


_REMARK = "sizes are not in the file; usual ones are assumed: vehicles are 4.6 m by 1.9 m"


def _participants(table: ArrowTable) -> Iterator[Participant]:
    steps = table.whole["timestep"]
    odd = (steps < 0) | (steps > MOST_STEPS)
    if odd.any():
        row = int(np.argmax(odd))
        raise table.refused(row, f"`timestep` is {steps[row]}", f"0 to {MOST_STEPS:,}")
    states = np.stack([table.numbers[name] for name in _WANTED.numbers], axis=1)
    for name, kind, rows in tracks_in(table, "track_id", "object_type", steps, "time step {}"):
        if kind not in MOTION_TYPES:
            raise table.refused(int(rows[0]), f"`object_type` is `{short(kind)}`")
        yield _participant(name, kind, steps[rows], states[rows])


def _participant(
    name: str, kind: str, steps: NDArray[int64], states: NDArray[float64]
) -> Participant:
    heading, speed = states[:, 2], along(states[:, 3:], states[:, 2])
    gained = accelerations_of(speed, steps.astype(float) * _STEP_S)
    is_ego = name == EGO
    length, width = EGO_SIZE_M if is_ego else USUAL_SIZES_M.get(kind, OTHER_SIZE_M)
    track = Track(steps, np.column_stack((states[:, :2], heading, speed, gained)), length, width)
    if is_ego:
        return tracked(name, "car", track)
    return tracked(name, MOTION_TYPES[kind], track, stated_error=ASSUMED_ERROR)
