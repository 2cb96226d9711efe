"""ASAM OSI traces written by hand: ground truth in messages with their sizes before them."""

import struct

from support.builders.wire_bytes import counted, double, whole

SECOND = 1_000_000_000


def identifier(number, value):
    """A field with an id, which is left out if it is None."""
    return b"" if value is None else counted(number, whole(1, value))


def vector(number, x, y):
    """A field with a place or a velocity."""
    return counted(number, double(1, x), double(2, y))


def timestamp(nanoseconds):
    """The time of a message."""
    seconds, nanos = divmod(nanoseconds, SECOND)
    return counted(2, whole(1, seconds), whole(2, nanos))


def vehicle(number, x, y, heading=0.0, speed=10.0, size=(4.0, 2.0), **more):
    """A moving object: ``kind`` and ``vehicle`` are types, ``lamps`` and ``role`` numbers."""
    base = [
        counted(1, double(1, size[0]), double(2, size[1])) if size else b"",
        vector(2, x, y),
        b"" if heading is None else counted(3, double(3, heading)),
        b"" if speed is None else vector(4, speed, 0.0),
    ]
    lamps = b"".join(whole(field, value) for field, value in more.get("lamps", {}).items())
    classification = [
        whole(1, more.get("vehicle", 4)),
        counted(2, lamps) if lamps else b"",
        whole(5, more["role"]) if "role" in more else b"",
    ]
    kind = more.get("kind", 2)
    classified = counted(6, *classification) if kind == 2 else b""
    return counted(5, identifier(1, number), counted(2, *base), whole(3, kind), classified)


def line(field, points):
    """Points of a centre line."""
    return b"".join(vector(field, x, y) for x, y in points)


def lane(number, points=(), forward=True, **more):
    """A lane: ids in ``left``, ``right`` (lanes), ``left_line``, ``right_line`` (boundaries),
    ``pairs`` of lanes before and after it; ``kind`` and ``subtype`` are numbers.
    """
    said = [whole(1, more.get("kind", 2)), line(3, points)]
    said += [whole(4, 1)] if forward else []
    for name, field in (("left", 5), ("right", 6), ("right_line", 8), ("left_line", 9)):
        said += [identifier(field, one) for one in more.get(name, ())]
    for before, after in more.get("pairs", ()):
        said.append(counted(7, identifier(1, before), identifier(2, after)))
    said.append(whole(12, more.get("subtype", 2)))
    return counted(10, identifier(1, number), counted(2, *said))


def boundary(number, points, kind=3):
    """A boundary: 2 no line, 3 solid, 4 dashed, 6 the road's edge."""
    bounds = b"".join(counted(2, vector(1, x, y)) for x, y in points)
    return counted(9, identifier(1, number), bounds, counted(3, whole(1, kind)))


def light(number, colour, mode, lanes, icon=2, place=(0.0, 0.0)):
    """A traffic light: colour 2 red, 3 yellow, 4 green; mode 2 off, 3 constant, 4 flashing."""
    said = [whole(1, colour), whole(2, icon), whole(3, mode)]
    said += [identifier(5, one) for one in lanes]
    return counted(7, identifier(1, number), counted(2, vector(2, *place)), counted(3, *said))


def sign(number, kind, lanes, value=None, unit=3, supplements=()):
    """A traffic sign, with numbers of the types of those below it."""
    said = [whole(2, kind)]
    said += [] if value is None else [counted(3, double(1, value), whole(2, unit))]
    said += [identifier(5, one) for one in lanes]
    below = [counted(3, counted(2, whole(2, one))) for one in supplements]
    return counted(6, identifier(1, number), counted(2, counted(2, *said)), *below)


def mark(number, sign_type, place, lanes, size=(0.01, 4.0, 0.5), yaw=0.0):
    """A mark that is painted for a sign: its height lies along the road."""
    base = [
        counted(1, *(double(k, x) for k, x in enumerate(size, 1))),
        vector(2, *place),
        counted(3, double(2, -1.5707963267948966), double(3, yaw)),
    ]
    said = [whole(1, 3), whole(2, sign_type), *(identifier(6, one) for one in lanes)]
    return counted(8, identifier(1, number), counted(2, *base), counted(3, *said))


def ground_truth(nanoseconds, *parts, host=None, country=None):
    """The bytes of a message."""
    more = b"" if country is None else whole(13, country)
    return b"".join((timestamp(nanoseconds), identifier(3, host), *parts, more))


def sensor_view(truth, host=None):
    """A view with ground truth in it."""
    return counted(7, truth) + identifier(8, host)


def sensor_data(*views):
    """Data of a sensor with the views that it was made from."""
    return b"".join(counted(8, view) for view in views)


def trace(messages):
    """The bytes of a file of messages."""
    return b"".join(struct.pack("<I", len(one)) + one for one in messages)


def every_element():
    """The messages of a small trace with most that is read."""
    lanes = lane(1, [(0, 0), (60, 1), (100, 0)], left_line=[11], right_line=[12], left=[2])
    lanes += boundary(11, [(0, 2), (100, 2)]) + boundary(12, [(0, -2), (100, -2)])
    lanes += lane(2, [(0, 4), (100, 4)], forward=False, right=[1], pairs=[(1, 3)])
    lanes += lane(60, kind=4, forward=None, pairs=[(1, 3)])
    lanes += lane(3, [(120, 0), (200, 0)])
    lanes += sign(5, 52, [1], 50.0) + mark(6, 17, (95, 0), [1])
    lanes += mark(7, 87, (50, 0), [1], size=(0.01, 8.0, 3.0))
    return [
        ground_truth(
            k * 100_000_000,
            vehicle(7, 10.0 + k, 0.0, lamps={1: 3, 7: 3}),
            vehicle(8, 30.0, 0.0, kind=3),
            light(9, 2 + k % 3, 3, [1]),
            lanes if k == 0 else b"",
            host=7,
            country=276,
        )
        for k in range(4)
    ]
