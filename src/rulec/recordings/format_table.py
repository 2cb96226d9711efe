"""All formats of recorded traffic, in the order in which files are looked at."""

from __future__ import annotations

from typing import TYPE_CHECKING

from rulec.recordings.recording_format import Glance, RecordingFormat, RecordingSource

if TYPE_CHECKING:
    from collections.abc import Iterator
    from pathlib import Path

    from rulec.recordings.recording import Recording


def _commonroad(source: RecordingSource) -> Iterator[Recording]:
    # NumPy and Shapely take a while, and few commands read recordings.
    from rulec.recordings.commonroad.commonroad_file import read_commonroad

    yield read_commonroad(source.path)


def _commonroad_protobuf(source: RecordingSource) -> Iterator[Recording]:
    # As above.
    from rulec.recordings.commonroad.commonroad_protobuf import read_protobuf

    yield read_protobuf(source.path)


def _sumo(source: RecordingSource) -> Iterator[Recording]:
    # As above.
    from rulec.recordings.sumo.sumo_recording import read_sumo

    yield read_sumo(source.path, source.map_path)


def _waymo(source: RecordingSource) -> Iterator[Recording]:
    # As above.
    from rulec.recordings.waymo.waymo_file import read_waymo

    return read_waymo(source.path, source.scenario_id)


def _waymo_ids(path: Path) -> Iterator[str]:
    # As above.
    from rulec.recordings.waymo.waymo_file import waymo_ids

    return waymo_ids(path)


def _is_waymo(glance: Glance) -> bool:
    return ".tfrecord" in glance.name


def _is_protobuf(glance: Glance) -> bool:
    return glance.name.endswith(".pb")


FORMATS = (
    RecordingFormat(
        name="commonroad",
        title="CommonRoad scenarios, 2018b and 2020a",
        files="*.xml",
        recognises=lambda glance: glance.root == "commonRoad",
        read=_commonroad,
    ),
    RecordingFormat(
        name="commonroad-protobuf",
        title="CommonRoad scenarios in Protocol Buffers",
        files="*.pb, their parts beside each other",
        recognises=_is_protobuf,
        read=_commonroad_protobuf,
    ),
    RecordingFormat(
        name="sumo",
        title="SUMO's floating-car data, with their net",
        files="*.xml",
        recognises=lambda glance: glance.root == "fcd-export",
        read=_sumo,
        takes_map=True,
    ),
    RecordingFormat(
        name="waymo",
        title="scenarios of Waymo's Open Motion Dataset",
        files="*.tfrecord, *.tfrecord-00000-of-01000",
        recognises=_is_waymo,
        read=_waymo,
        names=_waymo_ids,
    ),
)
