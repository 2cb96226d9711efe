"""The fields of CommonRoad's messages in Protocol Buffers, with the names of the XML elements.

From the schemas in `commonroad-io`: 2023.4 has the one for single files, 2026.1 that for scenarios
in three parts. A field's name is the path from its message to the XML counterpart: ``a/b`` is an
element in another one, ``a@b`` an attribute; a field with an empty name belongs to its message.
"""

from __future__ import annotations

from rulec.recordings.commonroad.traffic_signs import UNKNOWN, signs_by_number
from rulec.recordings.encodings.wire_format import Words, tables_of

_IN_ALL_COUNTRIES = {241: "STOP_4_WAY", 242: "NO_TURN_ON_RED", 243: "ONEWAY"}
_COUNTRIES = "DEU ZAM USA CHN ESP RUS ARG BEL FRA GRC HRV ITA PRI"
_SIGNS_OF = {name: Words(signs_by_number(name), UNKNOWN) for name in _COUNTRIES.split()}
# In the schema of 2023.4, the signs of each country have a field of their own, and number 6 is
# unused. `commonroad-io` up to 2023.3 gives marks 2 to 5 other meanings, and files do not name its
# version. Groups of shapes may contain groups. A light's cycle has the same numbers in both
# schemas; in scenarios in three parts, the part with the traffic contains it.
_TABLES = tables_of(
    """
Nothing:
Point: 1 x double, 2 y double
Interval: 1 intervalStart double, 2 intervalEnd double
Number: 1 exact double, 2 - Interval
StepInterval: 1 intervalStart int, 2 intervalEnd int
Steps: 1 exact int, 2 - StepInterval

Rectangle: 1 length double, 2 width double, 3 center Point, 4 orientation double
Circle: 1 radius double, 2 center Point
Polygon: 1 point Point*
Shape: 1 rectangle Rectangle, 2 circle Circle, 3 polygon Polygon
TruckSize: 1 length double, 2 width double
Truck: 1 truckDims TruckSize, 2 originXShift double
Body: Shape, 4 truckShape Truck, 5 semiTrailerTruckShape Nothing
Group: 1 shape Area*
Area: Shape, 4 shapeGroup Group

State: 1 position/point Point, 2 position Area, 3 orientation Number, 4 velocity Number,
  34 acceleration Number, 39 time Steps
Lamps: 1 time Steps, 2 horn bool, 3 indicatorLeft bool, 4 indicatorRight bool,
  5 brakingLights bool, 6 hazardWarningLights bool, 7 flashingBlueLights bool
Occupancy: 1 time Steps, 2 shape Area
Occupancies: 1 occupancy Occupancy*
Predicted: 2 occupancySet Occupancies
Trajectory: 2 state State*
Driven: 1 trajectory Trajectory

ObstacleType = unknown car truck bus bicycle pedestrian priorityVehicle parkedVehicle
  constructionZone train roadBoundary motorcycle taxi building pillar median_strip
ThingType = unknown building roadBoundary pillar median_strip
Obstacle: 1 @id uint, 2 type ObstacleType, 3 shape Body, 4 initialState State
Obstacle2020: 1 @id uint, 2 type ObstacleType, 3 shape Area, 4 initialState State
Standing: 5 initialSignalState Lamps, 6 signalSeries/signalState Lamps*
Moving: 5 - Driven, 6 - Predicted, 7 initialSignalState Lamps, 8 signalSeries/signalState Lamps*
StaticObstacle: Obstacle, Standing
StaticObstacle2020: Obstacle2020, Standing
DynamicObstacle: Obstacle, Moving
DynamicObstacle2020: Obstacle2020, Moving
EnvironmentObstacle: 1 @id uint, 2 type ThingType, 3 shape Area
EnvironmentObstacle2020: 1 @id uint, 2 type ObstacleType, 3 shape Area
PhantomObstacle: 1 @id uint, 2 - Predicted

Goal: 1 - State, 2 position/lanelet@ref uint*
PlanningProblem: 1 @id uint, 2 initialState State, 3 goalState Goal*

Colour = red redYellow green yellow inactive
Phase: 1 duration uint, 2 color Colour
TrafficLight: 1 @id uint, 2 cycle/cycleElement Phase*, 4 cycle/timeOffset uint, 6 active bool

SignElement: 1 signName Sign, 2 additionalValue text*
TrafficSign: 1 @id uint, 2 trafficSignElement SignElement*
SignElement2020: 1 signName DEU, 2 signName ZAM, 3 signName USA, 4 signName CHN, 5 signName ESP,
  7 signName RUS, 8 signName ARG, 9 signName BEL, 10 signName FRA, 11 signName GRC,
  12 signName HRV, 13 signName ITA, 14 signName PRI, 15 additionalValue text*
TrafficSign2020: 1 @id uint, 2 trafficSignElement SignElement2020*

TimeOfDay = night sunset afternoon noon morning unknown
TimeOfDay2020 = night day unknown
Weather = clear light_rain mid_rain heavy_rain fog snow hail cloudy unknown
Weather2020 = sunny light_rain heavy_rain fog snow hail unknown
Ground = wet clean dirty damaged snow ice unknown
Environment: 2 timeOfDay TimeOfDay, 3 weather Weather, 4 underground Ground
Environment2020: 2 timeOfDay TimeOfDay2020, 3 weather Weather2020, 4 underground Ground
Location2020: 5 environment Environment2020

Mark = dashed solid solid_solid dashed_dashed solid_dashed dashed_solid curb lowered_curb
  broad_dashed broad_solid unknown no_marking
Mark2020 = dashed solid unknown unknown unknown unknown curb lowered_curb
  broad_dashed broad_solid unknown no_marking
LaneletType = urban country highway driveWay mainCarriageWay accessRamp exitRamp shoulder busLane
  busStop bicycleLane sidewalk crosswalk interstate intersection border parking restricted
  restricted_area unknown
LaneletType2020 = urban country highway driveWay mainCarriageWay accessRamp exitRamp shoulder
  busLane busStop bicycleLane sidewalk crosswalk interstate intersection border parking restricted
  unknown
User = vehicle car truck bus priorityVehicle motorcycle bicycle pedestrian train taxi
Direction = same opposite
Bound2020: Polygon, 2 lineMarking Mark2020
Lanelet2020: 1 @id uint, 2 leftBound Bound2020, 3 rightBound Bound2020, 4 predecessor@ref uint*,
  5 successor@ref uint*, 6 adjacentLeft@ref uint, 7 adjacentRight@ref uint,
  8 adjacentLeft@drivingDir Direction, 9 adjacentRight@drivingDir Direction, 10 stopLine Polygon,
  11 laneletType LaneletType2020*, 12 userOneWay User*, 13 userBidirectional User*,
  14 trafficSignRef@ref uint*, 15 trafficLightRef@ref uint*
Lanelet: 1 @id uint, 2 leftBound int, 3 rightBound int, 4 leftBound@reverse bool,
  5 rightBound@reverse bool, 6 predecessor@ref uint*, 7 successor@ref uint*,
  8 adjacentLeft@ref uint, 9 adjacentRight@ref uint, 10 adjacentLeft@drivingDir Direction,
  11 adjacentRight@drivingDir Direction, 12 stopLine uint, 13 laneletType LaneletType*,
  14 userOneWay User*, 15 userBidirectional User*, 16 trafficSignRef@ref uint*,
  17 trafficLightRef@ref uint*
StopLine: 1 @id uint, 2 point Point*, 3 point Point*
Bound: 1 @id int, 2 point Point*, 3 lineMarking Mark

Incoming: 4 outgoingRight@ref uint*, 5 outgoingStraight@ref uint*, 6 outgoingLeft@ref uint*
Intersection: 1 @id uint, 2 incoming Incoming*
Incoming2020: 3 successorsRight@ref uint*, 4 successorsStraight@ref uint*,
  5 successorsLeft@ref uint*
Intersection2020: 1 @id uint, 2 incoming Incoming2020*

Information: 1 @commonRoadVersion text, 2 @benchmarkID text, 7 @timeStepSize double
Single: 1 - Information, 3 location Location2020, 4 lanelet Lanelet2020*,
  5 trafficSign TrafficSign2020*, 6 trafficLight TrafficLight*, 7 intersection Intersection2020*,
  8 staticObstacle StaticObstacle2020*, 9 dynamicObstacle DynamicObstacle2020*,
  10 environmentObstacle EnvironmentObstacle2020*, 11 phantomObstacle PhantomObstacle*,
  12 planningProblem PlanningProblem*

MapId: 1 @country text, 2 @map text, 3 @mapNumber uint
Scene: 2 - MapId
Meta: 1 - Scene, 3 @timeStepSize double
MapOfDynamic: 1 - Meta
Dynamic: 2 location/environment Environment, 3 trafficLight TrafficLight*,
  4 trafficSignValue TrafficSign*, 5 staticObstacle StaticObstacle*,
  6 dynamicObstacle DynamicObstacle*, 7 phantomObstacle PhantomObstacle*
DynamicOfScenario: 4 @dynamic text
Scenario: 5 planningProblem PlanningProblem*
Bounds: 4 stopLine StopLine*, 5 bound Bound*
Map: 3 lanelet Lanelet*, 7 trafficSign TrafficSign*, 9 intersection Intersection*,
  10 environmentObstacle EnvironmentObstacle*

First: 1 - bytes
Begin: 1 - First, 2 - bytes*
""",
    "",
    {**_SIGNS_OF, "Sign": Words(signs_by_number("DEU") | _IN_ALL_COUNTRIES, UNKNOWN)},
)

SINGLE = _TABLES["Single"]
"""A scenario in one file, version 2020a."""

MAP_OF_DYNAMIC = _TABLES["MapOfDynamic"]
"""The fields of the part with the traffic that give its map and time step."""

DYNAMIC = _TABLES["Dynamic"]
"""The part with the traffic."""

DYNAMIC_OF_SCENARIO = _TABLES["DynamicOfScenario"]
"""The field of the part with the planning problems that names the part with the traffic."""

SCENARIO = _TABLES["Scenario"]
"""The part with the planning problems."""

BOUNDS = _TABLES["Bounds"]
"""The stop lines and bounds of a map, to which its lanelets refer by id."""

MAP = _TABLES["Map"]
"""The part with the roads."""

BEGIN = _TABLES["Begin"]
"""The first fields of a file, which differ between the kinds of files."""
