"""Units of speed, in the spellings of all formats."""

from collections.abc import Mapping
from types import MappingProxyType

KMH_PER_MPS = 3.6
"""km/h in one m/s."""

MPS_PER_KMH, MPS_PER_MPH = 1 / 3.6, 0.44704
"""m/s in one kilometre, and in one mile, per hour."""

SPEED_UNITS: Mapping[str, float] = MappingProxyType(
    {
        **dict.fromkeys(("m/s", "mps"), 1.0),
        **dict.fromkeys(("km/h", "kmh", "kph"), MPS_PER_KMH),
        "mph": MPS_PER_MPH,
    }
)
"""Spelling of a unit -> its size in m/s."""
