"""The fields of Waymo's scenarios that are read, by their numbers.

They are those of ``scenario.proto`` and ``map.proto``, which are public:
https://github.com/waymo-research/waymo-open-dataset/tree/master/src/waymo_open_dataset/protos
"""

from __future__ import annotations

from collections.abc import Mapping
from types import MappingProxyType

from rulec.recordings.encodings.wire_tables import tables_of
from rulec.recordings.recording import LaneMark

# The words are our own: a cyclist's type is that of a bicycle, a surface street is any lane but a
# freeway or a cycle lane, and a flashing light, which has no colour, is unknown.
_TABLES = tables_of(
    """
Point: 1 x double, 2 y double, 3 z double

ObjectType = 1 vehicle, 2 pedestrian, 3 bicycle, 4 unknown
State: 2 center_x double, 3 center_y double, 4 center_z double, 5 length float, 6 width float,
  8 heading float, 9 velocity_x float, 10 velocity_y float, 11 valid bool
Track: 1 id int, 2 object_type ObjectType, 3 states State*

Colour = 1 red, 4 red, 2 yellow, 5 yellow, 3 green, 6 green
LaneState: 1 lane int, 2 state Colour, 3 stop_point Point
MapState: 1 lane_states LaneState*

LineType = 1 broken_white, 2 solid_white, 3 solid_double_white, 4 broken_yellow,
  5 broken_double_yellow, 6 solid_yellow, 7 solid_double_yellow, 8 passing_double_yellow
Boundary: 1 lane_start_index int, 2 lane_end_index int, 3 boundary_feature_id int,
  4 boundary_type LineType
Neighbour: 1 feature_id int, 2 self_start_index int, 3 self_end_index int,
  4 neighbor_start_index int, 5 neighbor_end_index int
LaneType = 1 highway, 3 bicycleLane
Lane: 1 speed_limit_mph double, 2 type LaneType, 8 polyline Point*, 9 entry_lanes int*,
  10 exit_lanes int*, 11 left_neighbors Neighbour*, 12 right_neighbors Neighbour*,
  13 left_boundaries Boundary*, 14 right_boundaries Boundary*
Line: 2 polyline Point*
StopSign: 1 lane int*
Crosswalk: 1 polygon Point*
MapFeature: 1 id int, 3 lane Lane, 4 road_line Line, 5 road_edge Line, 7 stop_sign StopSign,
  8 crosswalk Crosswalk

ScenarioId: 5 scenario_id text
Scenario: 1 timestamps_seconds double*, 2 tracks Track*, ScenarioId, 6 sdc_track_index int,
  7 dynamic_map_states MapState*, 8 map_features MapFeature*
""",
    "unknown",
    {},
)
SCENARIO = _TABLES["Scenario"]

SCENARIO_ID = _TABLES["ScenarioId"]
"""The field read first from a record that may not be wanted."""

MARKS: Mapping[str, LaneMark | None] = MappingProxyType(
    {
        **dict.fromkeys(("broken_white", "broken_yellow", "broken_double_yellow"), "broken"),
        **dict.fromkeys(("solid_white", "solid_yellow"), "solid"),
        **dict.fromkeys(("solid_double_white", "solid_double_yellow"), "double_solid"),
        # Broken on one side: since the side is unknown, it provides no information
        "passing_double_yellow": None,
        # Road edges have it, too
        "unknown": None,
    }
)
