"""Logs and maps of 123D written by hand, as py123d 0.7 writes them; MessagePack of its own."""

import struct

import numpy as np
import pyarrow
import shapely
from pyarrow import ipc

AV2 = "py123d.parser.registry.AV2SensorBoxDetectionLabel"
CAR, PEDESTRIAN, BICYCLE, BICYCLIST, SIGN = 18, 16, 2, 3, 20
GREEN, YELLOW, RED, OFF, UNKNOWN = range(5)
SECOND_US = 1_000_000


def packed(value):
    """MessagePack of a value, by its specification; always in the longest form of lengths."""
    if value is None or isinstance(value, bool):
        return {None: b"\xc0", False: b"\xc2", True: b"\xc3"}[value]
    if isinstance(value, int):
        return struct.pack(">Bq", 0xD3, value)
    if isinstance(value, float):
        return struct.pack(">Bd", 0xCB, value)
    if isinstance(value, str):
        return struct.pack(">BI", 0xDB, len(value.encode())) + value.encode()
    if isinstance(value, bytes):
        return struct.pack(">BI", 0xC6, len(value)) + value
    if isinstance(value, np.ndarray):
        words = {b"__ndarray__": True, b"dtype": value.dtype.str, b"shape": list(value.shape)}
        return packed(words | {b"data": value.tobytes()})
    if isinstance(value, dict):
        inner = b"".join(packed(x) for pair in value.items() for x in pair)
        return struct.pack(">BI", 0xDF, len(value)) + inner
    return struct.pack(">BI", 0xDD, len(value)) + b"".join(map(packed, value))


def arrow_file(path, columns, said):
    """An Arrow file with columns (name -> type, values) and metadata."""
    fields = [pyarrow.field(name, kind) for name, (kind, _) in columns.items()]
    schema = pyarrow.schema(fields, metadata={b"metadata": packed(said)})
    arrays = [pyarrow.array(values, kind) for kind, values in columns.values()]
    with pyarrow.OSFile(str(path), "wb") as sink, ipc.new_file(sink, schema) as writer:
        writer.write_table(pyarrow.Table.from_arrays(arrays, schema=schema))
    return path


def pose(x, y, heading=0.0, z=0.0):
    """x, y, z and a quaternion (w, x, y, z)."""
    return [x, y, z, float(np.cos(heading / 2)), 0.0, 0.0, float(np.sin(heading / 2))]


def box(name, label, x, y, heading=0.0, size=(4.5, 1.9, 1.5)):
    return name, label, [*pose(x, y, heading), *size]


def write_log(folder, moments, boxes, ego, lights=None, said=None, labels=AV2):
    """A log: for each moment (µs) its boxes, and lights (lane -> status); ego's poses by moment.

    Ego is 4 m by 2 m, its middle 1 m ahead of its poses.
    """
    about = {"dataset": "av2-sensor", "split": "av2-sensor_val", "log_name": "some"}
    about |= {"location": "MIA", "version": "0.7.0", "map_metadata": None} | (said or {})
    times = pyarrow.int64(), moments
    vectors = pyarrow.list_(pyarrow.list_(pyarrow.float64(), 10))
    key = "box_detections_se3"
    arrow_file(
        folder / f"{key}.arrow",
        {
            f"{key}.timestamp_us": times,
            f"{key}.bounding_box_se3": (vectors, [[one[2] for one in row] for row in boxes]),
            f"{key}.track_token": (
                pyarrow.list_(pyarrow.string()),
                [[one[0] for one in row] for row in boxes],
            ),
            f"{key}.label": (
                pyarrow.list_(pyarrow.uint16()),
                [[one[1] for one in row] for row in boxes],
            ),
        },
        {"box_detection_label_class": labels},
    )
    key = "ego_state_se3"
    arrow_file(
        folder / f"{key}.arrow",
        {
            f"{key}.timestamp_us": (pyarrow.int64(), list(ego)),
            f"{key}.imu_se3": (pyarrow.list_(pyarrow.float64(), 7), list(ego.values())),
        },
        {"length": 4.0, "width": 2.0, "center_to_imu_se3": pose(1.0, 0.0)},
    )
    if lights is not None:
        key = "traffic_light_detections"
        arrow_file(
            folder / f"{key}.arrow",
            {
                f"{key}.timestamp_us": times,
                f"{key}.lane_id": (pyarrow.list_(pyarrow.int32()), [list(row) for row in lights]),
                f"{key}.status": (
                    pyarrow.list_(pyarrow.uint8()),
                    [list(row.values()) for row in lights],
                ),
            },
            {},
        )
    return arrow_file(folder / "sync.arrow", {"sync.timestamp_us": times}, about)


def line(*places, z=0.0):
    return np.array([(*place, z) for place in places], dtype=float)


def lane(name, left, right, **more):
    """A lane with other words in ``more``."""
    said = {"lane_type": 2, "lane_group_id": None, "left_boundary": left, "right_boundary": right}
    said |= {"left_lane_id": None, "right_lane_id": None, "predecessor_ids": []}
    said |= {"successor_ids": [], "speed_limit_mps": None} | more
    return 0, name, said, shapely.LineString(left[:, :2])


def lane_group(name, intersection=None):
    return 1, name, {"intersection_id": intersection}, shapely.Point(0, 0)


def crosswalk(name, *corners):
    return 3, name, {"outline": line(*corners, corners[0])}, shapely.Polygon(corners)


def stop_zone(name, kind, lanes, *corners):
    """A zone to stop in: kind 1 is that of a light, 2 of a stop sign, 3 of one to give way."""
    said = {"outline": line(*corners, corners[0]), "stop_zone_type": kind, "lane_ids": lanes}
    return 7, name, said, shapely.Polygon(corners)


def road_line(name, kind, *places):
    return 9, name, {"road_line_type": kind}, shapely.LineString(line(*places))


def write_map(folder, things, name="map.arrow", said=None):
    about = {"dataset": "av2-sensor", "location": "MIA", "map_is_per_log": True} | (said or {})
    columns = {
        "object_id": (pyarrow.int64(), [name for _, name, _, _ in things]),
        "map_layer": (pyarrow.int8(), [layer for layer, _, _, _ in things]),
        "features": (pyarrow.binary(), [packed(said) for _, _, said, _ in things]),
        "wkb": (pyarrow.binary(), [shapely.to_wkb(shape) for _, _, _, shape in things]),
    }
    return arrow_file(folder / name, columns, about)


def town():
    """Lanes 1 (left) and 2 east to x = 60, then 3 in an intersection; 4 back; a crosswalk at 40."""
    return [
        lane(
            1,
            line((0, 3.5), (60, 3.5)),
            line((0, 0), (60, 0)),
            right_lane_id=2,
            left_lane_id=4,
            successor_ids=[3, 99],
            speed_limit_mps=13.4,
            lane_group_id=10,
        ),
        lane(
            2,
            line((0, 0), (60, 0)),
            line((0, -3.5), (60, -3.5)),
            left_lane_id=1,
            lane_type=4,
            lane_group_id=10,
        ),
        lane(
            3,
            line((60, 3.5), (120, 3.5)),
            line((60, 0), (120, 0)),
            predecessor_ids=[1],
            lane_group_id=11,
        ),
        lane(4, line((60, 3.5), (0, 3.5)), line((60, 7), (0, 7)), left_lane_id=1),
        lane_group(10),
        lane_group(11, 7),
        crosswalk(5, (38, -4), (42, -4), (42, 8), (38, 8)),
        road_line(0, 6, (0, 3.5), (60, 3.5)),
        road_line(1, 4, (0, 0), (60, 0)),
        road_line(2, 12, (0, -3.5), (60, -3.5)),
        road_line(3, 11, (0, -3.5), (60, -3.5)),
        (6, 8, {"outline": line((0, 0), (1, 1), (0, 1))}, shapely.Point(0, 0)),
    ]


def drive(folder, steps=9):
    """Ego in lane 1 and a car ahead of it at 10 m/s, somebody on foot, somebody on a cycle."""
    moments = [SECOND_US + 100_000 * k for k in range(steps)]
    boxes = [
        [
            box("car", CAR, 30.0 + k, 1.75),
            box("walker", PEDESTRIAN, 40.0, -3.0 + 0.1 * k, np.pi / 2, (0.6, 0.6, 1.8)),
            box("rider", BICYCLIST, 10.0 + k, -1.75, 0.0, (0.6, 0.6, 1.8)),
            box("cycle", BICYCLE, 10.0 + k, -1.75, 0.0, (1.8, 0.5, 1.0)),
            box("board", SIGN, 5.0, 9.0),
        ]
        for k in range(steps)
    ]
    # Poses twice as often, and from before on
    ego = {SECOND_US + 50_000 * k: pose(5.0 + 0.5 * k, 1.75) for k in range(-3, 2 * steps)}
    lights = [{3: RED if k < 5 else GREEN, 99: RED} for k in range(steps)]
    write_map(folder, town())
    return write_log(folder, moments, boxes, ego, lights)
