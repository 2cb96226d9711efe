"""The data sets that ScenarioNet brings into one form, and what is true of each.

By its converters (https://github.com/metadriverse/scenarionet, ``scenarionet/converter/``), and the
descriptions of the data sets themselves.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

from rulec.recordings.recording import Side


@dataclass(frozen=True, slots=True)
class DataSet:
    """A data set: ``title`` is its name where how well it knows places is known by that.

    ``whole_map``: limits, kinds of lines, boundaries, stop signs and stop points are those of the
    data set; else the conversion has made them up or left them out. ``has_lights``: it has what
    lights were seen to show, ``has_crosswalks`` the crosswalks that there are. ``ego_ahead_m``: how
    far the body's middle is ahead of ego's places.
    """

    title: str = ""
    whole_map: bool = False
    has_lights: bool = False
    has_crosswalks: bool = False
    ego_ahead_m: float = 0.0
    side: Side | None = None
    country: str = ""


_ZOE_AHEAD_M = 4.084 / 2 - 0.657
"""Ego's places are on its rear axle, which in a Renault Zoe is 0.657 m before its end.

It is 4.084 m long. Caesar et al., "nuScenes" (CVPR 2020), supplement, has the vehicle's frame.
"""

_DATA_SETS: Mapping[str, DataSet] = MappingProxyType(
    {
        "waymo": DataSet("Waymo", True, True, True, side="right", country="USA"),
        "nuscenes": DataSet(ego_ahead_m=_ZOE_AHEAD_M),
        "nuplan": DataSet(has_lights=True),
        "lyft": DataSet(has_lights=True, side="right", country="USA"),
        "argoverse": DataSet(side="right", country="USA"),
        "argoverse2": DataSet(has_crosswalks=True, side="right", country="USA"),
        "av2": DataSet(has_crosswalks=True, side="right", country="USA"),
    }
)
_PLACES: tuple[tuple[str, Side, str], ...] = (
    ("singapore", "left", "SGP"),
    ("sg-", "left", "SGP"),
    ("boston", "right", "USA"),
    ("us-", "right", "USA"),
)
"""Beginnings of the names of maps, with where these are."""


def data_set(name: str) -> DataSet:
    """A data set by its name in the files; of an unknown one nothing is taken to be so."""
    return _DATA_SETS.get(name.lower(), DataSet())


def place_of(map_name: str) -> tuple[Side | None, str]:
    """The side of traffic and the country of a map, None and empty if they are not known."""
    for begin, side, country in _PLACES:
        if map_name.lower().startswith(begin):
            return side, country
    return None, ""
