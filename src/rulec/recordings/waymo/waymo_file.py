"""Waymo's motion data: files with many scenarios, each read as a recording."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.encodings.tfrecord import TfRecord, tfrecords
from rulec.recordings.encodings.wire_format import WireFile
from rulec.recordings.recording import Recording
from rulec.recordings.scenarionet.data_sets import data_set
from rulec.recordings.scenarionet.scenario_dictionary import KeyedValue
from rulec.recordings.scenarionet.scenarionet_file import scenario_recording
from rulec.recordings.waymo.waymo_content import SCENARIO_ID, scenario_content

WAYMO = BinaryFormat(
    "scenarios of Waymo's Open Motion Dataset",
    "they are the files `*.tfrecord-*` below `scenario/`, not those below `tf_example/`",
    100_000_000,
)


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
        name = _id(file, record)
        if scenario_id not in (None, name):
            return None
        way = (f"record {record.number}",)
        scenario = KeyedValue(scenario_content(file), way, path, WAYMO, place=record.place)
        return scenario_recording(scenario, data_set("waymo"), name, "Waymo scenario")
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
