"""The street in many formats: each writer makes a file in a folder, and names who is in it.

By the formats' own documents; with the builders that tests of the readers have for what is packed.
"""

import json
import pickle
from pathlib import Path

import numpy as np
import pyarrow
from pyarrow import parquet

from rulec.recordings.encodings.wire_format import WireFile
from rulec.recordings.waymo.waymo_file import WAYMO
from support.builders import argoverse_files as argoverse
from support.builders import osi_traces as osi
from support.builders import sumo_files as sumo
from support.builders import waymo_files as waymo
from support.builders.scenarionet_files import from_waymo
from support.builders.wire_bytes import counted, double, whole
from support.parity.street import (
    BACK,
    BEGINS,
    ENDS,
    LANE_M,
    LEFT,
    LENGTH,
    LIMIT_KMH,
    RIGHT,
    STEP_S,
    WIDTH,
)

LIMIT_MPS = LIMIT_KMH / 3.6
_EDGE, _BROKEN, _SOLID, _FAR_EDGE = -2 * LANE_M, -LANE_M, 0.0, LANE_M
"""The lines by y, from the right to the left."""


def _times(cars):
    return range(len(cars[0].x))


def commonroad(folder, cars):
    lanes = [
        _lanelet(1, (_BROKEN, "dashed"), (_EDGE, "solid"), left=(2, "same")),
        _lanelet(
            2, (_SOLID, "solid"), (_BROKEN, "dashed"), left=(3, "opposite"), right=(1, "same")
        ),
        _lanelet(3, (_SOLID, "solid"), (_FAR_EDGE, "solid"), left=(2, "opposite"), back=True),
    ]
    head = (
        'commonRoadVersion="2018b" benchmarkID="DEU_Parity-1_1_T-1" timeStepSize="0.1" author="" '
        'affiliation="" source="" tags="" date="2020-01-01"'
    )
    bodies = "".join(_obstacle(car) for car in cars)
    file = folder / "DEU_Parity-1_1_T-1.xml"
    file.write_text(f"<commonRoad {head}>{''.join(lanes)}{bodies}</commonRoad>")
    return file, {str(100 + car.number): car.number for car in cars}


def _lanelet(name, left_bound, right_bound, left=None, right=None, back=False):
    ends = (ENDS, BEGINS) if back else (BEGINS, ENDS)
    parts = []
    for side, (y, mark) in (("left", left_bound), ("right", right_bound)):
        points = "".join(f"<point><x>{x}</x><y>{y}</y></point>" for x in ends)
        parts.append(f"<{side}Bound>{points}<lineMarking>{mark}</lineMarking></{side}Bound>")
    for side, beside in (("Left", left), ("Right", right)):
        if beside:
            parts.append(f'<adjacent{side} ref="{beside[0]}" drivingDir="{beside[1]}"/>')
    parts.append(f"<speedLimit>{LIMIT_MPS!r}</speedLimit>")
    return f'<lanelet id="{name}">{"".join(parts)}</lanelet>'


def _obstacle(car):
    states = [
        f"<position><point><x>{x!r}</x><y>{y!r}</y></point></position>"
        f"<orientation><exact>{heading!r}</exact></orientation>"
        f"<time><exact>{k}</exact></time><velocity><exact>{speed!r}</exact></velocity>"
        for k, (x, y, heading, speed) in enumerate(
            zip(*(part.tolist() for part in (car.x, car.y, car.heading, car.speed)), strict=True)
        )
    ]
    shape = f"<rectangle><length>{LENGTH}</length><width>{WIDTH}</width></rectangle>"
    rest = "".join(f"<state>{state}</state>" for state in states[1:])
    return (
        f'<obstacle id="{100 + car.number}"><role>dynamic</role><type>car</type>'
        f"<shape>{shape}</shape><initialState>{states[0]}</initialState>"
        f"<trajectory>{rest}</trajectory></obstacle>"
    )


_NET = f"""\
<net version="1.20">
  <edge id="east" from="a" to="b" priority="3">
    <lane id="east_0" index="0" speed="{LIMIT_MPS!r}" length="{ENDS - BEGINS}" width="{LANE_M}"
      shape="{BEGINS},{RIGHT} {ENDS},{RIGHT}"/>
    <lane id="east_1" index="1" speed="{LIMIT_MPS!r}" length="{ENDS - BEGINS}" width="{LANE_M}"
      shape="{BEGINS},{LEFT} {ENDS},{LEFT}"/>
  </edge>
  <edge id="west" from="b" to="a" priority="3">
    <lane id="west_0" index="0" speed="{LIMIT_MPS!r}" length="{ENDS - BEGINS}" width="{LANE_M}"
      shape="{ENDS},{BACK} {BEGINS},{BACK}"/>
  </edge>
</net>
"""
_KINDS = f"""\
<routes>
  <vType id="own" vClass="passenger" length="{LENGTH}" width="{WIDTH}"/>
</routes>
"""


def sumo_fcd(folder, cars):
    """Places are those of the front; angles count from north, clockwise."""
    moments = []
    for k in _times(cars):
        bodies = []
        for car in cars:
            heading = car.heading[k]
            x = car.x[k] + LENGTH / 2 * np.cos(heading)
            y = car.y[k] + LENGTH / 2 * np.sin(heading)
            lane = "east_0" if car.y[k] < _BROKEN else "east_1" if car.y[k] < 0 else "west_0"
            angle = (90 - np.degrees(heading)) % 360
            bodies.append(
                sumo.body(
                    f"c{car.number}",
                    f"{x:.6f}",
                    f"{y:.6f}",
                    f"{car.speed[k]:.6f}",
                    f"{angle:.6f}",
                    "own",
                    lane=lane,
                )
            )
        moments.append(sumo.moment(k * STEP_S, *bodies))
    file = sumo.written(folder, sumo.data(*moments), _NET, _KINDS)
    return file, {f"c{car.number}": car.number for car in cars}


_HEAD = ("track", "t", "x", "y", "type", "heading", "speed", "length", "width")


def _rows(cars):
    for car in cars:
        for k in _times(cars):
            numbers = (float(part[k]) for part in (car.heading, car.speed))
            place = float(car.x[k]), float(car.y[k])
            yield (f"c{car.number}", k / 10, *place, "car", *numbers, LENGTH, WIDTH)


def _lanes():
    rows = ["lane,x,y,width,limit_kmh,left_mark,right_mark"]
    for name, y, left, right in (
        ("right", RIGHT, "broken", "solid"),
        ("left", LEFT, "solid", "broken"),
        ("back", BACK, "solid", "solid"),
    ):
        ends = (ENDS, BEGINS) if name == "back" else (BEGINS, ENDS)
        rows += [f"{name},{x},{y},{LANE_M},{LIMIT_KMH},{left},{right}" for x in ends]
    return "\n".join(rows) + "\n"


def table_csv(folder, cars):
    (folder / "lanes.csv").write_text(_lanes())
    file = folder / "cars.csv"
    rows = [",".join(map(str, row)) for row in (_HEAD, *_rows(cars))]
    file.write_text("\n".join(rows) + "\n")
    return file, {f"c{car.number}": car.number for car in cars}


def table_parquet(folder, cars):
    (folder / "lanes.csv").write_text(_lanes())
    file = folder / "cars.parquet"
    columns = dict(zip(_HEAD, zip(*_rows(cars), strict=True), strict=True))
    parquet.write_table(pyarrow.table({name: list(of) for name, of in columns.items()}), file)
    return file, {f"c{car.number}": car.number for car in cars}


def osi_trace(folder, cars):
    ways = {1: (RIGHT, False), 2: (LEFT, False), 3: (BACK, True)}
    points = {
        name: [((ENDS if back else BEGINS), y), ((BEGINS if back else ENDS), y)]
        for name, (y, back) in ways.items()
    }
    lanes = osi.lane(1, points[1], left=[2], left_line=[12], right_line=[11])
    lanes += osi.lane(2, points[2], left=[3], right=[1], left_line=[13], right_line=[12])
    lanes += osi.lane(3, points[3], left=[2], left_line=[13], right_line=[14])
    for name, y, kind in ((11, _EDGE, 3), (12, _BROKEN, 4), (13, _SOLID, 3), (14, _FAR_EDGE, 3)):
        lanes += osi.boundary(name, [(BEGINS, y), (ENDS, y)], kind)
    for name in ways:
        lanes += osi.sign(20 + name, 52, [name], LIMIT_KMH)
    messages = [
        osi.ground_truth(
            k * osi.SECOND // 10,
            *(_osi_car(car, k) for car in cars),
            lanes if k == 0 else b"",
            country=276,
        )
        for k in _times(cars)
    ]
    file = folder / "parity.osi"
    file.write_bytes(osi.trace(messages))
    return file, {str(100 + car.number): car.number for car in cars}


def _osi_car(car, k):
    vx, vy = car.velocity
    base = (
        counted(1, double(1, LENGTH), double(2, WIDTH)),
        osi.vector(2, car.x[k], car.y[k]),
        counted(3, double(3, car.heading[k])),
        osi.vector(4, vx[k], vy[k]),
    )
    name = osi.identifier(1, 100 + car.number)
    return counted(5, name, counted(2, *base), whole(3, 2), counted(6, whole(1, 4)))


def argoverse_motion(folder, cars):
    def bound(y, back=False):
        return argoverse.along(*((ENDS, BEGINS) if back else (BEGINS, ENDS)), y)

    white, solid, yellow = "DASHED_WHITE", "SOLID_WHITE", "SOLID_YELLOW"
    marks = ("left_lane_mark_type", "right_lane_mark_type")
    segments = [
        argoverse.segment(
            1,
            bound(_BROKEN),
            bound(_EDGE),
            left_neighbor_id=2,
            **dict(zip(marks, (white, solid), strict=True)),
        ),
        argoverse.segment(
            2,
            bound(_SOLID),
            bound(_BROKEN),
            left_neighbor_id=3,
            right_neighbor_id=1,
            **dict(zip(marks, (yellow, white), strict=True)),
        ),
        argoverse.segment(
            3,
            bound(_SOLID, back=True),
            bound(_FAR_EDGE, back=True),
            left_neighbor_id=2,
            **dict(zip(marks, (yellow, solid), strict=True)),
        ),
    ]
    content = {"lane_segments": {str(one["id"]): one for one in segments}}
    content |= {"pedestrian_crossings": {}, "drivable_areas": {}}
    rows = []
    for car in cars:
        (vx, vy), name = car.velocity, f"c{car.number}"
        for k in _times(cars):
            (row,) = argoverse.rows_of(
                name,
                "vehicle",
                {k: (car.x[k], car.y[k])},
                float(car.heading[k]),
                velocity_x=float(vx[k]),
                velocity_y=float(vy[k]),
            )
            rows.append(row)
    file = argoverse.write_motion(folder, rows, json.loads(json.dumps(content)))
    return file, {f"c{car.number}": car.number for car in cars}


def _waymo_bytes(cars):
    points = {False: waymo.straight(BEGINS, ENDS, every=10.0)}
    points[True] = points[False][::-1]

    def at(y, back=False):
        return [(x, y) for x, _ in points[back]]

    last, mph = len(points[False]) - 1, LIMIT_KMH / 1.609344
    features = [
        waymo.lane(
            1,
            at(RIGHT),
            limit=mph,
            left_lines=[(0, last, 12, 1)],
            right_lines=[(0, last, 11, 2)],
            left_lanes=[(2, 0, last, 0, last)],
        ),
        waymo.lane(
            2,
            at(LEFT),
            limit=mph,
            left_lines=[(0, last, 13, 6)],
            right_lines=[(0, last, 12, 1)],
            right_lanes=[(1, 0, last, 0, last)],
        ),
        waymo.lane(
            3,
            at(BACK, back=True),
            limit=mph,
            left_lines=[(0, last, 13, 6)],
            right_lines=[(0, last, 14, 2)],
        ),
        *(waymo.road_line(name, at(y), kind) for name, y, kind in _WAYMO_LINES),
    ]
    tracks = []
    for car in cars:
        vx, vy = car.velocity
        states = [
            waymo.state(car.x[k], car.y[k], car.heading[k], (vx[k], vy[k]), (LENGTH, WIDTH))
            for k in _times(cars)
        ]
        tracks.append((100 + car.number, waymo.VEHICLE, states))
    times = [k / 10 for k in _times(cars)]
    return waymo.scenario(id="parity", times=times, tracks=tracks, features=features)


_WAYMO_LINES = ((11, _EDGE, 2), (12, _BROKEN, 1), (13, _SOLID, 6), (14, _FAR_EDGE, 2))
"""Lines and their kinds: broken and solid white ones, a solid yellow one."""


def waymo_records(folder, cars):
    file = folder / "parity.tfrecord"
    file.write_bytes(waymo.record(_waymo_bytes(cars)))
    return file, {str(100 + car.number): car.number for car in cars}


def scenarionet(folder, cars):
    file = folder / "parity.pkl"
    wire = WireFile(_waymo_bytes(cars), Path("parity.tfrecord"), WAYMO)
    file.write_bytes(pickle.dumps(from_waymo(wire), 4))
    return file, {str(100 + car.number): car.number for car in cars}


WRITERS = {
    "CommonRoad": commonroad,
    "SUMO": sumo_fcd,
    "CSV": table_csv,
    "Parquet": table_parquet,
    "OSI": osi_trace,
    "Argoverse 2": argoverse_motion,
    "Waymo": waymo_records,
    "ScenarioNet": scenarionet,
}
