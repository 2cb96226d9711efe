"""Waymo's motion data written by hand: records, and scenarios as their messages have them.

A scenario is a dictionary: ``id``, ``times``, ``tracks`` (id, type, and for each time a state or
None), ``ego`` (index), ``lights`` (for each time lane -> (state, stop point)), ``features``.
"""

import struct

from support.builders.wire_bytes import counted, double, field, whole

VEHICLE, PEDESTRIAN, CYCLIST, OTHER = 1, 2, 3, 4
STOP, CAUTION, GO, FLASHING_STOP = 4, 5, 6, 7
ARROW_STOP, UNKNOWN = 1, 0


def crc32c(content):
    """Castagnoli's checksum bit by bit, as RFC 3720 has it."""
    state = 0xFFFFFFFF
    for byte in content:
        state ^= byte
        for _ in range(8):
            state = (state >> 1) ^ (0x82F63B78 if state & 1 else 0)
    return state ^ 0xFFFFFFFF


def masked(content):
    check = crc32c(content)
    return ((check >> 15 | check << 17) + 0xA282EAD8) & 0xFFFFFFFF


def record(content):
    """A record of a TFRecord file."""
    length = struct.pack("<Q", len(content))
    sums = (struct.pack("<I", masked(part)) for part in (length, content))
    return length + next(sums) + content + next(sums)


def single(number, value):
    """A field with a number of 32 bits."""
    return field(number, 5, struct.pack("<f", value))


def state(x, y, heading=0.0, speed=(0.0, 0.0), size=(4.5, 1.9), *, valid=True):
    """An object's state."""
    return {"x": x, "y": y, "heading": heading, "speed": speed, "size": size, "valid": valid}


def _state(one):
    if one is None:
        return counted(3, whole(11, 0))
    return counted(
        3,
        double(2, one["x"]),
        double(3, one["y"]),
        double(4, 0.0),
        *(single(5 + k, value) for k, value in enumerate((*one["size"], 1.5))),
        single(8, one["heading"]),
        *(single(9 + k, value) for k, value in enumerate(one["speed"])),
        whole(11, int(one["valid"])),
    )


def point(number, place):
    x, y, *z = place
    return counted(number, double(1, x), double(2, y), double(3, z[0] if z else 0.0))


def lane(name, points, **more):
    """A lane: ``limit`` in mph, ``type``, ``entries``, ``exits``, sides as lists of tuples.

    ``left_lines`` are start, end, id and type; ``left_lanes`` id, own start and end, the other's.
    """
    sides = {"left_lines": 13, "right_lines": 14, "left_lanes": 11, "right_lanes": 12}
    contents = [double(1, more.get("limit", 0.0)), whole(2, more.get("type", 2))]
    contents += [point(8, place) for place in points]
    for number, key in ((9, "entries"), (10, "exits")):
        contents += [whole(number, other) for other in more.get(key, ())]
    for key, number in sides.items():
        for part in more.get(key, ()):
            contents.append(counted(number, *(whole(k, x) for k, x in enumerate(part, 1))))
    return counted(8, whole(1, name), counted(3, *contents))


def road_line(name, points, kind=1):
    return counted(
        8, whole(1, name), counted(4, whole(1, kind), *(point(2, place) for place in points))
    )


def road_edge(name, points):
    return counted(8, whole(1, name), counted(5, whole(1, 1), *(point(2, x) for x in points)))


def stop_sign(name, lanes, place=(0.0, 0.0)):
    return counted(8, whole(1, name), counted(7, *(whole(1, x) for x in lanes), point(2, place)))


def crosswalk(name, corners):
    return counted(8, whole(1, name), counted(8, *(point(1, place) for place in corners)))


def scenario(**parts):
    """The bytes of a scenario."""
    contents = [double(1, time) for time in parts["times"]]
    for name, kind, states in parts["tracks"]:
        contents.append(counted(2, whole(1, name), whole(2, kind), *map(_state, states)))
    contents.append(counted(5, parts.get("id", "scene").encode()))
    contents.append(whole(6, parts.get("ego", 0)))
    for shown in parts.get("lights", ()):
        lanes = [
            counted(1, whole(1, name), whole(2, colour), point(3, stop))
            for name, (colour, stop) in shown.items()
        ]
        contents.append(counted(7, *lanes))
    return b"".join([*contents, *parts.get("features", ())])


def straight(start, end, y=0.0, every=5.0):
    """Points along the x axis."""
    count = round(abs(end - start) / every)
    return [(start + (end - start) * k / count, y) for k in range(count + 1)]


def upward(start, end, x=0.0, every=5.0):
    """Points along the y axis."""
    return [(x, y) for y, _ in straight(start, end, every=every)]


def crossing(**more):
    """A junction at (0, 0): from the west lanes 1, 2 in it, 3; from the south 4, 5, 6.

    Lane 7 is left of lane 1, with a broken line between. Lane 2 has a light, red for 3 s and green
    then, lane 5 a stop sign. Cars 70 (ego) from the west and 71 from the south drive 10 m/s.
    """
    times = [0.1 * k for k in range(81)]
    west = [state(-40.0 + k, 0.0, 0.0, (10.0, 0.0)) for k in range(81)]
    south = [state(0.0, -60.0 + k, 1.5707963, (0.0, 10.0)) for k in range(81)]
    red, green = ({2: (colour, (-10.0, 0.0))} for colour in (STOP, GO))
    parts = {
        "times": times,
        "tracks": [(70, VEHICLE, west), (71, VEHICLE, south)],
        "lights": [red if k <= 40 else green for k in range(81)],
        "features": [
            lane(
                1,
                straight(-60, -10),
                exits=[2],
                limit=45,
                left_lines=[(0, 10, 21, 1)],
                right_lines=[(0, 10, 22, 0)],
                left_lanes=[(7, 0, 10, 0, 10)],
            ),
            lane(2, straight(-10, 10), entries=[1], exits=[3]),
            lane(3, straight(10, 60), entries=[2], limit=45),
            lane(4, upward(-60, -10), exits=[5]),
            lane(5, upward(-10, 10), entries=[4], exits=[6]),
            lane(6, upward(10, 60), entries=[5]),
            lane(
                7,
                straight(-60, -10, 3.5),
                right_lines=[(0, 10, 21, 1)],
                right_lanes=[(1, 0, 10, 0, 10)],
            ),
            road_line(21, straight(-60, -10, 1.7, 10.0)),
            road_edge(22, straight(-60, -10, -1.9, 50.0)),
            stop_sign(31, [5], (2.0, -10.0)),
            crosswalk(41, [(12, -4), (15, -4), (15, 4), (12, 4)]),
        ],
    }
    return scenario(**{**parts, **more})
