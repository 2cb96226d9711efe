"""The coordinate frame of a map: metres given in the file, or a projection of its degrees.

The first of these that applies:

1. ``map_projector_info.yaml`` beside the map gives it, as for Autoware;
2. nodes have ``local_x`` and ``local_y``, as in Autoware's maps;
3. all nodes lie within a degree of latitude 0, longitude 0, in the open sea: the origin is there,
   with Lanelet2's ``UtmProjector(Origin(0, 0))``, as in INTERACTION;
4. otherwise, UTM's easting and northing in the zone of the file's first node.
"""

from __future__ import annotations

from collections.abc import Callable
from math import isfinite, nan
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.files.read_files import opened
from rulec.recordings.encodings.file_values import LARGEST, number_in, short
from rulec.recordings.lanelet2 import projections
from rulec.recordings.lanelet2.osm_file import LANELET2, OsmFile
from rulec.recordings.recording import Points

PROJECTOR_INFO = "map_projector_info.yaml"

_LARGEST_BYTES = 50_000
_AT_SEA_DEG = 1.0
_FAR_DEG = 10.0
"""Nodes farther than this from the central meridian of the frame are errors."""

_SQUARE_M = 100_000.0

_Project = Callable[[NDArray[float64], NDArray[float64]], Points]


class ProjectorInfo(NamedTuple):
    """The content of a projector's file; NaN for missing numbers."""

    kind: str = ""
    lat: float = nan
    lon: float = nan
    scale: float = projections.UTM_SCALE


class MapPlaces(NamedTuple):
    """The positions of all nodes (m), and a remark on their frame, or empty."""

    points: Points
    remark: str


def places_of(file: OsmFile) -> MapPlaces:
    """The positions of a file's nodes. Raises RulecError R0610 if one is missing or far away."""
    info = read_projector_info(file.path.with_name(PROJECTOR_INFO))
    columns = [(node.local_x, node.local_y, node.lat, node.lon) for node in file.nodes]
    values = np.array(columns, dtype=float64).reshape(-1, 4)
    local, degrees = values[:, :2], values[:, 2:]
    local_only = info.kind == "local"
    if local_only or (not info.kind and len(values) and np.isfinite(local).all()):
        _check_all(file, local, "has no `local_x` and `local_y`")
        return MapPlaces(local, "")
    _check_all(file, degrees, "has no `lat` and `lon`")
    if not len(values):
        return MapPlaces(local, "")
    lat, lon = degrees[:, 0], degrees[:, 1]
    outside = (lat >= projections.MOST_NORTH_DEG) | (lat < projections.MOST_SOUTH_DEG)
    _check_none(file, outside, "is nearer to a pole than UTM reaches")
    project, meridian, remark = _projection(info, float(lat[0]), float(lon[0]), degrees)
    away: NDArray[float64] = np.abs((lon - meridian + 180.0) % 360.0 - 180.0)
    _check_none(
        file, np.asarray(away > _FAR_DEG), f"is more than {_FAR_DEG:g}° from the middle of the map"
    )
    return MapPlaces(project(lat, lon), remark)


def _projection(
    info: ProjectorInfo, lat: float, lon: float, degrees: NDArray[float64]
) -> tuple[_Project, float, str]:
    """The projection, its central meridian, and a remark; the first node may decide the zone."""
    if info.kind in ("localcartesian", "transversemercator"):
        origin = info.lat, info.lon
        if info.kind == "localcartesian":
            return lambda x, y: projections.local_tangent(x, y, origin), info.lon, ""

        def mercator(x: NDArray[float64], y: NDArray[float64]) -> Points:
            all_x, all_y = np.append(x, info.lat), np.append(y, info.lon)
            whole = projections.transverse_mercator(all_x, all_y, info.lon, info.scale)
            places: Points = whole[:-1] - whole[-1]
            return places

        return mercator, info.lon, ""
    remark = ""
    at_sea = bool((np.abs(degrees) < _AT_SEA_DEG).all())
    if info.kind == "localcartesianutm":
        lat, lon = info.lat, info.lon
    elif not info.kind and at_sea:
        lat, lon = 0.0, 0.0
    zone, south = projections.utm_zone(lat, lon), lat < 0
    first = projections.utm(np.array([lat]), np.array([lon]), zone, south=south)[0]
    offset = np.zeros(2)
    if info.kind == "mgrs":
        offset = np.floor(first / _SQUARE_M) * _SQUARE_M
    elif info.kind or at_sea:
        offset = first
    else:
        half = "south" if south else "north"
        remark = f"the map has no origin: positions are in UTM zone {zone} {half}"

    def easting_northing(x: NDArray[float64], y: NDArray[float64]) -> Points:
        places: Points = projections.utm(x, y, zone, south=south) - offset
        return places

    return easting_northing, projections.utm_meridian(zone), remark


def _check_all(file: OsmFile, values: NDArray[float64], why: str) -> None:
    known: NDArray[np.bool_] = np.isfinite(values)
    _check_none(file, np.asarray(~known.all(axis=1)), why)


def _check_none(file: OsmFile, wrong: NDArray[np.bool_], why: str) -> None:
    if wrong.any():
        raise file.refused(f"a node {why}", file.nodes[int(wrong.argmax())].place)


_KINDS = ("local", "mgrs", "localcartesianutm", "localcartesian", "transversemercator")
_WITH_ORIGIN = _KINDS[2:]


def read_projector_info(path: Path) -> ProjectorInfo:
    """The content of Autoware's file on a map's projection; empty if there is no such file.

    Its form is described at https://autowarefoundation.github.io/autoware_core/main/map/
    autoware_map_projection_loader: keys and values, with the origin below ``map_origin``. Raises
    RulecError R0610 for another kind of projector, or a missing origin.
    """
    if not path.is_file():
        return ProjectorInfo()
    with opened(path) as stream:
        text = stream.read(_LARGEST_BYTES).decode(errors="replace")
    pairs = (line.partition("#")[0].partition(":") for line in text.splitlines())
    info = {key.strip(): value.strip().strip("\"'") for key, _, value in pairs}
    kind = info.get("projector_type", "").lower()
    if kind not in _KINDS:
        why = f"its `projector_type` is `{short(kind)}`"
        raise LANELET2.refused(path, why, expected=f"expected one of {', '.join(_KINDS)}")
    lat, lon = (_number(path, info, key, nan) for key in ("latitude", "longitude"))
    if kind in _WITH_ORIGIN and not (abs(lat) <= projections.MOST_NORTH_DEG and abs(lon) <= 360):
        raise LANELET2.refused(path, "it has no `map_origin` with `latitude` and `longitude`")
    return ProjectorInfo(kind, lat, lon, _number(path, info, "scale_factor", projections.UTM_SCALE))


def _number(path: Path, info: dict[str, str], key: str, default: float) -> float:
    if not info.get(key):
        return default
    try:
        value = number_in(info[key])
    except ValueError:
        value = nan
    if not (isfinite(value) and abs(value) < LARGEST):
        raise LANELET2.refused(path, f"its `{key}` is `{short(info[key])}`, which is not a number")
    return value
