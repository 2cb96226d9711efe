"""SUMO's vehicle types and their sizes, from files or by default."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType

from rulec.recordings.encodings.file_format import XmlFormat
from rulec.recordings.encodings.safe_xml import root_of, scan
from rulec.recordings.encodings.tree import Tree

DEMAND = XmlFormat(
    "SUMO's vehicle types",
    "they are the elements `vType` of a file of routes, or of an additional file",
    root="routes",
)
_ROOTS = ("routes", "additional")


@dataclass(frozen=True, slots=True)
class VehicleType:
    """A type of participant: CommonRoad's type, size (m), and whether it has parts that turn."""

    kind: str
    length: float
    width: float
    articulated: bool = False


_CAR = VehicleType("car", 5.0, 1.8)
_RAIL = VehicleType("train", 135.0, 2.84, articulated=True)

CLASSES: Mapping[str, VehicleType] = MappingProxyType(
    {
        **dict.fromkeys(("passenger", "private", "hov", "vip", "army", "evehicle"), _CAR),
        **dict.fromkeys(("custom1", "custom2"), _CAR),
        "taxi": VehicleType("taxi", 5.0, 1.8),
        "authority": VehicleType("priorityVehicle", 5.0, 1.8),
        "emergency": VehicleType("priorityVehicle", 6.5, 2.16),
        "delivery": VehicleType("truck", 6.5, 2.16),
        "truck": VehicleType("truck", 7.1, 2.4),
        "trailer": VehicleType("truck", 16.5, 2.55, articulated=True),
        "bus": VehicleType("bus", 12.0, 2.5),
        "coach": VehicleType("bus", 14.0, 2.6),
        "motorcycle": VehicleType("motorcycle", 2.2, 0.9),
        "moped": VehicleType("motorcycle", 2.1, 0.78),
        "bicycle": VehicleType("bicycle", 1.6, 0.65),
        "scooter": VehicleType("bicycle", 1.2, 0.5),
        "pedestrian": VehicleType("pedestrian", 0.215, 0.478),
        "wheelchair": VehicleType("pedestrian", 0.8, 0.8),
        "tram": VehicleType("train", 22.0, 2.4, articulated=True),
        "subway": VehicleType("train", 109.5, 3.0, articulated=True),
        "rail_urban": VehicleType("train", 109.5, 3.0, articulated=True),
        "rail": _RAIL,
        "rail_electric": VehicleType("train", 200.0, 2.95, articulated=True),
        "rail_fast": VehicleType("train", 200.0, 2.95, articulated=True),
        "container": VehicleType("unknown", 6.1, 2.59),
    }
)
"""SUMO's vehicle classes, with the default sizes that SUMO gives their vehicles."""

_ARTICULATED = frozenset({"bus/flexible", "truck/semitrailer", "truck/trailer"})
_RAIL_SHAPE = "rail"
"""SUMO draws vehicles in parts, each turned along the way, for these shapes and this prefix."""

_BUILT_IN = {
    "DEFAULT_VEHTYPE": "passenger",
    "DEFAULT_PEDTYPE": "pedestrian",
    "DEFAULT_BIKETYPE": "bicycle",
    "DEFAULT_TAXITYPE": "taxi",
    "DEFAULT_RAILTYPE": "rail",
    "DEFAULT_CONTAINERTYPE": "container",
}
_UNKNOWN = VehicleType("unknown", 5.0, 1.8)
_COPY = "@"
_USUAL = {"vehicle": "passenger", "person": "pedestrian", "container": "container"}


def read_vehicle_types(files: Iterable[Path]) -> dict[str, VehicleType]:
    """The vehicle types described in files, by id.

    Raises RulecError R0610 if a file is broken.
    """
    types: dict[str, VehicleType] = {}

    def begin(element: Tree) -> None:
        if element.name == "vType":
            usual = CLASSES.get(element.attributes.get("vClass", "passenger"), _UNKNOWN)
            shape = element.attributes.get("guiShape", "")
            articulated = shape in _ARTICULATED or shape.startswith(_RAIL_SHAPE)
            types[element.filled("id")] = VehicleType(
                usual.kind,
                element.positive("length", usual.length),
                element.positive("width", usual.width),
                articulated if shape else usual.articulated,
            )

    for path in files:
        root = root_of(path, DEMAND)
        if root in _ROOTS:
            scan(path, replace(DEMAND, root=root), begin)
    return types


def vehicle_type(
    name: str, element: str, known: Mapping[str, VehicleType]
) -> tuple[VehicleType, bool]:
    """The type of a participant, and whether it is known; otherwise it is assumed.

    ``element`` is the name of the participant's element: ``vehicle``, ``person``, ``container``.
    SUMO changes a type for a single vehicle by a copy called ``type@vehicle``, for instance near
    blue lights.
    """
    if name not in known and _COPY in name:
        name = name[: name.index(_COPY)] or name
    if name in known:
        return known[name], True
    if name in _BUILT_IN:
        return CLASSES[_BUILT_IN[name]], True
    return CLASSES.get(name, CLASSES[_USUAL[element]]), False
