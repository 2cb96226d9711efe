"""Units of speed, in the spellings of all formats."""

from collections.abc import Mapping
from types import MappingProxyType

KMH, MPH = 1 / 3.6, 0.44704
"""Kilometres and miles per hour in m/s."""

SPEED_UNITS: Mapping[str, float] = MappingProxyType(
    {**dict.fromkeys(("m/s", "mps"), 1.0), **dict.fromkeys(("km/h", "kmh", "kph"), KMH), "mph": MPH}
)
"""Spelling of a unit -> its size in m/s."""
