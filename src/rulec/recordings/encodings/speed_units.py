"""Units of speed, as files of all formats spell them."""

from collections.abc import Mapping
from types import MappingProxyType

KMH, MPH = 1 / 3.6, 0.44704
"""In m/s."""

SPEED_UNITS: Mapping[str, float] = MappingProxyType(
    {**dict.fromkeys(("m/s", "mps"), 1.0), **dict.fromkeys(("km/h", "kmh", "kph"), KMH), "mph": MPH}
)
"""Spelling -> in m/s."""
