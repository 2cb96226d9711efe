"""Projections of WGS84 degrees to metres: UTM, transverse Mercator, local tangent plane.

The series are those of C. F. F. Karney, Transverse Mercator with an accuracy of a few nanometers,
Journal of Geodesy 85, 2011, equations 7 to 11 and 35, as in GeographicLib and thereby Lanelet2.
"""

from __future__ import annotations

from math import floor

import numpy as np
from numpy import float64
from numpy.typing import NDArray

from rulec.recordings.recording import Points

UTM_SCALE = 0.9996
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
