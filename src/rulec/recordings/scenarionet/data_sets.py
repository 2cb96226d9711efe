"""The data sets that ScenarioNet converts into one format, and the properties of each.

Sources: its converters (https://github.com/metadriverse/scenarionet, ``scenarionet/converter/``),
and the descriptions of the data sets themselves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType


@dataclass(frozen=True, slots=True)
class DataSet:
    """A data set; ``title`` is its name in the table of position errors, if it is listed there.

    ``whole_map``: whether limits, kinds of lines, boundaries, stop signs and stop points come from
    the data set; otherwise the conversion invented or omitted them. ``has_lights``: whether it
    contains observed lights. ``has_crosswalks``: whether it contains all crosswalks.
    ``ego_ahead_m``: how far the body's middle is ahead of ego's positions.
    """

    title: str = ""
    whole_map: bool = False
    has_lights: bool = False
    has_crosswalks: bool = False
    ego_ahead_m: float = 0.0
    country: str = ""


_ZOE_AHEAD_M = 4.084 / 2 - 0.657
"""Distance (m) from ego's recorded position to its middle, in a Renault Zoe.

The position is on the rear axle, 0.657 m before the car's rear end; the car is 4.084 m long. Caesar
et al., "nuScenes" (CVPR 2020), supplement, shows the vehicle's frame.
"""

_DATA_SETS: Mapping[str, DataSet] = MappingProxyType(
    {
        "waymo": DataSet("Waymo", True, True, True, country="USA"),
        "nuscenes": DataSet(ego_ahead_m=_ZOE_AHEAD_M),
        "nuplan": DataSet(has_lights=True),
        "lyft": DataSet(has_lights=True, country="USA"),
        "argoverse": DataSet(country="USA"),
        "argoverse2": DataSet(has_crosswalks=True, country="USA"),
        "av2": DataSet(has_crosswalks=True, country="USA"),
    }
)


def data_set(name: str) -> DataSet:
    """A data set by its name in the files; an unknown one has none of the properties."""
    return _DATA_SETS.get(name.lower(), DataSet())
