"""The fields of ASAM OSI messages that are read, by their numbers in the standard.

ASAM OSI 3.0 to 3.8, https://opensimulationinterface.github.io/osi-antora-documentation/; numbers
never change their meaning within a major version. Enumerations are those of the fields' own
messages; a number added by a later version is ``other``.
"""

from __future__ import annotations

from rulec.recordings.encodings.wire_format import Table, tables_of, words_of

_OTHER = "other"
OBJECTS = words_of("unknown other vehicle pedestrian animal", _OTHER)
ROLES = words_of(
    "unknown other civil ambulance fire police public_transport road_assistance"
    " garbage_collection road_construction military",
    _OTHER,
)
VEHICLES = words_of(
    "unknown other small_car compact_car car luxury_car van heavy_truck semitrailer trailer"
    " motorbike bicycle bus tram train wheelchair semitractor standup_scooter"
    " micromobility_device work_machine watercraft aircraft land_vehicle",
    _OTHER,
)
TABLES = tables_of(
    """
Id: 1 value uint
Time: 1 seconds int, 2 nanos uint
Vector: 1 x double, 2 y double
Yaw: 3 yaw double
Orientation: 1 roll double, 2 pitch double, Yaw
Area: 1 length double, 2 width double
Size: Area, 3 height double
AssignedLane: 1 assigned_lane_id Id
Position: 1 position Vector

Base: 1 dimension Size, 2 position Vector, 3 orientation Orientation
StandingBase: Base, 4 base_polygon Vector*
MovingBase: 1 dimension Area, 2 position Vector, 3 orientation Yaw, 4 velocity Vector,
  5 acceleration Vector

Indicator = unknown other off left right warning
Lamp = unknown other off on flashing_blue flashing_blue_and_red flashing_amber
BrakeLamp = unknown other off normal strong
LightState: 1 indicator_state Indicator, 2 front_fog_light Lamp, 3 rear_fog_light Lamp,
  4 head_light Lamp, 5 high_beam Lamp, 7 brake_light_state BrakeLamp,
  9 emergency_vehicle_illumination Lamp
Vehicle: 1 type VehicleType, 2 light_state LightState, 5 role Role
MovingObject: 1 id Id, 2 base MovingBase, 3 type ObjectType, 6 vehicle_classification Vehicle

StationaryType = unknown other bridge building pole pylon delineator tree barrier vegetation
  curbstone wall vertical_structure rectangular_structure overhead_structure reflective_structure
  construction_site_element speed_bump emitting_structure
Stationary: 1 type StationaryType
StationaryObject: 1 id Id, 2 base StandingBase, 3 classification Stationary

LanePairing: 1 antecessor_lane_id Id, 2 successor_lane_id Id
RoadCondition: 2 surface_water_film double, 4 surface_ice double
LaneType = unknown other driving nondriving intersection
LaneSubtype = unknown other normal biking sidewalk parking stop restricted border shoulder exit
  entry onramp offramp connectingramp
LaneClass: 1 type LaneType, 3 centerline Vector*, 4 centerline_is_driving_direction bool,
  5 left_adjacent_lane_id Id*, 6 right_adjacent_lane_id Id*, 7 lane_pairing LanePairing*,
  8 right_lane_boundary_id Id*, 9 left_lane_boundary_id Id*, 10 free_lane_boundary_id Id*,
  11 road_condition RoadCondition, 12 subtype LaneSubtype
Lane: 1 id Id, 2 classification LaneClass
BoundaryType = unknown other no_line solid_line dashed_line botts_dots road_edge snow_edge
  grass_edge gravel_edge soil_edge guard_rail curb structure barrier sound_barrier
BoundaryClass: 1 type BoundaryType
LaneBoundary: 1 id Id, 2 boundary_line Position*, 3 classification BoundaryClass

Unit = 0 unknown, 1 other, 2 no_unit, 3 kmh, 4 mph
SignValue: 1 value double, 2 value_unit Unit
SignType = 0 unknown, 1 other, 16 give_way, 17 stop, 18 priority_to_opposite_direction,
  29 roundabout, 34 bus_lane, 35 bus_lane_begin, 52 speed_limit_begin, 53 speed_limit_zone_begin,
  56 overtaking_ban_begin, 57 overtaking_ban_for_trucks_begin, 67 right_of_way_next_intersection,
  68 right_of_way_begin, 70 priority_over_opposite_direction, 72 town_begin, 73 town_end,
  77 living_street_begin, 79 tunnel, 82 highway_begin, 84 expressway_begin, 87 zebra_crossing,
  92 traffic_light_green_arrow, 187 oneway_street
SignClass: 2 type SignType, 3 value SignValue, 5 assigned_lane_id Id*, 7 is_out_of_service bool,
  12 logical_lane_assignment AssignedLane*
MainSign: 2 classification SignClass
SupplementType = 2 no_sign
SupplementClass: 2 type SupplementType
SupplementarySign: 2 classification SupplementClass
TrafficSign: 1 id Id, 2 main_sign MainSign, 3 supplementary_sign SupplementarySign*

MarkingType = unknown other painted_traffic_sign symbolic_traffic_sign textual_traffic_sign
  generic_symbol generic_line generic_text
MarkingClass: 1 type MarkingType, 2 traffic_main_sign_type SignType, 6 assigned_lane_id Id*,
  7 is_out_of_service bool, 12 logical_lane_assignment AssignedLane*
RoadMarking: 1 id Id, 2 base Base, 3 classification MarkingClass

Colour = unknown other red yellow green blue white
Icon = unknown other none straight_ahead left diag_left straight_ahead_left right diag_right
  straight_ahead_right left_right down down_left down_right cross pedestrian walk dont_walk bicycle
  pedestrian_and_bicycle countdown_seconds countdown_percent tram bus bus_and_tram
Mode = unknown other off constant flashing counting
LightBase: 2 position Vector
LightClass: 1 color Colour, 2 icon Icon, 3 mode Mode, 5 assigned_lane_id Id*,
  6 is_out_of_service bool, 7 logical_lane_assignment AssignedLane*
TrafficLight: 1 id Id, 2 base LightBase, 3 classification LightClass

Illumination = unknown other level1 level2 level3 level4 level5 level6 level7 level8 level9
Precipitation = unknown other none very_light light moderate heavy very_heavy extreme
Fog = unknown other excellent good moderate poor mist light thick dense
Environment: 1 ambient_illumination Illumination, 6 precipitation Precipitation, 7 fog Fog

LinePoint: 1 world_position Vector, 2 s_position double
ReferenceLine: 1 id Id, 2 poly_line LinePoint*
PassingRule = unknown other none_allowed increasing decreasing both
LogicalBoundary: 1 id Id, 2 boundary_line Position*, 4 physical_boundary_id Id*,
  5 passing_rule PassingRule
Relation: 1 other_lane_id Id
RuleType = 0 speed_limit
Nothing:
RuleValidity: 3 valid_for_type Nothing*
SpeedLimit: 1 speed_limit_value SignValue
TrafficRule: 1 traffic_rule_type RuleType, 2 traffic_rule_validity RuleValidity,
  3 speed_limit SpeedLimit
LogicalType = unknown other normal biking sidewalk parking stop restricted border shoulder exit
  entry onramp offramp connectingramp median curb rail tram
MoveDirection = unknown other increasing decreasing both
RoadType = unknown other lowspeed motorway pedestrian rural town_arterial town_collector
  town_expressway town_local town_play_street town_private town bicycle
PhysicalLane: 1 physical_lane_id Id
LogicalLane: 1 id Id, 2 type LogicalType, 4 physical_lane_reference PhysicalLane*,
  5 reference_line_id Id, 6 start_s double, 7 end_s double, 8 move_direction MoveDirection,
  9 right_adjacent_lane Relation*, 10 left_adjacent_lane Relation*, 11 overlapping_lane Relation*,
  12 right_boundary_id Id*, 13 left_boundary_id Id*, 14 predecessor_lane Relation*,
  15 successor_lane Relation*, 17 traffic_rule TrafficRule*, 18 road_type RoadType

GroundTruth: 2 timestamp Time, 3 host_vehicle_id Id, 4 stationary_object bytes*,
  5 moving_object MovingObject*, 6 traffic_sign bytes*, 7 traffic_light TrafficLight*,
  8 road_marking bytes*, 9 lane_boundary bytes*, 10 lane bytes*,
  12 environmental_conditions Environment, 13 country_code uint, 17 reference_line bytes*,
  18 logical_lane_boundary bytes*, 19 logical_lane bytes*
SensorView: 2 timestamp Time, 7 global_ground_truth GroundTruth, 8 host_vehicle_id Id
SensorData: 2 timestamp Time, 8 sensor_view SensorView*

LikeTruth: 2 timestamp Time, 7 static bytes*, 8 static bytes*, 9 static bytes*, 10 static bytes*,
  19 static bytes*
Truths: 7 truth bytes*
Views: 8 view Truths*
""",
    _OTHER,
    {"ObjectType": OBJECTS, "Role": ROLES, "VehicleType": VEHICLES},
)
STATIC: dict[str, Table] = {
    "stationary_object": TABLES["StationaryObject"],
    "traffic_sign": TABLES["TrafficSign"],
    "road_marking": TABLES["RoadMarking"],
    "lane_boundary": TABLES["LaneBoundary"],
    "lane": TABLES["Lane"],
    "reference_line": TABLES["ReferenceLine"],
    "logical_lane_boundary": TABLES["LogicalBoundary"],
    "logical_lane": TABLES["LogicalLane"],
}
"""Static content: only the first message of each id counts, and it is decoded once."""

MESSAGES = {name: TABLES[name] for name in ("GroundTruth", "SensorView", "SensorData")}
"""The message types that have, or may have, ground truth in them."""

LIKE_TRUTH = TABLES["LikeTruth"]
"""The fields that distinguish ground truth from a light or a mounting position.

Those have other fields, or none, at these numbers.
"""

VIEWS, TRUTHS = TABLES["Views"], TABLES["Truths"]
