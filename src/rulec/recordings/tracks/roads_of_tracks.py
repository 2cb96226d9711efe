"""The roads that belong to a table of tracks, and the recording of both."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from math import atan2
from pathlib import Path

import numpy as np
import shapely

from rulec.diagnostics import SourceLocation
from rulec.recordings.adjacency import with_untold_neighbours
from rulec.recordings.doubts.road_doubts import NEAR_M, box_of
from rulec.recordings.map_files import read_map
from rulec.recordings.recording import Lanelet, Recording
from rulec.recordings.recording_messages import NET_MISSING
from rulec.recordings.road_map import RoadMap
from rulec.recordings.tracks.participants_of_rows import HeadingAt, read_tracks
from rulec.recordings.tracks.track_rows import TrackRows

_LANES = (".csv", ".parquet")


def lanes_beside(path: Path) -> list[Path]:
    """The tables of lanes that belong to a table of tracks by their names."""
    stem = path.name.removesuffix(".gz").rpartition(".")[0]
    named = [path.with_name(f"{stem}.lanes{end}") for end in _LANES]
    return [*named, *(path.with_name(f"lanes{end}") for end in _LANES)]


def _usual(beside: Sequence[Path]) -> list[Path]:
    """The first two of these names, to be suggested when there is no map."""
    return [file for file in beside if file.suffix != ".parquet"][:2]


def roads_of(path: Path, map_path: Path | None, step_s: float, beside: Sequence[Path]) -> RoadMap:
    """The given map, or the first existing one of those beside.

    Raises RulecError R0614 if there is none, else as ``read_map``.
    """
    roads = map_path or next((file for file in beside if file.is_file()), None)
    if roads is None:
        names = " or ".join(f"`{file.name}`" for file in _usual(beside))
        raise NET_MISSING.error(
            SourceLocation(str(path)),
            f"`{path.name}` has tracks, but no roads",
            help="give a map with --map: OpenDRIVE, Lanelet2, a net of SUMO's, or a table with the "
            f"columns `lane`, `x`, `y`{f'; {names} beside it would be found' if names else ''}",
        )
    return read_map(roads, step_s)


def _heading_on(lanelets: Iterable[Lanelet]) -> HeadingAt:
    """The direction (rad) of the nearest lanelet at a place; 0 without any lanelets."""
    middles = [shapely.LineString(lanelet.centre) for lanelet in lanelets]
    tree = shapely.STRtree(middles)

    def heading_at(x: float, y: float) -> float:
        nearest = tree.nearest(shapely.Point(x, y))
        if nearest is None:
            return 0.0
        line = middles[int(nearest)]
        at = line.project(shapely.Point(x, y))
        reach = min(1.0, line.length / 2)
        start = line.interpolate(max(0.0, at - reach))
        end = line.interpolate(min(line.length, at + reach))
        return atan2(end.y - start.y, end.x - start.x)

    return heading_at


def track_recording(
    name: str,
    tables: Sequence[TrackRows],
    roads: RoadMap,
    *,
    form: str,
    remarks: Iterable[str] = (),
) -> Recording:
    """The recording of the rows of one or more tables, in the same time steps, on roads.

    Raises RulecError R0610 for a row that makes no sense.
    """
    heading_at = _heading_on(roads.lanelets.values())
    tracks = [read_tracks(rows, heading_at) for rows in tables]
    of_tracks = [remark for part in tracks for remark in part.remarks]
    recording = Recording(
        name=name,
        step_s=tables[0].times.step_s,
        lanelets=roads.lanelets,
        participants=tuple(participant for part in tracks for participant in part.participants),
        form=form,
        side=roads.side,
        remarks=tuple(dict.fromkeys(filter(None, (*remarks, *of_tracks, *roads.remarks)))),
        country=roads.country,
        complete=roads.complete,
        ego=next((part.ego for part in tracks if part.ego), ""),
    )
    return with_untold_neighbours(recording)


def shifted_to_roads(rows: TrackRows, roads: RoadMap, offset: tuple[float, float]) -> TrackRows:
    """The rows, moved by the offset of their frame if only that brings them to the roads."""
    lanelets = roads.lanelets.values()
    if not lanelets or offset == (0.0, 0.0) or _reach(rows, lanelets) <= NEAR_M:
        return rows
    moved = replace(rows, x=rows.x + offset[0], y=rows.y + offset[1])
    return moved if _reach(moved, lanelets) <= NEAR_M else rows


def _reach(rows: TrackRows, lanelets: Iterable[Lanelet]) -> float:
    """The distance of the nearest participant from the bounding box of the roads (m)."""
    low, high = box_of([lanelet.centre for lanelet in lanelets])
    places = np.column_stack((rows.x, rows.y))
    beyond = np.maximum(np.maximum(low - places, places - high), 0.0)
    return float(np.hypot(*beyond.T).min())
