"""Types of road users as data sets call them, and the usual sizes of each.

Sizes are those of common vehicles: a car of the compact class, a lorry with two or three axles, a
city bus of 12 m (Directive 96/53/EC allows 2.55 m of width), a trailer's articulated lorry.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rulec.recordings.recording import OBSTACLE_TYPES

USUAL_TYPE = "car"

USUAL_SIZES: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "car": (4.5, 1.8),
        "taxi": (4.5, 1.8),
        "truck": (9.0, 2.5),
        "bus": (12.0, 2.55),
        "motorcycle": (2.2, 0.8),
        "priorityVehicle": (5.5, 2.0),
        "parkedVehicle": (4.5, 1.8),
        "bicycle": (1.8, 0.65),
        "pedestrian": (0.5, 0.5),
        "train": (30.0, 2.65),
        "unknown": (4.5, 1.8),
    }
)
"""Our types -> length and width (m) if a table has none; one metre for all others."""

OTHER_SIZE = 1.0, 1.0

_ALSO = {
    "car": "vehicle passenger passenger_car automobile auto van minivan suv pickup vehicle.car",
    "taxi": "cab",
    "truck": "lorry trailer truck_bus heavy_truck semitrailer delivery heavy_vehicle truck_trailer",
    "bus": "coach minibus",
    "motorcycle": "motorbike motorcyclist moped scooter powered_two_wheeler",
    "priorityVehicle": "emergency_vehicle emergency police ambulance fire_engine priority_vehicle",
    "parkedVehicle": "parked parked_vehicle",
    "bicycle": "cyclist bike rider cycle bicyclist",
    "pedestrian": "person walker people vru",
    "train": "tram rail",
    "unknown": "other object undefined misc",
    "constructionZone": "construction_zone cone barrier",
}
TYPES: Mapping[str, str] = MappingProxyType(
    {own.casefold(): own for own in OBSTACLE_TYPES}
    | {word: own for own, words in _ALSO.items() for word in words.split()}
)
"""Names of types in tables, in lower case -> our types, which are CommonRoad's."""


def type_of(word: str) -> str | None:
    """Our type for a data set's word; None if it is unknown."""
    return TYPES.get("_".join(word.casefold().replace("-", " ").split()))


def usual_size(kind: str) -> tuple[float, float]:
    """The usual length and width (m) of a type."""
    return USUAL_SIZES.get(kind, OTHER_SIZE)
