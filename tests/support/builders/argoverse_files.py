"""Files as Argoverse 2 has them, of a small town that is made up here.

A street along the x axis: two lanes lead along it below it, one back above it. From 60 m on it is a
junction. Some paint divides them; a crossing lies at 40 m.
"""

import io
import json

import numpy as np
import pyarrow
from pyarrow import feather, parquet

SCENARIO_ID = "00000000-1111-2222-3333-444444444444"
LOG_ID = "55555555-6666-7777-8888-999999999999"


def line(*places):
    return [{"x": float(x), "y": float(y), "z": 0.0} for x, y in places]


def along(start, end, y):
    """A line along the x axis."""
    return line((start, y), (end, y))


def segment(number, left, right, **more):
    return {
        "id": number,
        "is_intersection": False,
        "lane_type": "VEHICLE",
        "left_lane_boundary": left,
        "right_lane_boundary": right,
        "left_lane_mark_type": "NONE",
        "right_lane_mark_type": "NONE",
        "successors": [],
        "predecessors": [],
        "left_neighbor_id": None,
        "right_neighbor_id": None,
    } | more


def town():
    segments = [
        segment(
            10,
            along(0, 60, 0),
            line((0, -3.5), (30, -3.5), (60, -3.5)),
            left_lane_mark_type="DOUBLE_SOLID_YELLOW",
            right_lane_mark_type="DASHED_WHITE",
            successors=[12, 999],
            left_neighbor_id=20,
            right_neighbor_id=11,
        ),
        segment(
            11,
            along(0, 60, -3.5),
            along(0, 60, -7),
            left_lane_mark_type="DASHED_WHITE",
            right_lane_mark_type="SOLID_WHITE",
            left_neighbor_id=10,
        ),
        segment(12, along(60, 120, 0), along(60, 120, -3.5), is_intersection=True),
        segment(
            20,
            along(60, 0, 0),
            along(60, 0, 3.5),
            left_lane_mark_type="DOUBLE_SOLID_YELLOW",
            left_neighbor_id=10,
        ),
    ]
    crossing = {"id": 30, "edge1": line((38, -8), (38, 5)), "edge2": line((42, 5), (42, -8))}
    return {
        "lane_segments": {str(x["id"]): x for x in segments},
        "pedestrian_crossings": {"30": crossing},
        "drivable_areas": {"7": {"id": 7, "area_boundary": along(0, 60, 4)}},
    }


def write_map(folder, content=None, log=SCENARIO_ID):
    path = folder / f"log_map_archive_{log}.json"
    path.write_text(json.dumps(town() if content is None else content))
    return path


def rows_of(name, kind, places, heading=0.0, **more):
    """Rows of a track: places by time step."""
    steps = sorted(places)
    velocities = [(10.0 * (np.cos(heading)), 10.0 * np.sin(heading)) for _ in steps]
    return [
        {
            "observed": step < 50,
            "track_id": name,
            "object_type": kind,
            "object_category": 2,
            "timestep": step,
            "position_x": float(places[step][0]),
            "position_y": float(places[step][1]),
            "heading": heading,
            "velocity_x": velocity[0],
            "velocity_y": velocity[1],
            "scenario_id": SCENARIO_ID,
            "focal_track_id": name,
            "city": "austin",
        }
        | more
        for step, velocity in zip(steps, velocities, strict=True)
    ]


def write_motion(folder, rows, content=None):
    """A scenario and its map."""
    write_map(folder, content)
    path = folder / f"scenario_{SCENARIO_ID}.parquet"
    parquet.write_table(pyarrow.Table.from_pylist(rows), path)
    return path


def turned(angle):
    """The quaternion (w, x, y, z) of a turn about the z axis."""
    return float(np.cos(angle / 2)), 0.0, 0.0, float(np.sin(angle / 2))


def pose(moment, x, y, angle=0.0, z=0.0, **more):
    names = ("qw", "qx", "qy", "qz")
    quaternion = dict(zip(names, turned(angle), strict=True))
    return {"timestamp_ns": moment, **quaternion, "tx_m": x, "ty_m": y, "tz_m": z} | more


def box(moment, name, category, x, y, **more):
    """An annotation in ego's frame."""
    size = {"length_m": 4.5, "width_m": 1.9, "height_m": 1.5, "num_interior_pts": 9}
    sized = {key: more.pop(key, value) for key, value in size.items()}
    return {"track_uuid": name, "category": category, **sized, **pose(moment, x, y, **more)}


def write_log(folder, boxes, poses, content=None):
    """A sensor log: its annotations, poses, and its map."""
    (folder / "map").mkdir(parents=True, exist_ok=True)
    write_map(folder / "map", content, f"{LOG_ID}____PIT_city_31495")
    feather.write_feather(pyarrow.Table.from_pylist(poses), folder / "city_SE3_egovehicle.feather")
    path = folder / "annotations.feather"
    feather.write_feather(pyarrow.Table.from_pylist(boxes), path)
    return path


def parquet_bytes(rows):
    """The rows as Parquet that is not packed, so that mistakes in it change values."""
    stream = io.BytesIO()
    parquet.write_table(pyarrow.Table.from_pylist(rows), stream, compression="none")
    return stream.getvalue()


def feather_bytes(rows):
    """The rows as Feather that is not packed."""
    stream = io.BytesIO()
    feather.write_feather(pyarrow.Table.from_pylist(rows), stream, compression="uncompressed")
    return stream.getvalue()
