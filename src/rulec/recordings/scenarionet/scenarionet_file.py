"""ScenarioNet's scenarios: one pickle each, read as a recording."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from types import MappingProxyType
from typing import NamedTuple

import numpy as np
from numpy import float64, int64
from numpy.typing import NDArray

from rulec.recordings.adjacency import with_untold_neighbours
from rulec.recordings.commonroad.countries import country_at, side_in
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.lane_centres.centre_lanelets import ALL_JUNCTIONS, centre_lanelets
from rulec.recordings.lane_centres.even_steps import even_steps
from rulec.recordings.polylines import wrapped
from rulec.recordings.recording import CROSSWALK, Participant, Recording
from rulec.recordings.scenarionet.data_sets import DataSet, data_set
from rulec.recordings.scenarionet.restricted_pickle import read_pickle
from rulec.recordings.scenarionet.scenario_dictionary import KeyedValue
from rulec.recordings.scenarionet.scenarionet_features import road_features
from rulec.recordings.track import Track, tracked

SCENARIONET = BinaryFormat(
    "a scenario of ScenarioNet's",
    "it is a pickle of one scenario's dictionary, as ScenarioNet's converters write it",
    200_000_000,
)
_PARTS = ("tracks", "map_features", "metadata")

_TYPES: Mapping[str, str] = MappingProxyType(
    {
        "VEHICLE": "vehicle",
        "PEDESTRIAN": "pedestrian",
        "CYCLIST": "bicycle",
        **dict.fromkeys(("TRAFFIC_CONE", "TRAFFIC_BARRIER", "TRAFFIC_OBJECT"), "constructionZone"),
    }
)
_OWN_TYPES: tuple[tuple[str, str], ...] = (
    ("vehicle.car", "car"),
    ("vehicle.truck", "truck"),
    ("vehicle.bus", "bus"),
    ("vehicle.motorcycle", "motorcycle"),
    ("vehicle.bicycle", "bicycle"),
)
"""Prefixes of nuScenes' own categories, which are more specific."""

_BRIDGED_S = 0.55
"""The longest gap (s) in a track across which even motion is assumed: half a second.

At 3 m/s² the position is then wrong by at most 0.1 m.
"""

_CAR_LENGTHS_M = 3.4, 6.0
_CAR_WIDTHS_M = 1.4, 2.5


class _BoxTrack(NamedTuple):
    """A track of boxes, one row each: centre and velocity (x, y), size (length, width)."""

    steps: NDArray[int64]
    centres: NDArray[float64]
    headings: NDArray[float64]
    velocities: NDArray[float64]
    sizes: NDArray[float64]

    def first(self) -> _BoxTrack:
        """The track reduced to its first box."""
        rows = self.centres[:1], self.headings[:1], self.velocities[:1], self.sizes[:1]
        return _BoxTrack(self.steps[:1], *rows)


def read_scenarionet(path: Path) -> Recording:
    """The scenario in a file.

    Raises RulecError R0610 for a file that cannot be read as one, R0701 if it cannot be opened.
    """
    scenario = KeyedValue(read_pickle(path, SCENARIONET), (), path, SCENARIONET)
    if not isinstance(scenario.value, dict) or any(key not in scenario.value for key in _PARTS):
        why = "it is a pickle, but not of a scenario, which has `tracks` and `map_features`"
        help_text = "give a scenario's own file, `sd_*.pkl`, not the summary of a data set"
        raise SCENARIONET.refused(path, why, help_text=help_text)
    metadata = scenario.child("metadata")
    known = data_set(_text(metadata, "dataset"))
    if _text(metadata, "coordinate") == "left-handed":
        raise metadata.wrong("says that its coordinates are left-handed, which are not read")
    form = f"ScenarioNet scenario of {known.title}" if known.title else "ScenarioNet scenario"
    name = _text(scenario, "id") or path.stem
    return with_untold_neighbours(scenario_recording(scenario, known, name, form))


def scenario_recording(scenario: KeyedValue, known: DataSet, name: str, form: str) -> Recording:
    """The recording of a scenario in ScenarioNet's form. Raises RulecError R0610."""
    metadata = scenario.child("metadata")
    country = country_at([_text(metadata, "map")]) or known.country
    times = metadata.get("ts") or metadata.child("timestep")
    step_s, steps = even_steps(times.column(), lambda why: times.wrong(f"is invalid: {why}"))
    ego = _text(metadata, "sdc_id")
    features = road_features(scenario, known, steps.tolist())
    remarks = _Remarks()
    bodies = tuple(_participants(scenario, known, ego, (step_s, steps), remarks))
    if not bodies:
        raise scenario.child("tracks").wrong("contains no road users")
    if ego and ego not in map(str, scenario.child("tracks").value):
        raise metadata.wrong(f"says that ego is `{ego[:40]}`, who is not in `tracks`")
    return Recording(
        name=name,
        step_s=step_s,
        lanelets=centre_lanelets(features, has_lights=known.has_lights or bool(features.lights)),
        participants=bodies,
        form=form,
        side=side_in(country),
        remarks=tuple(remarks.all()),
        country=country,
        complete=ALL_JUNCTIONS | ({"STOP"} if known.whole_map else frozenset()),
        lacks=frozenset() if known.has_crosswalks else frozenset({CROSSWALK}),
        ego=ego if any(body.id == ego for body in bodies) else "",
    )


class _Remarks:
    """Remarks collected while the tracks are read."""

    def __init__(self) -> None:
        self.lines: list[str] = []
        self.bridged = 0

    def all(self) -> Iterator[str]:
        yield from self.lines
        if self.bridged:
            yield (
                "bodies that are lost for half a second or less are assumed to move evenly "
                f"meanwhile: {self.bridged:,} states"
            )


def _text(entry: KeyedValue, key: str) -> str:
    value = entry.get(key)
    return "" if value is None else value.text()


def _participants(
    scenario: KeyedValue,
    known: DataSet,
    ego: str,
    times: tuple[float, NDArray[int64]],
    remarks: _Remarks,
) -> Iterator[Participant]:
    step_s, steps = times
    for name, track in scenario.child("tracks").items():
        boxes = _boxes(track.child("state"), steps)
        if not len(boxes.steps):
            continue
        kind = _kind(track)
        if name == ego:
            boxes = _ego(boxes, known, remarks)
        if kind == "constructionZone":
            yield _participant(name, kind, boxes.first(), step_s, standing=True)
            continue
        whole = _bridged(boxes, step_s)
        remarks.bridged += len(whole.steps) - len(boxes.steps)
        yield _participant(name, kind, whole, step_s)


def _kind(track: KeyedValue) -> str:
    own = track.get("metadata")
    category = None if own is None or not isinstance(own.value, dict) else own.value.get("type")
    for begin, kind in _OWN_TYPES:
        if isinstance(category, str) and category.startswith(begin):
            return kind
    return _TYPES.get(_text(track, "type"), "unknown")


def _boxes(state: KeyedValue, steps: NDArray[int64]) -> _BoxTrack:
    valid = state.child("valid").column() > 0.5
    if len(valid) > len(steps):
        raise state.wrong(f"has {len(valid)} states for {len(steps)} times")

    def rows(key: str) -> NDArray[float64]:
        # What is not valid may be anything, such as NaN
        entry = state.child(key).chosen(valid, "valid")
        return entry.places()[:, :2] if key in ("position", "velocity") else entry.column()

    sizes = np.column_stack((rows("length"), rows("width")))
    if len(sizes) and np.median(sizes, axis=0).min() <= 0:
        raise state.wrong("has a body of no length or width")
    own = steps[: len(valid)][valid]
    return _BoxTrack(own, rows("position"), rows("heading"), rows("velocity"), sizes)


def _ego(boxes: _BoxTrack, known: DataSet, remarks: _Remarks) -> _BoxTrack:
    """Ego with its length along its heading, and with positions moved to its middle."""
    length, width = np.median(boxes.sizes, axis=0).tolist()
    if length < width:
        remarks.lines.append(
            f"ego is {length:g} m long and {width:g} m wide in the file, and taken to be turned"
        )
        boxes = boxes._replace(sizes=boxes.sizes[:, ::-1])
    if known.ego_ahead_m:
        remarks.lines.append(
            f"ego's places are those of its rear axle, {known.ego_ahead_m:.2f} m behind its middle"
        )
        ahead = np.column_stack((np.cos(boxes.headings), np.sin(boxes.headings)))
        boxes = boxes._replace(centres=boxes.centres + known.ego_ahead_m * ahead)
    return boxes


def _bridged(boxes: _BoxTrack, step_s: float) -> _BoxTrack:
    """A track with gaps up to ``_BRIDGED_S`` filled: position, heading and speed change evenly."""
    steps = boxes.steps
    short = (np.diff(steps) > 1) & ((np.diff(steps) - 1) * step_s <= _BRIDGED_S)
    if not short.any():
        return boxes
    starts = np.flatnonzero(short)
    more = [np.arange(steps[start] + 1, steps[start + 1]) for start in starts.tolist()]
    every = np.union1d(steps, np.concatenate(more))
    measured = np.isin(every, steps)

    def filled(values: NDArray[float64]) -> NDArray[float64]:
        columns = [np.interp(every, steps, column) for column in values.T]
        table: NDArray[float64] = np.column_stack(columns)
        # Measured values are kept exactly
        table[measured] = values
        return table

    headings = wrapped(filled(np.unwrap(boxes.headings)[:, None])[:, 0])
    headings[measured] = boxes.headings
    return _BoxTrack(
        every, filled(boxes.centres), headings, filled(boxes.velocities), filled(boxes.sizes)
    )


def _participant(
    name: str, kind: str, boxes: _BoxTrack, step_s: float, *, standing: bool = False
) -> Participant:
    """A participant with a rigid body, whose size is the median of its boxes' sizes.

    A ``vehicle`` of a car's size is read as a car.
    """
    length, width = np.median(boxes.sizes, axis=0).tolist()
    if (
        kind == "vehicle"
        and _is_within(length, _CAR_LENGTHS_M)
        and _is_within(width, _CAR_WIDTHS_M)
    ):
        kind = "car"
    along = np.stack((np.cos(boxes.headings), np.sin(boxes.headings)), axis=1)
    speeds = (boxes.velocities * along).sum(axis=1)
    taken_s = np.diff(boxes.steps, prepend=boxes.steps[0] - 1) * step_s
    gained = np.diff(speeds, prepend=speeds[0]) / taken_s
    rows = np.column_stack((boxes.centres, boxes.headings, speeds, gained))
    return tracked(name, kind, Track(boxes.steps, rows, length, width), standing=standing)


def _is_within(value: float, bounds: tuple[float, float]) -> bool:
    low, high = bounds
    return low <= value <= high
