"""Conversion of a scenario file's tables into a ``Scenario``."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from rulec.diagnostics import RulecError
from rulec.scenario.geometry import Box
from rulec.scenario.scenario_messages import INCONSISTENT_SCENARIO
from rulec.scenario.scenario_model import Ego, MissingLane, Road, Scenario, SignalValue, Stretch
from rulec.scenario.time_grid import timing
from rulec.scenario.toml.consistency import (
    check_collision,
    check_ego,
    check_interval,
    check_lanes,
    check_signals,
)
from rulec.scenario.toml.field_check import Findings, quoted, read_table
from rulec.scenario.toml.field_locations import TomlTable
from rulec.scenario.toml.obstacle_tables import LocatedObstacle, read_obstacles
from rulec.scenario.toml.schema import RawEgo, RawGoal, RawMissing, RawRoad, RawScenario, RawSurface

_TOP = TomlTable("", None, "the scenario")
_ROAD = TomlTable("road", None, "road")
_EGO = TomlTable("ego", None, "ego")
_GOAL = TomlTable("goal", None, "goal")
_SIGNALS = TomlTable("signals", None, "signals")


def to_scenario(raw: Mapping[str, object], name: str, findings: Findings) -> Scenario:
    """The scenario that the tables describe.

    ``name`` is used if they give none.

    Raises:
        RulecError: every mistake that was found.
    """
    top = read_table(RawScenario, raw, _TOP, findings)
    road = _road(raw.get("road"), findings)
    ego = _ego(raw.get("ego"), findings)
    obstacles = read_obstacles(raw.get("obstacle"), findings)
    signals = _signals(raw.get("signals"), obstacles, findings)
    goal = _goal(raw["goal"], road, findings) if "goal" in raw else None
    if top is not None:
        _check_timing(top, findings)
    if ego is not None and road is not None:
        check_ego(ego, road, _EGO, findings)
    if ego is not None:
        for obstacle, table in obstacles:
            check_collision(ego, obstacle, table, findings)
    if findings.errors or top is None or road is None or ego is None:
        raise RulecError(findings.errors)
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
    )


def _road(raw: object, findings: Findings) -> Road | None:
    if not isinstance(raw, Mapping):
        return None
    table = read_table(RawRoad, raw, _ROAD, findings)
    surfaces = _stretches(raw.get("surface"), findings)
    missing = _missing(raw.get("missing"), table, findings)
    if table is None:
        return None
    straight = check_interval(table.s, _ROAD, "s", findings)
    if not (check_lanes(table.lanes, _ROAD, findings) and straight):
        return None
    return Road(table.s, tuple(table.lanes), surfaces, missing)


def _stretches(raw: object, findings: Findings) -> tuple[Stretch, ...]:
    stretches: list[Stretch] = []
    for number, item in enumerate(raw if isinstance(raw, list) else (), start=1):
        place = TomlTable("road.surface", number, f"road.surface {number}")
        table = read_table(RawSurface, item, place, findings)
        if table is None or not check_interval(table.s, place, "s", findings):
            continue
        for stretch in stretches:
            apart = table.s[1] <= stretch.s[0] or stretch.s[1] <= table.s[0]
            if not apart and table.type != stretch.surface:
                findings.add(
                    INCONSISTENT_SCENARIO,
                    f"{place.words} is {table.type} where another one is {stretch.surface}",
                    place,
                    "s",
                    expected="one surface in one place",
                )
        stretches.append(Stretch(table.type, table.s))
    return tuple(stretches)


def _missing(raw: object, road: RawRoad | None, findings: Findings) -> tuple[MissingLane, ...]:
    missing: list[MissingLane] = []
    for number, item in enumerate(raw if isinstance(raw, list) else (), start=1):
        place = TomlTable("road.missing", number, f"road.missing {number}")
        table = read_table(RawMissing, item, place, findings)
        if table is None or not check_interval(table.s, place, "s", findings):
            continue
        if road is not None and table.lane >= len(road.lanes):
            findings.add(
                INCONSISTENT_SCENARIO,
                f"{place.words}: `lane` is {table.lane}",
                place,
                "lane",
                expected=f"a number from 1 to {len(road.lanes) - 1}, the lanes of the road",
            )
            continue
        missing.append(MissingLane(table.lane, table.s))
    return tuple(missing)


def _ego(raw: object, findings: Findings) -> Ego | None:
    if not isinstance(raw, Mapping):
        return None
    table = read_table(RawEgo, raw, _EGO, findings)
    if table is None:
        return None
    return Ego(table.s, table.d, table.length or 0.0, table.width or 0.0)


def _goal(raw: object, road: Road | None, findings: Findings) -> Box | None:
    if not isinstance(raw, Mapping):
        return None
    table = read_table(RawGoal, raw, _GOAL, findings)
    if table is None or road is None:
        return None
    ordered = [check_interval(getattr(table, key), _GOAL, key, findings) for key in ("s", "d")]
    if not all(ordered):
        return None
    outline = road.outline
    goal = Box(*(table.s or road.s), *(table.d or (outline.d_min, outline.d_max)))
    if not goal.overlaps(outline):
        findings.add(
            INCONSISTENT_SCENARIO,
            "the goal is off the road",
            _GOAL,
            expected=f"a region that has some area within {outline}",
        )
    return goal


def _signals(
    raw: object, obstacles: tuple[LocatedObstacle, ...], findings: Findings
) -> dict[str, SignalValue]:
    signals = check_signals(dict(raw), _SIGNALS, findings) if isinstance(raw, Mapping) else {}
    for obstacle, table in obstacles:
        for name in obstacle.signals:
            if name in signals:
                findings.add(
                    INCONSISTENT_SCENARIO,
                    f"{table.words} sets {quoted(name)}, and so does `[signals]`",
                    table,
                    "signals",
                    expected="a signal that is either global or per object",
                )
    return signals


def _check_timing(top: RawScenario, findings: Findings) -> None:
    try:
        timing(top.horizon_s, top.step_s)
    except RulecError as error:
        place = findings.text.place(_TOP, "step_s")
        findings.errors.extend(replace(diagnostic, place=place) for diagnostic in error.diagnostics)
