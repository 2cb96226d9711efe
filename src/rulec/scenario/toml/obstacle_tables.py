"""The obstacles of a scenario file."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import pairwise

from rulec.scenario.motion import stands_forever
from rulec.scenario.scenario_messages import INCONSISTENT_SCENARIO, MISSING_OR_UNKNOWN_FIELD
from rulec.scenario.scenario_model import (
    PEDESTRIAN,
    ConstantAcceleration,
    Motion,
    Obstacle,
    Trajectory,
)
from rulec.scenario.toml.consistency import check_signals
from rulec.scenario.toml.field_check import Findings, quoted, read_table
from rulec.scenario.toml.field_locations import TomlTable
from rulec.scenario.toml.prediction_tables import read_predictions
from rulec.scenario.toml.schema import MOST_OBSTACLES, RawObstacle

LocatedObstacle = tuple[Obstacle, TomlTable]

_PREDICTED = ("s", "d", "speed", "acceleration", "lateral_speed", "until_d")


def read_obstacles(raw: object, findings: Findings) -> tuple[LocatedObstacle, ...]:
    """The obstacles without mistakes, each with its place in the file."""
    if not isinstance(raw, list) or len(raw) > MOST_OBSTACLES:
        return ()
    listed: list[LocatedObstacle] = []
    numbers: dict[str, int] = {}
    before = 0
    for number, item in enumerate(raw, start=1):
        place = TomlTable("obstacle", number, _words(item, number))
        table = read_table(RawObstacle, item, place, findings)
        ahead, before = before, before + _number_of_predictions(item)
        if isinstance(item, Mapping) and isinstance(name := item.get("id"), str):
            _check_unique(name, number, numbers, place, findings)
        if table is None:
            continue
        expected = read_predictions(
            table, item, place, before=ahead, findings=findings, motion_of=_motion
        )
        signals = TomlTable("obstacle.signals", number, place.words)
        values = check_signals(table.signals, signals, findings)
        if expected is None:
            continue
        obstacle = Obstacle(
            id=table.id,
            type=table.type,
            length=table.length,
            width=table.width,
            motion=expected.motion,
            walking_direction=table.walking_direction,
            signals=values,
            weight=expected.weight,
            alternatives=expected.alternatives,
        )
        _check_direction(obstacle, place, findings)
        listed.append((obstacle, place))
    return tuple(listed)


def _number_of_predictions(item: object) -> int:
    raw = item.get("prediction") if isinstance(item, Mapping) else None
    return len(raw) if isinstance(raw, list) else 0


def _words(item: object, number: int) -> str:
    name = item.get("id") if isinstance(item, Mapping) else None
    return f"obstacle {number} ({quoted(name)})" if isinstance(name, str) else f"obstacle {number}"


def _check_unique(
    name: str, number: int, numbers: dict[str, int], place: TomlTable, findings: Findings
) -> None:
    first = numbers.setdefault(name, number)
    if first != number:
        findings.add(
            INCONSISTENT_SCENARIO,
            f"obstacles {first} and {number} are both called {quoted(name)}",
            place,
            "id",
            expected="an id that no other obstacle has",
        )


def _check_direction(obstacle: Obstacle, place: TomlTable, findings: Findings) -> None:
    motions = (obstacle.motion, *(alternative.motion for alternative in obstacle.alternatives))
    standing = obstacle.walking_direction is None and any(map(stands_forever, motions))
    if obstacle.type == PEDESTRIAN and standing:
        findings.add(
            MISSING_OR_UNKNOWN_FIELD,
            f"{place.words} stands still and has no `walking_direction`",
            place,
            expected="a pedestrian's direction, because its regions depend on it",
            way_out="add a line `walking_direction = 90` for one who faces left, -90 for right",
        )


def _motion(
    table: RawObstacle, item: Mapping[str, object], place: TomlTable, findings: Findings
) -> Motion | None:
    if table.trajectory is not None:
        return _trajectory(table.trajectory, item, place, findings)
    if table.s is None or table.d is None:
        for key in ("s", "d"):
            if getattr(table, key) is None:
                findings.add(
                    MISSING_OR_UNKNOWN_FIELD,
                    f"{place.words} has no `{key}`",
                    place,
                    expected="its centre at time 0 in metres: s along the road, d across it",
                    way_out=f"add a line `{key} = …`, or give a `trajectory` instead",
                )
        return None
    sideways, until = table.lateral_speed, table.until_d
    if until is not None and (until - table.d) * sideways <= 0:
        findings.add(
            INCONSISTENT_SCENARIO,
            f"{place.words} never comes to `until_d = {until:g}`",
            place,
            "until_d",
            expected=f"an offset to which `lateral_speed = {sideways:g}` leads from {table.d:g}",
            way_out="change the sign of `lateral_speed`, or leave `until_d` out",
        )
        return None
    return ConstantAcceleration(
        s=table.s,
        d=table.d,
        speed=table.speed,
        acceleration=table.acceleration,
        lateral_speed=sideways,
        until_d=until,
    )


def _trajectory(
    points: list[tuple[float, float, float]],
    item: Mapping[str, object],
    place: TomlTable,
    findings: Findings,
) -> Motion | None:
    both = [key for key in _PREDICTED if key in item]
    if both:
        findings.add(
            INCONSISTENT_SCENARIO,
            f"{place.words} has a `trajectory` and also {', '.join(map(quoted, both))}",
            place,
            both[0],
            expected="either a trajectory, or a start and a prediction",
            way_out="leave out one of the two",
        )
        return None
    for before, after in pairwise(points):
        if after[0] <= before[0]:
            findings.add(
                INCONSISTENT_SCENARIO,
                f"{place.words}: in `trajectory`, time {after[0]:g} follows {before[0]:g}",
                place,
                "trajectory",
                expected="times in ascending order, each once",
            )
            return None
    return Trajectory(tuple(points))
