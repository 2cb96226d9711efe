"""Conversion of a scenario file's tables into a ``Scenario``."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from itertools import pairwise
from typing import TypeVar

from rulec.diagnostics import RulecError
from rulec.scenario.geometry import Box
from rulec.scenario.motion import swept
from rulec.scenario.motion_bounds import read_bounds
from rulec.scenario.scenario_model import Ego, MissingLane, Road, Scenario, SignalValue, Stretch
from rulec.scenario.time_grid import timing
from rulec.scenario.toml.obstacle_tables import (
    LocatedObstacle,
    places_of,
    read_obstacles,
    read_signals,
)
from rulec.scenario.toml.schema import (
    MOST_STRETCHES,
    RawEgo,
    RawGoal,
    RawMissing,
    RawRoad,
    RawScenario,
    RawSurface,
)
from rulec.scenario.toml.toml_tables import TomlFile, TomlTable, quoted

NARROWEST_M = 0.01

_Part = TypeVar("_Part", RawSurface, RawMissing)


def to_scenario(raw: Mapping[str, object], name: str, file: TomlFile) -> Scenario:
    """The scenario that the tables describe, called ``name`` if they do not contain a name.

    Raises RulecError with every mistake that was found.
    """
    table = TomlTable(file, "the scenario", "")
    top = table.read(RawScenario, raw)
    road = _road(raw.get("road"), file)
    ego = _ego(raw.get("ego"), file)
    obstacles = read_obstacles(raw.get("obstacle"), file)
    signals = _signals(raw.get("signals"), obstacles, file)
    goal = _goal(raw["goal"], road, file) if "goal" in raw else None
    if top is not None:
        try:
            timing(top.horizon_s, top.step_s)
        except RulecError as error:
            place = table.place("step_s")
            file.errors.extend(replace(mistake, place=place) for mistake in error.diagnostics)
    if ego is not None:
        if road is not None:
            _check_on_road(ego, road, file)
        _check_collisions(ego, obstacles, file)
    if file.errors or top is None or road is None or ego is None:
        raise RulecError(file.errors)
    return Scenario(
        name=top.name or name,
        road=road,
        ego=ego,
        obstacles=tuple(obstacle for obstacle, _ in obstacles),
        signals=signals,
        goal=goal,
        horizon_s=top.horizon_s,
        step_s=top.step_s,
        about=top.about,
        places={
            **{(name, ""): TomlTable(file, "", "signals").place(name) for name in signals},
            **{at: place for obstacle in obstacles for at, place in places_of(*obstacle).items()},
        },
    )


def _road(raw: object, file: TomlFile) -> Road | None:
    if not isinstance(raw, Mapping):
        return None
    table = TomlTable(file, "road", "road")
    values = table.read(RawRoad, raw)
    surfaces = tuple(_stretches(raw.get("surface"), file))
    count = None if values is None else len(values.lanes) - 1
    missing = tuple(_missing(raw.get("missing"), count, file))
    if values is None:
        return None
    straight = _is_interval(values.s, table, "s")
    if not (_ascend(values.lanes, table) and straight):
        return None
    return Road(values.s, tuple(values.lanes), surfaces, missing)


def _stretches(raw: object, file: TomlFile) -> Iterator[Stretch]:
    before: list[RawSurface] = []
    if isinstance(raw, list) and len(raw) > MOST_STRETCHES:
        return  # already reported for the road
    for table, part in _parts(RawSurface, raw, "road.surface", file):
        for other in before:
            apart = part.s[1] <= other.s[0] or other.s[1] <= part.s[0]
            if not apart and part.type != other.type:
                table.add(
                    f"{table.words} is {part.type} where another one is {other.type}",
                    "s",
                    expected="one surface in one place",
                )
        before.append(part)
        yield Stretch(part.type, part.s)


def _missing(raw: object, count: int | None, file: TomlFile) -> Iterator[MissingLane]:
    if isinstance(raw, list) and len(raw) > MOST_STRETCHES:
        return
    for table, part in _parts(RawMissing, raw, "road.missing", file):
        if count is None or part.lane <= count:
            yield MissingLane(part.lane, part.s)
        else:
            table.add(
                f"{table.words}: `lane` is {part.lane}",
                "lane",
                expected=f"a number from 1 to {count}, the lanes of the road",
            )


def _parts(
    kind: type[_Part], raw: object, heading: str, file: TomlFile
) -> Iterator[tuple[TomlTable, _Part]]:
    for number, item in enumerate(raw if isinstance(raw, list) else (), start=1):
        table = TomlTable(file, f"{heading} {number}", heading, number)
        part = table.read(kind, item)
        if part is not None and _is_interval(part.s, table, "s"):
            yield table, part


def _is_interval(value: tuple[float, float] | None, table: TomlTable, key: str) -> bool:
    """Whether ``from`` is before ``to`` by more than rounding; otherwise a mistake is added."""
    if value is None or value[1] - value[0] >= NARROWEST_M:
        return True
    table.add(
        f"{table.words}: `{key}` runs from {value[0]:g} to {value[1]:g}",
        key,
        expected=f"a second number that is larger than the first, by {NARROWEST_M} m or more",
        way_out=f"write `{key} = [{value[1]:g}, {value[0]:g}]`" if value[1] < value[0] else "",
    )
    return False


def _ascend(lanes: Sequence[float], table: TomlTable) -> bool:
    for right, left in pairwise(lanes):
        if left - right < NARROWEST_M:
            table.add(
                f"{table.words}: in `lanes`, {left:g} follows {right:g}",
                "lanes",
                expected="bounds from right to left, each larger than the one before by "
                f"{NARROWEST_M} m or more",
                way_out="d is positive to the left, so sort the numbers in ascending order",
            )
            return False
    return True


def _ego(raw: object, file: TomlFile) -> Ego | None:
    if not isinstance(raw, Mapping):
        return None
    table = TomlTable(file, "ego", "ego")
    values = table.read(RawEgo, raw)
    if values is None:
        return None
    bounds = None
    if values.bounds is not None:
        try:
            bounds = read_bounds(values.bounds, None)
        except RulecError as error:
            place = table.place("bounds")
            file.errors.extend(replace(mistake, place=place) for mistake in error.diagnostics)
    return Ego(
        values.s,
        values.d,
        values.length or 0.0,
        values.width or 0.0,
        speed=values.speed,
        lateral_speed=values.lateral_speed,
        bounds=bounds,
    )


def _check_on_road(ego: Ego, road: Road, file: TomlFile) -> None:
    table = TomlTable(file, "ego", "ego")
    if not road.outline.covers(ego.s, ego.d):
        table.add(
            f"ego is off the road, at s = {ego.s:g}, d = {ego.d:g}",
            expected=f"a place within {road.outline}",
            way_out="move ego, or extend `[road]`",
        )
    elif any(hole.overlaps(Box(ego.s, ego.s, ego.d, ego.d)) for hole in road.holes()):
        table.add(
            f"ego is where the road has no lane, at s = {ego.s:g}, d = {ego.d:g}",
            expected="a place outside every `[[road.missing]]`",
            way_out="move ego, or shorten that `[[road.missing]]`",
        )


def _check_collisions(ego: Ego, obstacles: Sequence[LocatedObstacle], file: TomlFile) -> None:
    for obstacle, table in obstacles:
        body = swept(obstacle, 0.0, 0.0)
        if body is not None and body.overlaps(ego.body):
            TomlTable(file, "ego", "ego").add(
                f"ego stands inside {table.words}",
                expected=f"a place outside {body} at time 0",
                way_out="move one of the two",
            )


def _goal(raw: object, road: Road | None, file: TomlFile) -> Box | None:
    if not isinstance(raw, Mapping):
        return None
    table = TomlTable(file, "goal", "goal")
    values = table.read(RawGoal, raw)
    if values is None or road is None:
        return None
    ordered = [_is_interval(values.s, table, "s"), _is_interval(values.d, table, "d")]
    if not all(ordered):
        return None
    outline = road.outline
    goal = Box(*(values.s or road.s), *(values.d or (outline.d_min, outline.d_max)))
    if not goal.overlaps(outline):
        table.add(
            "the goal is off the road",
            expected=f"a region that has some area within {outline}",
        )
    return goal


def _signals(
    raw: object, obstacles: Sequence[LocatedObstacle], file: TomlFile
) -> dict[str, SignalValue]:
    table = TomlTable(file, "signals", "signals")
    signals = read_signals(raw, table) if isinstance(raw, Mapping) else {}
    for obstacle, place in obstacles:
        for name in filter(signals.__contains__, obstacle.signals):
            place.add(
                f"{place.words} sets {quoted(name)}, and so does `[signals]`",
                "signals",
                expected="a signal that is either global or per object",
            )
    return signals
