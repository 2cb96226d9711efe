"""The paper's words for ego's position: the part around an obstacle, and the surface."""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rulec.scenario.motion import Facing

# The paper's figure 3, turned with the direction in which a pedestrian walks.
PAPER_TABLES: Mapping[Facing, bytes] = MappingProxyType(
    {
        "along": b"rrrboflll",
        "against": b"lllfobrrr",
        "left": b"lbrlorlfr",
        "right": b"rflrolrbl",
    }
)
"""The nine parts around an obstacle (``o``), row by row from right to left along the road."""

STATIONS = ("behind", "beside", "in_front_of")
LATERALS = ("right_of", "same_lane", "left_of")

PAPER_SURFACE = {"carriageway": "R_cw", "crossing": "R_pc"}
