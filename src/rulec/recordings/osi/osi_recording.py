"""An ASAM OSI trace as one recording."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from glob import escape
from pathlib import Path

from rulec.diagnostics import RulecError, SourceLocation, first_of
from rulec.recordings.adjacency import side_by_lanes
from rulec.recordings.commonroad.countries import country_of, side_in
from rulec.recordings.encodings.wire_format import Fields, Table, WireFile
from rulec.recordings.map_files import MAP_FORMATS, read_map
from rulec.recordings.osi.lane_messages import check_size, read_boundaries, read_lanes
from rulec.recordings.osi.lane_network import LaneNetwork, lane_network
from rulec.recordings.osi.light_heads import Bulb, with_lights
from rulec.recordings.osi.logical_lanes import (
    lanes_by_logical,
    logical_boundaries,
    logical_lanes,
    with_logical,
)
from rulec.recordings.osi.message_fields import decoded, id_of, part
from rulec.recordings.osi.message_times import TimeGrid, time_grid
from rulec.recordings.osi.moving_objects import MovingObject, participants, standing
from rulec.recordings.osi.osi_tables import STATIC
from rulec.recordings.osi.signs_and_marks import with_crossings, with_signs, with_stop_lines
from rulec.recordings.osi.trace_file import OSI, Frame, frames
from rulec.recordings.recording import (
    MOST_STEPS,
    Lanelet,
    Participant,
    Recording,
    Side,
    Weather,
    is_lane,
)
from rulec.recordings.recording_format import Glance
from rulec.recordings.recording_messages import NET_MISSING

MOST_STATIC_BYTES = 200_000_000
"""Limit on the bytes of all lanes, boundaries, signs and other static messages, each once."""

MOST_OBJECTS = 100_000
_ONLY_ID: Table = {1: STATIC["lane"][1]}


@dataclass(slots=True)
class TraceContent:
    """A trace read so far. ``static``: kind -> id -> message."""

    times: list[int] = field(default_factory=list)
    objects: dict[str, MovingObject] = field(default_factory=dict)
    bulbs: dict[str, Bulb] = field(default_factory=dict)
    static: dict[str, dict[str, Fields]] = field(default_factory=lambda: {x: {} for x in STATIC})
    environment: Fields = field(default_factory=dict)
    country: int = 0
    host: str | None = None
    changing_signs: set[str] = field(default_factory=set)
    skipped: int = 0
    _bytes: int = 0
    _latest: dict[str, list[bytes]] = field(default_factory=dict)
    _first: dict[str, dict[str, bytes]] = field(default_factory=lambda: {x: {} for x in STATIC})

    def add(self, frame: Frame) -> None:
        """Add the contents of a frame. Raises RulecError R0610."""
        if self.times and frame.time <= self.times[-1]:
            if frame.time == self.times[-1]:
                # Several sensors may have a view of one moment
                self.skipped += 1
                return
            raise _wrong(frame.file, "its time is before that of the message before it")
        if len(self.times) == MOST_STEPS:
            raise _wrong(frame.file, f"there are more than {MOST_STEPS:,} of them")
        moment = len(self.times)
        self.times.append(frame.time)
        truth = frame.ground_truth
        self.host = self.host or frame.host
        self.country = self.country or truth.get("country_code", 0)
        self.environment = self.environment or truth.get("environmental_conditions", {})
        for fields in truth.get("moving_object", ()):
            self._add_object(moment, fields, frame.file)
        for fields in truth.get("traffic_light", ()):
            self._add_bulb(moment, fields, frame.file)
        for kind, table in STATIC.items():
            if kind in truth:
                self._add_static(kind, table, truth[kind], frame.file)

    def _add_object(self, moment: int, fields: Fields, file: WireFile) -> None:
        key = _id(fields, "a moving object", file)
        body = self.objects.get(key)
        if body is None:
            self._check_count(len(self.objects), file)
            body = self.objects[key] = MovingObject()
        body.add(moment, fields, file)

    def _add_bulb(self, moment: int, fields: Fields, file: WireFile) -> None:
        key = _id(fields, "a traffic light", file)
        bulb = self.bulbs.get(key)
        if bulb is None:
            self._check_count(len(self.bulbs), file)
            bulb = self.bulbs[key] = Bulb.of(key, fields, file)
        bulb.add(moment, fields)

    def _check_count(self, count: int, file: WireFile) -> None:
        if count == MOST_OBJECTS:
            raise _wrong(file, f"it has more than {MOST_OBJECTS:,} objects or lights")

    def _add_static(self, kind: str, table: Table, messages: list[bytes], file: WireFile) -> None:
        latest = self._latest.get(kind)
        if messages == latest:
            return
        known = set(latest or ())
        self._latest[kind] = messages
        for data in messages:
            if data in known:
                continue
            key = _id(decoded(data, _ONLY_ID, file), f"a message of `{kind}`", file)
            if key not in self.static[kind]:
                self._bytes += len(data)
                if self._bytes > MOST_STATIC_BYTES:
                    why = f"lanes, signs and the like have more than {MOST_STATIC_BYTES:,} bytes"
                    raise _wrong(file, why)
                self.static[kind][key] = decoded(data, table, file)
                if kind == "traffic_sign":
                    self._first[kind][key] = data
            elif kind == "traffic_sign" and data != self._first[kind][key]:
                self.changing_signs.add(key)


def read_content(path: Path) -> TraceContent:
    """Read a trace. Raises RulecError R0610, R0701."""
    content = TraceContent()
    for frame in frames(path):
        content.add(frame)
    if not content.times:
        raise OSI.refused(path, "its messages have no ground truth in them")
    return content


def _id(fields: Fields, name: str, file: WireFile) -> str:
    key = id_of(fields)
    if key is None:
        raise _wrong(file, f"{name} has no `id`")
    return key


def _wrong(file: WireFile, why: str) -> RulecError:
    return file.form.refused(file.path, why)


_RAIN = frozenset({"light", "moderate", "heavy", "very_heavy", "extreme"})
_FALLS: Mapping[str, bool] = {"none": False, "very_light": True, **dict.fromkeys(_RAIN, True)}
_DARK: Mapping[str, bool] = {
    **dict.fromkeys(("level1", "level2", "level3", "level4"), True),
    **dict.fromkeys(("level8", "level9"), False),
}
"""Ambient light level -> dark: true below 10 lx, false from 1,000 lx.

Between, it may be overcast.
"""

_FAR = frozenset({"excellent", "good", "moderate", "poor", "mist"})
_FAR_M = 1000.0
"""The standard calls it fog below 1000 m of visibility; lighter haze has levels of its own."""


def weather_of(environment: Fields, lanes: Iterable[Fields]) -> Weather:
    """The weather: wet if it rains or any lane has water on it, icy if any lane has ice.

    It is dry, or free of ice, only if all lanes with surface data say so.
    """
    roads = [part(lane, "classification", "road_condition") for lane in lanes]
    water = [road["surface_water_film"] for road in roads if "surface_water_film" in road]
    ice = [road["surface_ice"] for road in roads if "surface_ice" in road]
    rain = environment.get("precipitation", "unknown")
    wet = any(film > 0 for film in water) if water else None
    if rain in _RAIN:
        wet = True
    icy = any(part > 0 for part in ice) if ice else None
    return Weather(
        wet,
        icy,
        _FAR_M if environment.get("fog") in _FAR else None,
        raining=_FALLS.get(rain),
        night=_DARK.get(environment.get("ambient_illumination", "unknown")),
    )


_NAMED = 5

_USUAL_SIDE: Side = "right"
"""The side of traffic assumed for OpenDRIVE roads that give none."""


def read_osi(path: Path, map_path: Path | None = None) -> Recording:
    """Read a trace, on its own lanes or on those of a map.

    Raises RulecError R0610 for a file that is not of the right format, R0614 if it has no lanes and
    there is no map, R0701 if a file cannot be opened.
    """
    content = read_content(path)
    grid = time_grid(path, content.times)
    file = WireFile(b"", path, OSI)
    if not content.objects:
        raise OSI.refused(path, "it contains no road users")
    network = _network(content, file)
    if map_path is None and not any(is_lane(x) for x in network.lanelets.values()):
        map_path = _map_beside(path)
    road = None if map_path is None else read_map(map_path, grid.step_s)
    country = country_of(f"{content.country:03}")
    if road is None:
        lanelets: Mapping[str, Lanelet] = _lanelets(content, network, grid, file)
        side: Side | None = side_by_lanes(network.lanelets.values()) or _USUAL_SIDE
    else:
        lanelets, side = road.lanelets, road.side
    return Recording(
        name=path.name.split(".")[0] or path.name,
        step_s=grid.step_s,
        lanelets=lanelets,
        participants=tuple(_participants(content, grid, file)),
        form="ASAM OSI trace",
        side=side_in(country) or side,
        remarks=(
            *_remarks(content, grid),
            *(_network_remarks(network) if road is None else road.remarks),
        ),
        country=country or ("" if road is None else road.country),
        complete=frozenset() if road is None else road.complete,
        weather=weather_of(content.environment, content.static["lane"].values()),
        ego=content.host if content.host and content.host in content.objects else "",
    )


def _network(content: TraceContent, file: WireFile) -> LaneNetwork:
    """The lanelets of a trace: from its lanes, else from its logical lanes."""
    messages = content.static
    boundaries = read_boundaries(messages["lane_boundary"], file)
    lanes = read_lanes(messages["lane"], file)
    logical = logical_lanes(messages["logical_lane"], file)
    if lanes:
        lanes = with_logical(lanes, logical)
    else:
        lanes = [lane.lane for lane in logical]
        logical_bounds = messages["logical_lane_boundary"]
        boundaries = logical_boundaries(logical_bounds, boundaries, file)
    check_size(lanes, boundaries, file)
    network = lane_network(lanes, boundaries)
    for name, physical in lanes_by_logical(logical).items():
        parts = [x for lane in physical for x in network.of_lane.get(lane, ())]
        network.of_lane.setdefault(name, tuple(parts))
    return network


def _lanelets(
    content: TraceContent, network: LaneNetwork, grid: TimeGrid, file: WireFile
) -> dict[str, Lanelet]:
    """The lanelets with their signs, lights and road markings."""
    lanelets = with_lights(network.lanelets, content.bulbs.values(), network.of_lane, grid)
    signs = content.static["traffic_sign"]
    lanelets = with_signs(lanelets, signs, network.of_lane, content.changing_signs, file)
    marks = content.static["road_marking"]
    lanelets = with_stop_lines(lanelets, marks.values(), network.of_lane, file)
    return with_crossings(lanelets, marks, network.of_lane, file)


def _participants(content: TraceContent, grid: TimeGrid, file: WireFile) -> Iterator[Participant]:
    yield from participants(content.objects, grid)
    things = content.static["stationary_object"].items()
    named = ((f"{key}_standing" if key in content.objects else key, x) for key, x in things)
    yield from standing(named, file)


def _map_beside(path: Path) -> Path:
    """The map next to a trace with the same name. Raises RulecError R0614 if there is none."""
    stem = path.name.split(".")[0]
    for beside in sorted(path.parent.glob(f"{escape(stem)}.*")):
        if beside != path and any(form.recognises(Glance(beside)) for form in MAP_FORMATS):
            return beside
    raise NET_MISSING.error(
        SourceLocation(str(path)),
        "the trace has no lanes in it, and no map of its name is beside it",
        help="name the map with --map FILE",
    )


def _remarks(content: TraceContent, grid: TimeGrid) -> Iterator[str]:
    if not grid.is_even:
        yield (
            f"times are up to {grid.off_s * 1000:.1f} ms off steps of {grid.step_s:g} s, and are"
            " taken to be on them"
        )
    if content.skipped:
        yield f"{content.skipped:,} messages have the time of the one before and are left out"
    sizes = [key for key, body in content.objects.items() if body.size is None]
    if sizes:
        yield f"missing sizes are assumed to be usual: of {_some(sizes)}"
    lost = [bulb.id for bulb in content.bulbs.values() if not bulb.lanes]
    if lost:
        yield f"traffic lights are assigned to no lane, and left out: {_some(lost)}"
    if content.changing_signs:
        yield f"what signs show that change is unknown: {_some(sorted(content.changing_signs))}"


def _network_remarks(network: LaneNetwork) -> Iterator[str]:
    for names, what in (
        (network.assumed, "lanes without boundaries are assumed to have the usual width"),
        (
            network.undirected,
            "traffic is assumed to follow the points of lanes without a direction",
        ),
        (
            network.across,
            "ways across areas of intersections are assumed to be curves between lanes",
        ),
        (network.shapeless, "lanes with neither a middle nor boundaries are left out"),
        (network.apart, "lanes that are declared connected but do not meet"),
    ):
        if names:
            yield f"{what}: {_some(names)}"


def _some(names: list[str]) -> str:
    return first_of(names, _NAMED)
