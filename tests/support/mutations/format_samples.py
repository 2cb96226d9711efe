"""A small sample or several of every format of recordings and of maps, by the format's name."""

from __future__ import annotations

import gzip
import json
import pickle
import tempfile
from collections.abc import Callable, Iterator, Mapping
from functools import lru_cache
from pathlib import Path

from rulec.recordings.encodings.wire_format import WireFile
from rulec.recordings.waymo.waymo_file import WAYMO
from support.builders import argoverse_files as argoverse
from support.builders import lanelet2_files, mcap_files, opendrive_files, sumo_files
from support.builders import osi_traces as osi
from support.builders import track_tables as tables
from support.builders import waymo_files as waymo
from support.builders.recordings import ROAD_XML, SAMPLES
from support.builders.scenarionet_files import from_waymo
from support.mutations.sample import Packed, Sample

_TOP = Path(__file__).resolve().parents[3]
_PROTOBUF = _TOP / "tests/recordings/commonroad/samples"
_TOWN = json.dumps(argoverse.town())


def _gzipped(text: str) -> Packed:
    return Packed((text.encode(),), lambda parts: gzip.compress(parts[0], 1))


def _written(write: Callable[[Path], object]) -> dict[str, bytes]:
    """The files that are written to a folder."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        write(folder)
        files = (file for file in folder.rglob("*") if file.is_file())
        return {str(file.relative_to(folder)): file.read_bytes() for file in files}


def _commonroad() -> Iterator[Sample]:
    for number, text in enumerate(file.read_text(encoding="utf-8") for file in SAMPLES):
        name = f"DEU_Mutated-{number}_1_T-1.xml"
        yield Sample(name, {name: text})


def _commonroad_protobuf() -> Iterator[Sample]:
    files = {file.name: file.read_bytes() for file in sorted(_PROTOBUF.glob("*.pb"))}
    single = "DEU_SingleFile-1_1_T-1.pb"
    yield Sample(single, {single: files.pop(single)})
    for name in files:
        if "_T-1" in name:
            yield Sample(name, files)


def _sumo() -> Iterator[Sample]:
    cars = [
        sumo_files.moment(
            k / 10,
            sumo_files.body(x=20 + k, lane="in_1", signals=9, acceleration=0.5),
            sumo_files.body("p", 202, -7 + k, 1.2, 0, "person", element="person", edge=":x_c0"),
        )
        for k in range(9)
    ]
    fcd = sumo_files.data(*cars)
    beside = {"road.net.xml": sumo_files.ROAD_NET, "road.rou.xml": sumo_files.TYPES}
    yield Sample("fcd.xml", {"fcd.xml": fcd, **beside}, "road.net.xml")
    yield Sample("fcd.xml.gz", {"fcd.xml.gz": _gzipped(fcd), **beside}, "road.net.xml")


_MOTION = [
    *argoverse.rows_of("AV", "vehicle", {step: (10 + step, -1.75) for step in range(9)}),
    *argoverse.rows_of("7", "pedestrian", {step: (40, step) for step in range(3, 7)}),
]
_POSES = [argoverse.pose(10**9 + 10**8 * k, 20.0 + k, -1.75) for k in range(5)]
_BOXES = [
    argoverse.box(x["timestamp_ns"], name, category, 9.0, y)
    for x in _POSES
    for name, category, y in (("a", "REGULAR_VEHICLE", 0.0), ("b", "BICYCLIST", 2.0))
]


def _argoverse_motion() -> Iterator[Sample]:
    name = f"scenario_{argoverse.SCENARIO_ID}.parquet"
    roads = {f"log_map_archive_{argoverse.SCENARIO_ID}.json": _TOWN}
    files = _written(lambda folder: argoverse.write_motion(folder, _MOTION))
    yield Sample(name, {name: files[name], **roads})
    yield Sample(name, {name: argoverse.parquet_bytes(_MOTION), **roads})


def _argoverse_sensor() -> Iterator[Sample]:
    entry = "annotations.feather"
    files = _written(lambda folder: argoverse.write_log(folder, _BOXES, _POSES))
    yield Sample(entry, files)
    poses = {"city_SE3_egovehicle.feather": argoverse.feather_bytes(_POSES)}
    yield Sample(entry, files | poses | {entry: argoverse.feather_bytes(_BOXES)})


def _short_crossing(name: str) -> bytes:
    """The crossing with lanes, lights and signs, a car and a cycle for a second."""
    count = 11
    west = [waymo.state(-40.0 + k, 0.0, 0.0, (10.0, 0.0)) for k in range(count)]
    south = [waymo.state(0.0, k - 20.0, 1.5707963, (0.0, 10.0)) for k in range(count)]
    red, green = ({2: (colour, (-10.0, 0.0))} for colour in (waymo.STOP, waymo.GO))
    return waymo.crossing(
        id=name,
        times=[0.1 * k for k in range(count)],
        tracks=[(70, waymo.VEHICLE, west), (71, waymo.CYCLIST, south)],
        lights=[red if k <= 4 else green for k in range(count)],
    )


def _waymo() -> Iterator[Sample]:
    record = lru_cache(8)(waymo.record)
    parts = (_short_crossing("one"), _short_crossing("other"))
    packed = Packed(parts, lambda contents: b"".join(map(record, contents)))
    yield Sample("some.tfrecord", {"some.tfrecord": packed})


def _scenarionet() -> Iterator[Sample]:
    value = from_waymo(WireFile(_short_crossing("one"), Path("some.tfrecord"), WAYMO))
    for protocol in (2, 4, 5):
        yield Sample("some.pkl", {"some.pkl": pickle.dumps(value, protocol)})


def _highd() -> Iterator[Sample]:
    bodies = [(2, 0.0, 26.0, 30.0, 9), (1, 90.0, 9.5, 36.0, 9)]
    yield Sample("01_tracks.csv", _written(lambda folder: tables.highd(folder, bodies)))


def _levelx() -> Iterator[Sample]:
    bodies = [
        ("car", (4.5, 1.8), 0.0, (5, 0), 8.0, 9),
        ("pedestrian", (0.0, 0.0), 90.0, (20, -3), 1.2, 9),
    ]
    files = _written(lambda folder: tables.ind(folder, bodies))
    yield Sample("00_tracks.csv", {**files, "roads.csv": tables.LANES}, "roads.csv")


def _interaction() -> Iterator[Sample]:
    yield Sample("vehicle_tracks_007.csv", tables.interaction_files(), "lanes.csv")
    name = "DR_USA_Town_train.csv"
    cases = {name: tables.interaction_cases(), "lanes.csv": tables.LANES}
    yield Sample(name, cases, "lanes.csv")


def _ngsim() -> Iterator[Sample]:
    rows = [tables.ngsim_row(k) for k in range(9)]
    named = tables.table(f"{tables.NGSIM_HEAD},Location", *(f"{row},i-80" for row in rows))
    headless = "\n".join(row.replace(",", "  ") for row in rows) + "\n"
    for name, text in (("us101.csv", named), ("trajectories-0750.txt", headless)):
        yield Sample(name, {name: text, "lanes.csv": tables.LANES})


def _omega_prime() -> Iterator[Sample]:
    yield Sample("objects.csv", {"objects.csv": tables.omega_prime(), "lanes.csv": tables.LANES})


def _tracks() -> Iterator[Sample]:
    head = "track,t,x,y,type,heading,speed,length,brake_light,ego"
    rows = [
        *tables.driving("1", more=",car,0,10,4.5,0,1"),
        *tables.driving("2", speed=8.0, y=3.5, more=",truck,,8,9,,0"),
        *tables.driving("p", speed=0.0, y=-3.0, more=",pedestrian,1.5,0,,,"),
    ]
    cars = tables.table(head, *rows)
    yield Sample("cars.csv", {"cars.csv": cars, "lanes.csv": tables.LANES})
    packed = {"cars.csv.gz": _gzipped(cars), "lanes.csv": tables.LANES}
    yield Sample("cars.csv.gz", packed)
    plain = [
        dict(zip(("track", "t", "x", "y"), (f"{k % 2}", k // 2 / 10, float(k), 0.0), strict=True))
        for k in range(18)
    ]
    parquet = {"cars.parquet": argoverse.parquet_bytes(plain), "lanes.csv": tables.LANES}
    yield Sample("cars.parquet", parquet)


def _osi() -> Iterator[Sample]:
    truth = osi.every_element()
    views = tuple(osi.sensor_view(one, host=7) for one in truth)
    yield Sample("some.osi", {"some.osi": Packed(tuple(truth), osi.trace)})
    yield Sample("view.osi", {"view.osi": Packed(views, osi.trace)})
    for method in ("", "lz4", "zstd"):
        packed = Packed(tuple(truth), lambda parts, m=method: mcap_files.recorded(parts, method=m))
        yield Sample("some.mcap", {"some.mcap": packed})


RECORDINGS: Mapping[str, Callable[[], Iterator[Sample]]] = {
    "commonroad": _commonroad,
    "commonroad-protobuf": _commonroad_protobuf,
    "sumo": _sumo,
    "argoverse-motion": _argoverse_motion,
    "argoverse-sensor": _argoverse_sensor,
    "waymo": _waymo,
    "highd": _highd,
    "levelx": _levelx,
    "interaction": _interaction,
    "ngsim": _ngsim,
    "omega-prime": _omega_prime,
    "tracks": _tracks,
    "osi": _osi,
    "scenarionet": _scenarionet,
}
"""The samples of each format of recordings; mistakes may be in every file of a sample."""


def _alone(name: str, *texts: str | bytes | Packed) -> Callable[[], Iterator[Sample]]:
    return lambda: (Sample(name, {name: text}) for text in texts)


def _lanelet2() -> Iterator[Sample]:
    text = lanelet2_files.every_element()
    yield from _alone("map.osm", text, text.replace('lat="" lon=""', 'lat="49" lon="8"'))()


MAPS: Mapping[str, Callable[[], Iterator[Sample]]] = {
    "sumo": _alone("road.net.xml", sumo_files.ROAD_NET),
    "opendrive": _alone("made.xodr", opendrive_files.every_element()),
    "commonroad": _alone("road.xml", ROAD_XML),
    "lanelet2": _lanelet2,
    "lanes": _alone("lanes.csv", tables.LANES, tables.EVERY_COLUMN_OF_LANES),
    "argoverse": _alone("log_map_archive_a.json", _TOWN),
}
"""The samples of each format of maps."""
