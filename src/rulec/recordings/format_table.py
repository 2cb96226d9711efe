"""All formats of recorded traffic, in the order in which files are looked at."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from glob import escape
from typing import TYPE_CHECKING

from rulec.recordings import table_heads as heads
from rulec.recordings.argoverse.argoverse_files import ANNOTATIONS, SCENARIO, is_named
from rulec.recordings.recording_format import Glance, RecordingFormat, RecordingSource, when_called

if TYPE_CHECKING:
    from rulec.recordings.recording import Recording


def _reading(place: str, *given: str) -> Callable[[RecordingSource], Iterator[Recording]]:
    """The reader of a format whose function takes the ``given`` fields of a source.

    It gives the only recording of a file, or one after the other.
    """

    def read(source: RecordingSource) -> Iterator[Recording]:
        found = when_called(place)(*(getattr(source, field) for field in given))
        yield from found if isinstance(found, Iterator) else (found,)

    return read


def _is_part(glance: Glance) -> bool:
    """True for the map of a scenario in parts, and for its planning problems."""
    path, stem = glance.path, glance.path.name[: glance.name.rindex(".pb")]
    traffic = stem[: -len("-SC")] + path.name[len(stem) :]
    if stem.endswith("-SC") and path.with_name(traffic).is_file():
        return True
    return any(path.parent.glob(f"{escape(stem)}_*.pb*"))


def _is_about_tracks(glance: Glance) -> bool:
    """True for what is said of a recording of levelX's, and of its tracks, in files beside it."""
    number, _, content = glance.path.name.partition("_")
    if not content.lower().startswith(("tracksmeta.csv", "recordingmeta.csv")):
        return False
    return any(glance.path.parent.glob(f"{escape(number)}_tracks.csv*"))


def _is_beside_vehicles(glance: Glance) -> bool:
    """True for people on foot whose vehicles are in another file of INTERACTION's."""
    name = glance.path.name.replace("pedestrian_tracks_", "vehicle_tracks_")
    return name != glance.path.name and glance.path.with_name(name).is_file()


FORMATS = (
    RecordingFormat(
        name="commonroad",
        title="CommonRoad scenarios, 2018b and 2020a",
        files="*.xml",
        recognises=lambda glance: glance.root == "commonRoad",
        read=_reading("commonroad.commonroad_file.read_commonroad", "path"),
    ),
    RecordingFormat(
        name="commonroad-protobuf",
        title="CommonRoad scenarios in Protocol Buffers",
        files="*.pb, their parts beside each other",
        recognises=lambda glance: glance.name.endswith(".pb"),
        is_companion=_is_part,
        read=_reading("commonroad.commonroad_protobuf.read_protobuf", "path"),
    ),
    RecordingFormat(
        name="sumo",
        title="SUMO's floating-car data, with their net",
        files="*.xml, *.csv, *.parquet",
        recognises=lambda glance: (
            glance.root == "fcd-export" or heads.is_fcd_head(heads.head_of(glance))
        ),
        read=_reading("sumo.sumo_recording.read_sumo", "path", "map_path"),
        roads="beside it, or --map",
    ),
    RecordingFormat(
        name="argoverse-motion",
        title="Argoverse 2's motion forecasting, with the map beside it",
        files="scenario_*.parquet, or its folder",
        recognises=lambda glance: is_named(glance.path, SCENARIO),
        read=_reading("argoverse.motion_scenario.read_motion", "path", "map_path"),
        roads="beside it, or --map",
    ),
    RecordingFormat(
        name="argoverse-sensor",
        title="Argoverse 2's sensor logs, with poses and map beside them",
        files="annotations*.feather, or its folder",
        recognises=lambda glance: is_named(glance.path, ANNOTATIONS),
        read=_reading("argoverse.sensor_log.read_sensor_log", "path", "map_path"),
        roads="beside it, or --map",
    ),
    RecordingFormat(
        name="waymo",
        title="scenarios of Waymo's Open Motion Dataset",
        files="*.tfrecord, *.tfrecord-00000-of-01000",
        recognises=lambda glance: ".tfrecord" in glance.name,
        read=_reading("waymo.waymo_file.read_waymo", "path", "scenario_id"),
        names=when_called("waymo.waymo_file.waymo_ids"),
    ),
    RecordingFormat(
        name="highd",
        title="highD",
        files="*_tracks.csv, with *_tracksMeta.csv and *_recordingMeta.csv",
        recognises=lambda glance: heads.has_columns(heads.head_of(glance), heads.HIGHD),
        read=when_called("tracks.levelx.read_highd"),
        is_companion=_is_about_tracks,
    ),
    RecordingFormat(
        name="levelx",
        title="inD, rounD, exiD and uniD, on their maps",
        files="*_tracks.csv, with *_tracksMeta.csv and *_recordingMeta.csv",
        recognises=lambda glance: heads.has_columns(heads.head_of(glance), heads.LEVELX),
        read=when_called("tracks.levelx.read_levelx"),
        roads="with --map",
        is_companion=_is_about_tracks,
    ),
    RecordingFormat(
        name="interaction",
        title="INTERACTION, on its maps",
        files="vehicle_tracks_*.csv, pedestrian_tracks_*.csv",
        recognises=lambda glance: heads.has_columns(heads.head_of(glance), heads.INTERACTION),
        read=when_called("tracks.interaction.read_interaction"),
        roads="beside it, or --map",
        is_companion=_is_beside_vehicles,
    ),
    RecordingFormat(
        name="ngsim",
        title="NGSIM's trajectories, on lanes as a table",
        files="trajectories-*.txt, *.csv",
        recognises=lambda glance: heads.is_ngsim_head(heads.head_of(glance)),
        read=when_called("tracks.ngsim.read_ngsim"),
        roads="beside it, or --map",
    ),
    RecordingFormat(
        name="omega-prime",
        title="tracks in OMEGA-PRIME's columns, on any map",
        files="*.csv, *.parquet",
        recognises=lambda glance: heads.has_columns(heads.head_of(glance), heads.OMEGA_PRIME),
        read=when_called("tracks.omega_prime.read_omega_prime"),
        roads="beside it, or --map",
    ),
    RecordingFormat(
        name="tracks",
        title="tracks as a table, on any map",
        files="*.csv, *.parquet",
        recognises=lambda glance: heads.is_track_head(heads.head_of(glance)),
        read=when_called("tracks.track_table.read_track_table"),
        roads="beside it, or --map",
    ),
    RecordingFormat(
        name="osi",
        title="ASAM OSI traces",
        files="*.osi, *.mcap",
        recognises=lambda glance: (
            glance.name.endswith((".osi", ".mcap")) or glance.head.startswith(b"\x89MCAP0\r\n")
        ),
        read=_reading("osi.osi_recording.read_osi", "path", "map_path"),
        roads="its own, or --map",
    ),
    RecordingFormat(
        name="scenarionet",
        title="scenarios of ScenarioNet's: Waymo, nuScenes, nuPlan and others in one form",
        files="*.pkl",
        recognises=lambda glance: glance.name.endswith((".pkl", ".pickle")),
        read=_reading("scenarionet.scenarionet_file.read_scenarionet", "path"),
    ),
)
