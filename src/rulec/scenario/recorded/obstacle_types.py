"""CommonRoad's obstacle types, and the object types of vocabularies for them.

For each the most specific word first, then more and more general ones: a rulebook that does not
tell cars from other vehicles judges a car as a vehicle. What is not a road user is an obstacle at
most; a rulebook without that word has no rule about it, but it is in the way all the same.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

_VEHICLE = ("vehicle", "road_user", "obstacle")
_RIDER = ("light_rider", "vulnerable_user", "road_user", "obstacle")

OBSTACLE_TYPES: Mapping[str, tuple[str, ...]] = MappingProxyType(
    {
        "car": ("car", *_VEHICLE),
        "taxi": ("car", *_VEHICLE),
        "truck": ("truck", *_VEHICLE),
        "bus": ("bus", *_VEHICLE),
        "motorcycle": ("motorcycle", *_VEHICLE),
        "priorityVehicle": ("emergency_vehicle", *_VEHICLE),
        "parkedVehicle": _VEHICLE,
        "bicycle": ("cyclist", *_RIDER),
        "pedestrian": ("pedestrian", "vulnerable_user", "road_user", "obstacle"),
        "train": ("train", "rail_vehicle", "rail_borne", "road_user", "obstacle"),
        "unknown": ("road_user", "obstacle"),
        "constructionZone": ("obstacle",),
        "roadBoundary": ("obstacle",),
        "building": ("obstacle",),
        "pillar": ("obstacle",),
        "median_strip": ("obstacle",),
    }
)
