"""Says what ASAM OSI traces hold, with betterosi alone.

Arguments: files. Standard output: for each a JSON line, in the standard's own words.
"""

import json
import sys
import warnings

import betterosi

LAMPS = ("indicator_state", "brake_light_state", "emergency_vehicle_illumination")


def read(path):
    """Times, hosts, objects by moment, and the lanes and boundaries of the first message."""
    frames = list(betterosi.read(path, return_ground_truth=True))
    first = frames[0]
    return {
        "times": [one.timestamp.seconds * 10**9 + one.timestamp.nanos for one in frames],
        "host": identifier(first.host_vehicle_id),
        "objects": [[moving(one) for one in frame.moving_object] for frame in frames],
        "lanes": [lane(one) for one in first.lane],
        "boundaries": {
            identifier(one.id): [
                one.classification.type.name,
                [[point.position.x, point.position.y] for point in one.boundary_line],
            ]
            for one in first.lane_boundary
        },
        "marks": [
            [
                one.classification.traffic_main_sign_type.name,
                [one.base.position.x, one.base.position.y],
                [identifier(x) for x in one.classification.assigned_lane_id],
            ]
            for one in first.road_marking
        ],
    }


def identifier(one):
    return None if one is None else str(one.value)


def vector(one):
    return None if one is None else [one.x, one.y]


def moving(one):
    classified = one.vehicle_classification
    lamps = getattr(classified, "light_state", None)
    return {
        "id": identifier(one.id),
        "type": one.type.name,
        "vehicle": classified and [classified.type.name, classified.role.name],
        "place": vector(one.base.position),
        "heading": one.base.orientation.yaw,
        "velocity": vector(one.base.velocity),
        "acceleration": vector(one.base.acceleration),
        "size": [one.base.dimension.length, one.base.dimension.width],
        "lamps": lamps and {name: getattr(lamps, name).name for name in LAMPS},
    }


def lane(one):
    said = one.classification
    return {
        "id": identifier(one.id),
        "type": said.type.name,
        "subtype": said.subtype.name,
        "centre": [vector(point) for point in said.centerline],
        "forward": said.centerline_is_driving_direction,
        "left": [identifier(x) for x in said.left_lane_boundary_id],
        "right": [identifier(x) for x in said.right_lane_boundary_id],
    }


if __name__ == "__main__":
    warnings.simplefilter("ignore")
    for path in sys.argv[1:]:
        sys.stdout.write(json.dumps(read(path)) + "\n")
