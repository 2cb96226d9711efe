"""Says what Lanelet2 maps hold, with Lanelet2's own library alone.

Arguments: pairs of a file and the latitude and longitude of its origin, joined by commas. Standard
output: for each a JSON line. Lanes that lead both ways are followed as their bounds lead.
"""

import json
import sys

from lanelet2 import io, projection, routing, traffic_rules

GERMANY, VEHICLE = traffic_rules.Locations.Germany, traffic_rules.Participants.Vehicle


def read(text):
    """What the library has read of a file, as lists and dictionaries."""
    path, lat, lon = text.split(",")
    projector = projection.UtmProjector(io.Origin(float(lat), float(lon)))
    whole, errors = io.loadRobust(path, projector)
    rules = traffic_rules.create(GERMANY, VEHICLE)
    graph = routing.RoutingGraph(whole, rules)
    return {
        "errors": len(errors),
        "lanelets": {str(one.id): lanelet(one, graph, rules) for one in whole.laneletLayer},
        "rules": {str(one.id): rule(one) for one in whole.regulatoryElementLayer},
        "limits": limits(whole, rules),
    }


def lanelet(one, graph, rules):
    """A lanelet's bounds, and those around it on which vehicles drive as its bounds lead."""
    same = [x for x in graph.following(one) if not x.inverted()]
    left = [graph.left(one), graph.adjacentLeft(one)]
    right = [graph.right(one), graph.adjacentRight(one)]
    return {
        "left": [[point.x, point.y] for point in one.leftBound],
        "right": [[point.x, point.y] for point in one.rightBound],
        "passable": rules.canPass(one),
        "following": sorted(str(x.id) for x in same),
        "left_of": next((str(x.id) for x in left if x is not None and not x.inverted()), None),
        "right_of": next((str(x.id) for x in right if x is not None and not x.inverted()), None),
    }


def rule(one):
    """A regulatory element: its kind, and the ids in each role."""
    roles = one.parameters
    return {
        "subtype": one.attributes["subtype"],
        "roles": {key: sorted(str(x.id) for x in own) for key, own in roles.items()},
    }


def limits(whole, rules):
    """The limits (km/h) of lanelets that have one of their own."""
    own = [one for one in whole.laneletLayer if "speed_limit" in one.attributes]
    return {str(one.id): rules.speedLimit(one).speedLimit for one in own}


for argument in sys.argv[1:]:
    sys.stdout.write(json.dumps(read(argument)) + "\n")
