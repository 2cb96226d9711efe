"""Object labels of 123D's data sets, by number.

Sources: the enumerations in `py123d.parser.registry` and `py123d.datatypes.detections` (0.7). Each
data set keeps its own labels; a file names its enumeration.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rulec.recordings.argoverse.object_types import CATEGORIES

LEFT_OUT = ""
"""The type of boards, lights and doors, which obstruct nobody or are part of a participant."""


def _numbered(words: str) -> dict[int, str]:
    """Types by number; ``-`` for labels that are left out."""
    return {number: word.replace("-", LEFT_OUT) for number, word in enumerate(words.split())}


LABELS: Mapping[str, Mapping[int, str]] = MappingProxyType(
    {
        "AV2SensorBoxDetectionLabel": _numbered(
            "ANIMAL ARTICULATED_BUS BICYCLE BICYCLIST BOLLARD BOX_TRUCK BUS CONSTRUCTION_BARREL"
            " CONSTRUCTION_CONE DOG LARGE_VEHICLE MESSAGE_BOARD_TRAILER"
            " MOBILE_PEDESTRIAN_CROSSING_SIGN MOTORCYCLE MOTORCYCLIST OFFICIAL_SIGNALER PEDESTRIAN"
            " RAILED_VEHICLE REGULAR_VEHICLE SCHOOL_BUS - - STROLLER TRAFFIC_LIGHT_TRAILER TRUCK"
            " TRUCK_CAB VEHICULAR_TRAILER WHEELCHAIR WHEELED_DEVICE WHEELED_RIDER"
        ),
        "DefaultBoxDetectionLabel": _numbered(
            "- vehicle train rider pedestrian object - constructionZone - roadBoundary object"
            " unknown"
        ),
        "KITTI360BoxDetectionLabel": _numbered(
            "bicycle object bus car unknown pillar motorcycle pedestrian pillar rider pillar - -"
            " - unknown train object truck object"
        ),
        "NuPlanBoxDetectionLabel": _numbered(
            "vehicle bicycle pedestrian constructionZone roadBoundary - object"
        ),
        "NureasoningBoxDetectionLabel": _numbered(
            "car bicycle pedestrian constructionZone - object - truck bus motorcycle bicycle"
            " pedestrian constructionZone"
        ),
        "NuScenesBoxDetectionLabel": _numbered(
            "car truck bus bus vehicle priorityVehicle priorityVehicle unknown bicycle motorcycle"
            " pedestrian pedestrian pedestrian unknown pedestrian object unknown constructionZone"
            " roadBoundary object object object object"
        ),
        "PandasetBoxDetectionLabel": _numbered(
            "object object bicycle bus car constructionZone - priorityVehicle truck motorcycle"
            " rider vehicle bicycle vehicle pedestrian pedestrian unknown car constructionZone"
            " roadBoundary object truck - roadBoundary unknown train train"
        ),
        "WODPerceptionBoxDetectionLabel": _numbered("unknown vehicle pedestrian - bicycle"),
        "WODMotionBoxDetectionLabel": _numbered("unknown vehicle pedestrian bicycle unknown"),
        "PhysicalAIAVBoxDetectionLabel": _numbered(
            "car pedestrian bus truck vehicle object rider object unknown object train bus"
        ),
        "GriffinBoxDetectionLabel": _numbered("pedestrian car truck bus motorcycle bicycle"),
    }
)
"""Enumeration -> number -> type of participant, or category of Argoverse 2's sensor logs.

Trailers do not drive, but are obstacles.
"""


def type_of(category: str) -> str:
    """The type of participant for a label."""
    return CATEGORIES.get(category, category)
