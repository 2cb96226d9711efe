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
from math import floor, isfinite, nan
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.files.read_files import opened
from rulec.recordings.encodings.file_values import LARGEST, number_in, short
from rulec.recordings.lanelet2.osm_file import LANELET2, OsmFile
from rulec.recordings.recording import Points

PROJECTOR_INFO = "map_projector_info.yaml"

_LARGEST_BYTES = 50_000
_AT_SEA_DEG = 1.0
_FAR_DEG = 10.0
"""Nodes farther than this from the central meridian of the frame are errors."""

_SQUARE_M = 100_000.0

UTM_SCALE = 0.9996

_Project = Callable[[NDArray[float64], NDArray[float64]], Points]


class ProjectorInfo(NamedTuple):
    """The content of a projector's file; NaN for missing numbers."""

    kind: str = ""
    lat: float = nan
    lon: float = nan
    scale: float = UTM_SCALE


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
    outside = (lat >= MOST_NORTH_DEG) | (lat < MOST_SOUTH_DEG)
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
            return lambda x, y: local_tangent(x, y, origin), info.lon, ""

        def mercator(x: NDArray[float64], y: NDArray[float64]) -> Points:
            all_x, all_y = np.append(x, info.lat), np.append(y, info.lon)
            whole = transverse_mercator(all_x, all_y, info.lon, info.scale)
            places: Points = whole[:-1] - whole[-1]
            return places

        return mercator, info.lon, ""
    remark = ""
    at_sea = bool((np.abs(degrees) < _AT_SEA_DEG).all())
    if info.kind == "localcartesianutm":
        lat, lon = info.lat, info.lon
    elif not info.kind and at_sea:
        lat, lon = 0.0, 0.0
    zone, south = utm_zone(lat, lon), lat < 0
    first = utm(np.array([lat]), np.array([lon]), zone, south=south)[0]
    offset = np.zeros(2)
    if info.kind == "mgrs":
        offset = np.floor(first / _SQUARE_M) * _SQUARE_M
    elif info.kind or at_sea:
        offset = first
    else:
        half = "south" if south else "north"
        remark = f"the map has no origin: positions are in UTM zone {zone} {half}"

    def easting_northing(x: NDArray[float64], y: NDArray[float64]) -> Points:
        places: Points = utm(x, y, zone, south=south) - offset
        return places

    return easting_northing, utm_meridian(zone), remark


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
    if kind in _WITH_ORIGIN and not (abs(lat) <= MOST_NORTH_DEG and abs(lon) <= 360):
        raise LANELET2.refused(path, "it has no `map_origin` with `latitude` and `longitude`")
    return ProjectorInfo(kind, lat, lon, _number(path, info, "scale_factor", UTM_SCALE))


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


UTM_EAST_M, UTM_SOUTH_M = 500_000.0, 10_000_000.0
"""What UTM adds to the easting, and to the northing in the southern hemisphere."""

MOST_NORTH_DEG, MOST_SOUTH_DEG = 84.0, -80.0
"""The latitudes between which UTM is defined."""

_AXIS_M, _FLATTENING = 6_378_137.0, 1 / 298.257223563
_N = _FLATTENING / (2 - _FLATTENING)
_SQUARED = _FLATTENING * (2 - _FLATTENING)
_RADIUS_M = _AXIS_M / (1 + _N) * (1 + _N**2 / 4 + _N**4 / 64 + _N**6 / 256)
_SERIES = (
    (1 / 2, -2 / 3, 5 / 16, 41 / 180, -127 / 288, 7891 / 37800),
    (0, 13 / 48, -3 / 5, 557 / 1440, 281 / 630, -1983433 / 1935360),
    (0, 0, 61 / 240, -103 / 140, 15061 / 26880, 167603 / 181440),
    (0, 0, 0, 49561 / 161280, -179 / 168, 6601661 / 7257600),
    (0, 0, 0, 0, 34729 / 80640, -3418889 / 1995840),
    (0, 0, 0, 0, 0, 212378941 / 319334400),
)
_ALPHAS = tuple(sum(x * _N**k for k, x in enumerate(row, 1)) for row in _SERIES)

_Degrees = NDArray[float64]


def transverse_mercator(lat: _Degrees, lon: _Degrees, meridian: float, scale: float) -> Points:
    """Metres east of a meridian and north of the equator."""
    eccentricity = np.sqrt(_SQUARED)
    east = np.radians(lon - meridian)
    tau = np.tan(np.radians(lat))
    root = np.sqrt(1 + tau**2)
    sigma = np.sinh(eccentricity * np.arctanh(eccentricity * tau / root))
    conformal = tau * np.sqrt(1 + sigma**2) - sigma * root
    xi = np.arctan2(conformal, np.cos(east))
    eta = np.arcsinh(np.sin(east) / np.hypot(conformal, np.cos(east)))
    north, across = xi.copy(), eta.copy()
    for k, alpha in enumerate(_ALPHAS, 1):
        north += alpha * np.sin(2 * k * xi) * np.cosh(2 * k * eta)
        across += alpha * np.cos(2 * k * xi) * np.sinh(2 * k * eta)
    places: Points = scale * _RADIUS_M * np.stack((across, north), axis=-1)
    return places


def utm_zone(lat: float, lon: float) -> int:
    """The number of a place's UTM zone, with the wider zones of Norway and Svalbard."""
    east = (lon + 180.0) % 360.0 - 180.0
    zone = floor((east + 180.0) / 6.0) % 60 + 1
    if 56.0 <= lat < 64.0 and 3.0 <= east < 12.0:
        return 32
    if 72.0 <= lat < MOST_NORTH_DEG and 0.0 <= east < 42.0:
        return 31 if east < 9 else 33 if east < 21 else 35 if east < 33 else 37
    return zone


def utm_meridian(zone: int) -> float:
    """The central meridian (degrees) of a UTM zone."""
    return 6.0 * zone - 183.0


def utm(lat: _Degrees, lon: _Degrees, zone: int, *, south: bool) -> Points:
    """Easting and northing (m) in a zone, with the offset for the southern or northern half."""
    places = transverse_mercator(lat, lon, utm_meridian(zone), UTM_SCALE)
    shifted: Points = places + np.array([UTM_EAST_M, UTM_SOUTH_M if south else 0.0])
    return shifted


def local_tangent(lat: _Degrees, lon: _Degrees, origin: tuple[float, float]) -> Points:
    """Metres east and north of an origin, on the plane tangent to the ellipsoid there."""
    whole = _geocentric(np.append(lat, origin[0]), np.append(lon, origin[1]))
    phi, lam = np.radians(origin)
    axes = np.array(
        [
            (-np.sin(lam), np.cos(lam), 0.0),
            (-np.sin(phi) * np.cos(lam), -np.sin(phi) * np.sin(lam), np.cos(phi)),
        ]
    )
    places: Points = (whole[:-1] - whole[-1]) @ axes.T
    return places


def _geocentric(lat: _Degrees, lon: _Degrees) -> NDArray[float64]:
    phi, lam = np.radians(lat), np.radians(lon)
    radius = _AXIS_M / np.sqrt(1 - _SQUARED * np.sin(phi) ** 2)
    flat = radius * np.cos(phi)
    up = radius * (1 - _SQUARED) * np.sin(phi)
    points: NDArray[float64] = np.stack((flat * np.cos(lam), flat * np.sin(lam), up), axis=-1)
    return points
