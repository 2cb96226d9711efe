"""The fields of Waymo's scenarios that are read, by their numbers.

They are those of ``scenario.proto`` and ``map.proto``, which are public:
https://github.com/waymo-research/waymo-open-dataset/tree/master/src/waymo_open_dataset/protos
"""

from __future__ import annotations

from rulec.recordings.encodings.wire_format import tables_of

# The words are ScenarioNet's, for what is known of them there: a flashing light has no colour, and
# of a line that is broken on one side only, the side is unknown.
_TABLES = tables_of(
    """
Point: 1 x double, 2 y double, 3 z double

ObjectType = 1 VEHICLE, 2 PEDESTRIAN, 3 CYCLIST
State: 2 center_x double, 3 center_y double, 4 center_z double, 5 length float, 6 width float,
  8 heading float, 9 velocity_x float, 10 velocity_y float, 11 valid bool
Track: 1 id int, 2 object_type ObjectType, 3 states State*

Colour = 1 LANE_STATE_ARROW_STOP, 2 LANE_STATE_ARROW_CAUTION, 3 LANE_STATE_ARROW_GO,
  4 LANE_STATE_STOP, 5 LANE_STATE_CAUTION, 6 LANE_STATE_GO
LaneState: 1 lane int, 2 state Colour, 3 stop_point Point
MapState: 1 lane_states LaneState*

LineType = 1 BROKEN_SINGLE_WHITE, 2 SOLID_SINGLE_WHITE, 3 SOLID_DOUBLE_WHITE,
  4 BROKEN_SINGLE_YELLOW, 5 BROKEN_DOUBLE_YELLOW, 6 SOLID_SINGLE_YELLOW, 7 SOLID_DOUBLE_YELLOW
Boundary: 1 lane_start_index int, 2 lane_end_index int, 3 boundary_feature_id int,
  4 boundary_type LineType
Neighbour: 1 feature_id int, 2 self_start_index int, 3 self_end_index int,
  4 neighbor_start_index int, 5 neighbor_end_index int
LaneType = 1 FREEWAY, 3 BIKE_LANE
Lane: 1 speed_limit_mph double, 2 type LaneType, 8 polyline Point*, 9 entry_lanes int*,
  10 exit_lanes int*, 11 left_neighbor Neighbour*, 12 right_neighbor Neighbour*,
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
