"""Waymo's motion data: files with many scenarios, each read as a recording."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.tfrecord import TfRecord, tfrecords
from rulec.recordings.encodings.wire_format import WireFile
from rulec.recordings.lane_centres.body_tracks import BoxTrack, bridged, gaps_remark, participant
from rulec.recordings.lane_centres.centre_lanelets import ALL_JUNCTIONS, centre_lanelets
from rulec.recordings.lane_centres.even_steps import even_steps
from rulec.recordings.lane_centres.road_features import RoadFeatures
from rulec.recordings.recording import Participant, Recording
from rulec.recordings.waymo.waymo_features import add_feature, add_lights
from rulec.recordings.waymo.waymo_messages import CheckedMessage, checked
from rulec.recordings.waymo.waymo_tables import SCENARIO, SCENARIO_ID

WAYMO = BinaryFormat(
    "scenarios of Waymo's Open Motion Dataset",
    "they are the files `*.tfrecord-*` below `scenario/`, not those below `tf_example/`",
    100_000_000,
)
MOST_STATES = 2_000_000
"""Limit on the states of a scenario; Waymo's have 200 times 200."""

SIGNS_DRAWN = frozenset({"STOP"})
"""The signs that maps contain: all stop signs, and no others."""

_STATE = ("center_x", "center_y", "heading", "velocity_x", "velocity_y", "length", "width")


def read_waymo(path: Path, scenario_id: str | None = None) -> Iterator[Recording]:
    """The scenarios in a file, or the one with the given id.

    Records after a broken one are still read. Raises RulecError R0610 after the last good record if
    some are broken, R0701 if the file cannot be opened.
    """
    broken: list[RulecError] = []
    for record in tfrecords(path, WAYMO):
        scenario = _read(record, path, scenario_id)
        if isinstance(scenario, RulecError):
            broken.append(scenario)
        elif scenario is not None:
            yield scenario
    if broken:
        raise RulecError(diagnostic for error in broken for diagnostic in error.diagnostics)


def _read(
    record: TfRecord | RulecError, path: Path, scenario_id: str | None
) -> Recording | RulecError | None:
    """The scenario in a record, the error, or None if the scenario has another id."""
    if isinstance(record, RulecError):
        return record
    file = WireFile(record.content, path, WAYMO, record.place)
    try:
        return _scenario(file, record) if scenario_id in (None, _id(file, record)) else None
    except RulecError as error:
        return error


def waymo_ids(path: Path) -> Iterator[str]:
    """The ids of the scenarios in a file, without broken records. Raises RulecError R0701."""
    for record in tfrecords(path, WAYMO):
        if isinstance(record, TfRecord):
            with suppress(RulecError):
                yield _id(WireFile(record.content, path, WAYMO, record.place), record)


def _id(file: WireFile, record: TfRecord) -> str:
    for item in file.fields(SCENARIO_ID):
        return str(item.value)
    raise file.wrong(f"record {record.number} has no `scenario_id`", 0)


@dataclass(slots=True)
class _Body:
    """A track whose states have indices of times; the times themselves are not known yet."""

    id: str
    type: str
    numbers: NDArray[int64]
    rows: NDArray[float64]
    place: int


@dataclass(slots=True)
class _Content:
    times_s: list[float] = field(default_factory=list)
    bodies: list[_Body] = field(default_factory=list)
    lights: int = 0
    sdc: int | None = None
    features: RoadFeatures = field(default_factory=RoadFeatures)
    states: int = 0


def _scenario(file: WireFile, record: TfRecord) -> Recording:
    content = _Content()
    for item in file.fields(SCENARIO):
        match item.field.name, item.value:
            case "timestamps_seconds", float(time):
                content.times_s.append(time)
            case "sdc_track_index", int(index):
                content.sdc = index
            case "tracks", _:
                content.bodies.append(_body(content, checked(item, file)))
            case "dynamic_map_states", _:
                add_lights(content.features, checked(item, file), content.lights)
                content.lights += 1
            case "map_features", _:
                add_feature(content.features, checked(item, file))
    try:
        step_s, steps = even_steps(np.array(content.times_s, dtype=float))
    except ValueError as reason:
        raise file.wrong(f"of record {record.number}, {reason}", 0) from None
    if content.lights > len(steps):
        raise file.wrong(f"record {record.number} has more states of lights than times", 0)
    for light in content.features.lights.values():
        colours = {int(steps[number]): colour for number, colour in light.items()}
        light.clear()
        light.update(colours)
    there = [body for body in content.bodies if len(body.numbers)]
    ids = [body.id for body in content.bodies]
    if len(set(ids)) < len(ids):
        twice = next(name for name in ids if ids.count(name) > 1)
        raise file.wrong(f"record {record.number} has two tracks {short(twice)}", 0)
    if not there:
        raise file.wrong(f"there are no road users in record {record.number}", 0)
    if content.sdc is not None and not 0 <= content.sdc < len(ids):
        raise file.wrong(f"`sdc_track_index` is {content.sdc} of {len(ids)} tracks", 0)
    ego = "" if content.sdc is None else content.bodies[content.sdc].id
    participants = tuple(_participant(body, steps, step_s, file) for body in there)
    states = sum(len(body.states) for body in participants)
    return Recording(
        name=_id(file, record),
        step_s=step_s,
        lanelets=centre_lanelets(content.features, has_lights=True),
        participants=participants,
        form="Waymo scenario",
        side="right",
        remarks=gaps_remark(states - sum(len(body.numbers) for body in there)),
        country="USA",
        complete=SIGNS_DRAWN | ALL_JUNCTIONS,
        ego=ego,
    )


def _body(content: _Content, track: CheckedMessage) -> _Body:
    states = track.messages("states")
    content.states += len(states)
    if content.states > MOST_STATES:
        raise track.wrong(f"there are more than {MOST_STATES:,} states")
    valid = [number for number, state in enumerate(states) if state.is_true("valid")]
    rows = [[states[number].number(name) for name in _STATE] for number in valid]
    table = np.array(rows, dtype=float).reshape(-1, len(_STATE))
    if len(table) and table[:, 5:].min() <= 0:
        raise track.wrong("a body has no length or width")
    return _Body(
        str(track.whole("id")),
        track.word("object_type"),
        np.array(valid, dtype=int64),
        table,
        track.place,
    )


def _participant(body: _Body, steps: NDArray[int64], step_s: float, file: WireFile) -> Participant:
    if body.numbers[-1] >= len(steps):
        raise file.wrong(f"track {body.id} has more states than there are times", body.place)
    rows = body.rows
    boxes = BoxTrack(steps[body.numbers], rows[:, :2], rows[:, 2], rows[:, 3:5], rows[:, 5:])
    return participant(body.id, body.type, bridged(boxes, step_s), step_s)
