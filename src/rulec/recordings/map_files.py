"""Maps of every format, for recordings without roads of their own."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

from rulec.diagnostics import SourceLocation
from rulec.diagnostics.argument_kinds import checked_kinds
from rulec.diagnostics.fault_messages import contained
from rulec.files.read_files import opened
from rulec.recordings import table_heads as heads
from rulec.recordings.argoverse.argoverse_files import MAP as MAP_ARCHIVES
from rulec.recordings.argoverse.argoverse_files import is_named
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.recording_format import Glance, when_called

if TYPE_CHECKING:
    from rulec.recordings.road_map import RoadMap

MAP = FileFormat("a map", "`rulec list formats` lists the maps that are read")


@dataclass(frozen=True, slots=True)
class MapFormat:
    """A format of maps: ``read`` takes the file, and the time step (s) that lights count in."""

    name: str
    title: str
    files: str
    recognises: Callable[[Glance], bool]
    read: Callable[[Path, float], RoadMap]


def _roads(place: str, *, with_lights: bool = False) -> Callable[[Path, float], RoadMap]:
    """The reader of a format, which is told the time step if the format has lights."""

    def read(path: Path, step_s: float) -> RoadMap:
        given = (path, step_s) if with_lights else (path,)
        roads: RoadMap = when_called(place)(*given)
        return roads

    return read


_read_lanes = _roads("lanes.lane_table.read_lane_map")


MAP_FORMATS = (
    MapFormat(
        "sumo",
        "nets of SUMO's",
        "*.net.xml",
        lambda glance: glance.root == "net",
        _roads("sumo.sumo_recording.read_sumo_map", with_lights=True),
    ),
    MapFormat(
        "opendrive",
        "ASAM OpenDRIVE, 1.4 to 1.8",
        "*.xodr",
        lambda glance: glance.root == "OpenDRIVE",
        _roads("opendrive.opendrive_map.read_opendrive_map"),
    ),
    MapFormat(
        "commonroad",
        "the roads of CommonRoad scenarios",
        "*.xml",
        lambda glance: glance.root == "commonRoad",
        _roads("commonroad.commonroad_file.read_commonroad_map", with_lights=True),
    ),
    MapFormat(
        "lanelet2",
        "Lanelet2 maps",
        "*.osm",
        lambda glance: glance.root == "osm",
        _roads("lanelet2.lanelet2_map.read_lanelet2"),
    ),
    MapFormat(
        "lanes",
        "lanes as a table",
        "*.csv, *.parquet",
        lambda glance: heads.is_lane_head(heads.head_of(glance)),
        _read_lanes,
    ),
    MapFormat(
        "argoverse",
        "maps of Argoverse 2",
        MAP_ARCHIVES,
        lambda glance: is_named(glance.path, MAP_ARCHIVES),
        _roads("argoverse.map_archive.read_map_archive"),
    ),
)


@checked_kinds
def read_map(path: str | Path, step_s: float) -> RoadMap:
    """Read a map of any format; its lights count in steps of ``step_s``.

    Raises RulecError R0610 for a file that is no map, R0701 if it cannot be opened.
    """
    path = Path(path)
    with contained("not read", SourceLocation(str(path))):
        return _read_map(path, step_s)


def _read_map(path: Path, step_s: float) -> RoadMap:
    glance = Glance(path)
    for form in MAP_FORMATS:
        if form.recognises(glance):
            return form.read(path, step_s)
    if heads.is_track_head(heads.head_of(glance)):
        why = "it has tracks, and no lanes"
        raise MAP.refused(path, why, help_text="give it as the recording, and its map with --map")
    if glance.name.endswith(heads.TABLES):
        # Nothing else is a table: what it lacks as one of lanes is what is wrong with it.
        _read_lanes(path, step_s)
    with opened(path):
        # A file that is not there, or must not be read, says so by itself.
        why = f"it is XML of `{short(glance.root)}`" if glance.root else "it is of no known format"
    raise MAP.refused(path, why)
