"""Object categories of Argoverse 2, with usual sizes, and the tracks of objects in a table.

Sources: `av2.datasets.motion_forecasting.data_schema.ObjectType`, and
`av2.datasets.sensor.constants.AnnotationCategories` with the data set's annotation taxonomy.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from types import MappingProxyType
from typing import Any

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.recordings.encodings.arrow.arrow_tables import ArrowTable
from rulec.recordings.encodings.file_values import short
from rulec.recordings.recording import StatedError

EGO_SIZE_M = 4.877, 2.0
"""Length and width (m) of Argoverse's car, a Ford Fusion Hybrid, from `EGO_VEHICLE` annotations."""

EGO_MIDDLE_M = 1.34
"""The distance (m) from the rear axle, the origin of ego's frame, forward to ego's middle.

Sources for the origin: `argoverse/argoverse-api` issue 286 and av2-api's tests of maps. The
distance follows from the model's dimensions: 4.869 m long, wheelbase 2.850 m.
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
"""Object types of motion forecasting -> types of participants."""

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
"""Lengths and widths (m) assumed where a file gives none.

Those of vehicles are the middle of the range of nine in ten cars in a sensor log, 4.0 to 5.5 m by
1.7 to 2.3 m; a bus is a North American one of 40 feet.
"""

OTHER_SIZE_M = 0.6, 0.6

ASSUMED_ERROR = StatedError(0.3, 0.0)
"""The error (m) of one end of an outline with assumed size, as half the error of two ends.

Half the length of nine cars in ten differs from half the usual length by up to 0.4 m; for two cars
this gives 0.6 m (JCGM 100:2008, 5.1.2). Trucks also count as vehicles here, and may be longer.
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

A rider and the ridden vehicle have a box each. A trailer does not drive, but is an obstacle.
"""

RIDES: Mapping[str, str] = MappingProxyType(
    {"MOTORCYCLIST": "MOTORCYCLE", "BICYCLIST": "BICYCLE", "WHEELED_RIDER": "WHEELED_DEVICE"}
)
"""Category of a rider -> category of the ridden vehicle."""

NOT_ON_THE_ROAD = frozenset({"SIGN", "STOP_SIGN"})
"""Boards on posts: they obstruct nobody, and the road that they apply to is unknown."""


def tracks_in(
    table: ArrowTable, names: str, kinds: str, moments: NDArray[np.integer[Any]], called: str
) -> Iterator[tuple[str, str, NDArray[intp]]]:
    """Each name in a column with its most frequent kind, and its rows by ascending moment.

    Raises RulecError R0610 for a name that is twice in a moment, which is ``called`` so.
    """
    kind = table.texts[kinds]
    for name, rows in table.texts[names].groups(moments):
        twice = np.flatnonzero(np.diff(moments[rows]) == 0)
        if len(twice):
            row = int(rows[twice[0] + 1])
            why = f"`{short(name)}` is twice in {called.format(moments[row])}"
            raise table.refused(row, why)
        ((code, _),) = Counter(kind.codes[rows].tolist()).most_common(1)
        yield name, kind.names[code], rows
