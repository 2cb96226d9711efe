"""The fields of CommonRoad's messages in Protocol Buffers, with the names of the XML elements.

From the schemas in `commonroad-io`: 2023.4 has the one for single files, 2026.1 that for scenarios
in three parts. A field's name is the path from its message to the XML counterpart: ``a/b`` is an
element in another one, ``a@b`` an attribute; a field with an empty name belongs to its message.
"""

from __future__ import annotations

from rulec.recordings.commonroad.traffic_signs import UNKNOWN, signs_by_number
from rulec.recordings.encodings.wire_format import Field, Table, Words

_POINT: Table = {1: Field("x", "double"), 2: Field("y", "double")}
_NUMBER: Table = {
    1: Field("exact", "double"),
    2: Field("", {1: Field("intervalStart", "double"), 2: Field("intervalEnd", "double")}),
}
_STEPS: Table = {
    1: Field("exact", "int"),
    2: Field("", {1: Field("intervalStart", "int"), 2: Field("intervalEnd", "int")}),
}


def _words(text: str) -> Words:
    """The words for the values 0, 1 and so on."""
    return Words(dict(enumerate(text.split())))


def _refs(*names: str, first: int) -> Table:
    """Fields that refer to other elements by their ids."""
    return {
        number: Field(f"{name}@ref", "uint", many=True)
        for number, name in enumerate(names, start=first)
    }


_MARKS = _words(
    "dashed solid solid_solid dashed_dashed solid_dashed dashed_solid curb lowered_curb "
    "broad_dashed broad_solid unknown no_marking"
)
_MARKS_2020 = _words(
    "dashed solid unknown unknown unknown unknown curb lowered_curb "
    "broad_dashed broad_solid unknown no_marking"
)
"""`commonroad-io` up to 2023.3 gives 2 to 5 other meanings, and files do not name their version."""

_LANELETS = (
    "urban country highway driveWay mainCarriageWay accessRamp exitRamp shoulder busLane busStop "
    "bicycleLane sidewalk crosswalk interstate intersection border parking restricted "
)
_LANELET_TYPES = _words(f"{_LANELETS} restricted_area unknown")
_LANELET_TYPES_2020 = _words(f"{_LANELETS} unknown")
_USERS = _words("vehicle car truck bus priorityVehicle motorcycle bicycle pedestrian train taxi")
_DIRECTIONS = _words("same opposite")
_OBSTACLES = _words(
    "unknown car truck bus bicycle pedestrian priorityVehicle parkedVehicle constructionZone "
    "train roadBoundary motorcycle taxi building pillar median_strip"
)
_THINGS = _words("unknown building roadBoundary pillar median_strip")
_WEATHERS = _words("clear light_rain mid_rain heavy_rain fog snow hail cloudy unknown")
_WEATHERS_2020 = _words("sunny light_rain heavy_rain fog snow hail unknown")
_GROUNDS = _words("wet clean dirty damaged snow ice unknown")
_COLOURS = _words("red redYellow green yellow inactive")

_RECTANGLE: Table = {
    1: Field("length", "double"),
    2: Field("width", "double"),
    3: Field("center", _POINT),
    4: Field("orientation", "double"),
}
_CIRCLE: Table = {1: Field("radius", "double"), 2: Field("center", _POINT)}
_POLYGON: Table = {1: Field("point", _POINT, many=True)}
_PLAIN: Table = {
    1: Field("rectangle", _RECTANGLE),
    2: Field("circle", _CIRCLE),
    3: Field("polygon", _POLYGON),
}
_TRUCK: Table = {
    1: Field("truckDims", {1: Field("length", "double"), 2: Field("width", "double")}),
    2: Field("originXShift", "double"),
}
_BODY: Table = {**_PLAIN, 4: Field("truckShape", _TRUCK), 5: Field("semiTrailerTruckShape", {})}
_GROUP: dict[int, Field] = {}
_AREA: Table = {**_PLAIN, 4: Field("shapeGroup", _GROUP)}
# Groups may contain groups
_GROUP[1] = Field("shape", _AREA, many=True)

_STATE: Table = {
    1: Field("position/point", _POINT),
    2: Field("position", _AREA),
    3: Field("orientation", _NUMBER),
    4: Field("velocity", _NUMBER),
    34: Field("acceleration", _NUMBER),
    39: Field("time", _STEPS),
}
_LAMPS: Table = {
    1: Field("time", _STEPS),
    2: Field("horn", "bool"),
    3: Field("indicatorLeft", "bool"),
    4: Field("indicatorRight", "bool"),
    5: Field("brakingLights", "bool"),
    6: Field("hazardWarningLights", "bool"),
    7: Field("flashingBlueLights", "bool"),
}
_OCCUPANCY: Table = {1: Field("time", _STEPS), 2: Field("shape", _AREA)}
_PREDICTED: Table = {2: Field("occupancySet", {1: Field("occupancy", _OCCUPANCY, many=True)})}
_TRAJECTORY: Table = {1: Field("trajectory", {2: Field("state", _STATE, many=True)})}
_PHANTOM: Table = {1: Field("@id", "uint"), 2: Field("", _PREDICTED)}


def _environment_obstacle(types: Words) -> Table:
    return {1: Field("@id", "uint"), 2: Field("type", types), 3: Field("shape", _AREA)}


def _standing(shape: Table) -> Table:
    return {
        1: Field("@id", "uint"),
        2: Field("type", _OBSTACLES),
        3: Field("shape", shape),
        4: Field("initialState", _STATE),
        5: Field("initialSignalState", _LAMPS),
        6: Field("signalSeries/signalState", _LAMPS, many=True),
    }


def _moving(shape: Table) -> Table:
    return {
        **{number: field for number, field in _standing(shape).items() if number < 5},
        5: Field("", _TRAJECTORY),
        6: Field("", _PREDICTED),
        7: Field("initialSignalState", _LAMPS),
        8: Field("signalSeries/signalState", _LAMPS, many=True),
    }


_PROBLEM: Table = {
    1: Field("@id", "uint"),
    2: Field("initialState", _STATE),
    3: Field(
        "goalState",
        {1: Field("", _STATE), 2: Field("position/lanelet@ref", "uint", many=True)},
        many=True,
    ),
}
_LIGHT: Table = {
    1: Field("@id", "uint"),
    2: Field(
        "cycle/cycleElement",
        {1: Field("duration", "uint"), 2: Field("color", _COLOURS)},
        many=True,
    ),
    4: Field("cycle/timeOffset", "uint"),
    6: Field("active", "bool"),
}
"""The traffic light in single files; its cycle has the same numbers in scenarios in three parts."""


def _sign(elements: Table) -> Table:
    return {
        1: Field("@id", "uint"),
        2: Field("trafficSignElement", elements, many=True),
    }


_IN_ALL_COUNTRIES = {241: "STOP_4_WAY", 242: "NO_TURN_ON_RED", 243: "ONEWAY"}
_SIGN = _sign(
    {
        1: Field("signName", Words(signs_by_number("DEU") | _IN_ALL_COUNTRIES, UNKNOWN)),
        2: Field("additionalValue", "text", many=True),
    }
)
# The signs of each country have a field of their own; number 6 is unused
_COUNTRIES = "DEU,ZAM,USA,CHN,ESP,,RUS,ARG,BEL,FRA,GRC,HRV,ITA,PRI"
_SIGN_2020 = _sign(
    {
        **{
            number: Field("signName", Words(signs_by_number(country), UNKNOWN))
            for number, country in enumerate(_COUNTRIES.split(","), 1)
            if country
        },
        15: Field("additionalValue", "text", many=True),
    }
)

_ENVIRONMENT = {
    2: Field("timeOfDay", _words("night sunset afternoon noon morning unknown")),
    3: Field("weather", _WEATHERS),
    4: Field("underground", _GROUNDS),
}
_LOCATION_2020: Table = {
    5: Field(
        "environment",
        {
            **_ENVIRONMENT,
            2: Field("timeOfDay", _words("night day unknown")),
            3: Field("weather", _WEATHERS_2020),
        },
    )
}
_BOUND_2020: Table = {**_POLYGON, 2: Field("lineMarking", _MARKS_2020)}
_LANELET_2020: Table = {
    1: Field("@id", "uint"),
    2: Field("leftBound", _BOUND_2020),
    3: Field("rightBound", _BOUND_2020),
    **_refs("predecessor", "successor", first=4),
    6: Field("adjacentLeft@ref", "uint"),
    7: Field("adjacentRight@ref", "uint"),
    8: Field("adjacentLeft@drivingDir", _DIRECTIONS),
    9: Field("adjacentRight@drivingDir", _DIRECTIONS),
    10: Field("stopLine", _POLYGON),
    11: Field("laneletType", _LANELET_TYPES_2020, many=True),
    12: Field("userOneWay", _USERS, many=True),
    13: Field("userBidirectional", _USERS, many=True),
    **_refs("trafficSignRef", "trafficLightRef", first=14),
}
_INCOMING_2020 = _refs("successorsRight", "successorsStraight", "successorsLeft", first=3)
_INCOMING = _refs("outgoingRight", "outgoingStraight", "outgoingLeft", first=4)


def _intersection(incoming: Table) -> Table:
    return {1: Field("@id", "uint"), 2: Field("incoming", incoming, many=True)}


SINGLE: Table = {
    1: Field(
        "",
        {
            1: Field("@commonRoadVersion", "text"),
            2: Field("@benchmarkID", "text"),
            7: Field("@timeStepSize", "double"),
        },
    ),
    3: Field("location", _LOCATION_2020),
    4: Field("lanelet", _LANELET_2020, many=True),
    5: Field("trafficSign", _SIGN_2020, many=True),
    6: Field("trafficLight", _LIGHT, many=True),
    7: Field("intersection", _intersection(_INCOMING_2020), many=True),
    8: Field("staticObstacle", _standing(_AREA), many=True),
    9: Field("dynamicObstacle", _moving(_AREA), many=True),
    10: Field("environmentObstacle", _environment_obstacle(_OBSTACLES), many=True),
    11: Field("phantomObstacle", _PHANTOM, many=True),
    12: Field("planningProblem", _PROBLEM, many=True),
}
"""A scenario in one file, version 2020a."""

_MAP_ID: Table = {
    1: Field("@country", "text"),
    2: Field("@map", "text"),
    3: Field("@mapNumber", "uint"),
}
_META: Table = {
    1: Field("", {2: Field("", _MAP_ID)}),
    3: Field("@timeStepSize", "double"),
}
MAP_OF_DYNAMIC: Table = {1: Field("", _META)}
"""The fields of the part with the traffic that give its map and time step."""

DYNAMIC: Table = {
    2: Field("location/environment", _ENVIRONMENT),
    3: Field("trafficLight", _LIGHT, many=True),
    4: Field("trafficSignValue", _SIGN, many=True),
    5: Field("staticObstacle", _standing(_BODY), many=True),
    6: Field("dynamicObstacle", _moving(_BODY), many=True),
    7: Field("phantomObstacle", _PHANTOM, many=True),
}
"""The part with the traffic."""

DYNAMIC_OF_SCENARIO: Table = {4: Field("@dynamic", "text")}
"""The field of the part with the planning problems that names the part with the traffic."""

SCENARIO: Table = {5: Field("planningProblem", _PROBLEM, many=True)}
"""The part with the planning problems."""

BOUNDS: Table = {
    4: Field(
        "stopLine",
        {
            1: Field("@id", "uint"),
            2: Field("point", _POINT, many=True),
            3: Field("point", _POINT, many=True),
        },
        many=True,
    ),
    5: Field(
        "bound",
        {
            1: Field("@id", "int"),
            2: Field("point", _POINT, many=True),
            3: Field("lineMarking", _MARKS),
        },
        many=True,
    ),
}
"""The stop lines and bounds of a map, to which its lanelets refer by id."""

MAP: Table = {
    3: Field(
        "lanelet",
        {
            1: Field("@id", "uint"),
            2: Field("leftBound", "int"),
            3: Field("rightBound", "int"),
            4: Field("leftBound@reverse", "bool"),
            5: Field("rightBound@reverse", "bool"),
            **_refs("predecessor", "successor", first=6),
            8: Field("adjacentLeft@ref", "uint"),
            9: Field("adjacentRight@ref", "uint"),
            10: Field("adjacentLeft@drivingDir", _DIRECTIONS),
            11: Field("adjacentRight@drivingDir", _DIRECTIONS),
            12: Field("stopLine", "uint"),
            13: Field("laneletType", _LANELET_TYPES, many=True),
            14: Field("userOneWay", _USERS, many=True),
            15: Field("userBidirectional", _USERS, many=True),
            **_refs("trafficSignRef", "trafficLightRef", first=16),
        },
        many=True,
    ),
    7: Field("trafficSign", _SIGN, many=True),
    9: Field("intersection", _intersection(_INCOMING), many=True),
    10: Field("environmentObstacle", _environment_obstacle(_THINGS), many=True),
}
"""The part with the roads; the part with the traffic contains what traffic lights show."""

BEGIN: Table = {1: Field("", {1: Field("", "bytes")}), 2: Field("", "bytes", many=True)}
"""The first fields of a file, which differ between the kinds of files."""
