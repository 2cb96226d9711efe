"""Object categories of Argoverse 2, with usual sizes.

By `av2.datasets.motion_forecasting.data_schema.ObjectType`, and by
`av2.datasets.sensor.constants.AnnotationCategories` with the data set's annotation taxonomy.
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rulec.recordings.recording import StatedError

EGO_SIZE_M = 4.877, 2.0
"""Argoverse's car, a Ford Fusion Hybrid, as `EGO_VEHICLE` in annotations with ego."""

EGO_MIDDLE_M = 1.34
"""How far its middle is ahead of its rear axle, the origin of its frame.

That the origin is there, `argoverse/argoverse-api` issue 286 and av2-api's tests of maps say. The
middle is from the measures of the model: 4.869 m long, 2.850 m from axle to axle.
"""

MOTION_TYPES: Mapping[str, str] = MappingProxyType(
    {
        "vehicle": "vehicle",
        "bus": "bus",
        "motorcyclist": "motorcycle",
        "cyclist": "bicycle",
        "pedestrian": "pedestrian",
        **dict.fromkeys(("static", "background", "riderless_bicycle"), "object"),
        "construction": "constructionZone",
        "unknown": "unknown",
    }
)
"""Types of objects in motion forecasting -> types of participants."""

USUAL_SIZES_M: Mapping[str, tuple[float, float]] = MappingProxyType(
    {
        "vehicle": (4.6, 1.9),
        "bus": (12.2, 2.6),
        "motorcyclist": (2.1, 0.8),
        "cyclist": (1.8, 0.7),
        "pedestrian": (0.7, 0.7),
        "riderless_bicycle": (1.7, 0.6),
    }
)
"""Lengths and widths where a file says none.

Those of vehicles are the middle of what nine in ten of the cars in a sensor log have there, 4.0 to
5.5 m by 1.7 to 2.3 m; a bus is a North American one of 40 feet.
"""

OTHER_SIZE_M = 0.6, 0.6

ASSUMED_ERROR = StatedError(0.3, 0.0)
"""How far (m) the outline of an assumed size may be wrong at an end, as a half of what two may.

Half of the lengths of nine cars in ten differ from half of the usual one by up to 0.4 m: by 0.6 m
for two of them (JCGM 100:2008, 5.1.2). Trucks are called vehicles, too, and may be longer.
"""

CATEGORIES: Mapping[str, str] = MappingProxyType(
    {
        **dict.fromkeys(("EGO_VEHICLE", "REGULAR_VEHICLE"), "car"),
        "LARGE_VEHICLE": "vehicle",
        **dict.fromkeys(("TRUCK", "BOX_TRUCK", "TRUCK_CAB"), "truck"),
        **dict.fromkeys(("BUS", "SCHOOL_BUS", "ARTICULATED_BUS"), "bus"),
        "RAILED_VEHICLE": "train",
        "MOTORCYCLIST": "motorcycle",
        "BICYCLIST": "bicycle",
        "WHEELED_RIDER": "rider",
        **dict.fromkeys(("PEDESTRIAN", "OFFICIAL_SIGNALER"), "pedestrian"),
        **dict.fromkeys(("VEHICULAR_TRAILER", "WHEELCHAIR"), "unknown"),
        **dict.fromkeys(("CONSTRUCTION_CONE", "CONSTRUCTION_BARREL"), "constructionZone"),
        "BOLLARD": "pillar",
        **dict.fromkeys(("MOTORCYCLE", "BICYCLE", "WHEELED_DEVICE", "STROLLER"), "object"),
        **dict.fromkeys(("MESSAGE_BOARD_TRAILER", "TRAFFIC_LIGHT_TRAILER"), "object"),
        **dict.fromkeys(("ANIMAL", "DOG", "MOBILE_PEDESTRIAN_CROSSING_SIGN"), "object"),
    }
)
"""Categories of sensor logs -> types of participants.

Riders and what they ride have a box each. A trailer is nobody who drives, but in the way.
"""

RIDES: Mapping[str, str] = MappingProxyType(
    {"MOTORCYCLIST": "MOTORCYCLE", "BICYCLIST": "BICYCLE", "WHEELED_RIDER": "WHEELED_DEVICE"}
)
"""Riders -> what they ride."""

NOT_ON_THE_ROAD = frozenset({"SIGN", "STOP_SIGN"})
"""Boards on posts: which road they are for is not said, and they are in nobody's way."""
