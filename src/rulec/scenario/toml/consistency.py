"""Checks of a scenario's consistency that a schema cannot express."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from math import isfinite

from rulec.scenario.geometry import Box
from rulec.scenario.motion import swept
from rulec.scenario.scenario_messages import INCONSISTENT_SCENARIO, UNFITTING_FIELD
from rulec.scenario.scenario_model import Ego, Obstacle, Road, SignalValue
from rulec.scenario.toml.field_check import Findings, quoted, shown
from rulec.scenario.toml.field_locations import TomlTable

NARROWEST_M = 0.01
# What a state calls by these names comes from the partition
RESERVED = ("position", "surface", "station", "lateral")


def check_interval(
    value: tuple[float, float] | None, table: TomlTable, key: str, findings: Findings
) -> bool:
    """Check that ``from`` is before ``to``, by more than a hair."""
    if value is None or value[1] - value[0] >= NARROWEST_M:
        return True
    findings.add(
        INCONSISTENT_SCENARIO,
        f"{table.words}: `{key}` runs from {value[0]:g} to {value[1]:g}",
        table,
        key,
        expected=f"a second number that is larger than the first, by {NARROWEST_M} m or more",
        way_out=f"write `{key} = [{value[1]:g}, {value[0]:g}]`" if value[1] < value[0] else "",
    )
    return False


def check_lanes(lanes: Sequence[float], table: TomlTable, findings: Findings) -> bool:
    """Check that the bounds ascend from right to left."""
    for right, left in pairwise(lanes):
        if left - right < NARROWEST_M:
            findings.add(
                INCONSISTENT_SCENARIO,
                f"{table.words}: in `lanes`, {left:g} follows {right:g}",
                table,
                "lanes",
                expected="bounds from right to left, each larger than the one before by "
                f"{NARROWEST_M} m or more",
                way_out="d is positive to the left, so sort the numbers in ascending order",
            )
            return False
    return True


def check_ego(ego: Ego, road: Road, table: TomlTable, findings: Findings) -> None:
    """Check that ego is on the road."""
    if not road.outline.covers(ego.s, ego.d):
        findings.add(
            INCONSISTENT_SCENARIO,
            f"ego is off the road, at s = {ego.s:g}, d = {ego.d:g}",
            table,
            expected=f"a place within {road.outline}",
            way_out="move ego, or extend `[road]`",
        )
    elif any(hole.overlaps(Box(ego.s, ego.s, ego.d, ego.d)) for hole in road.holes()):
        findings.add(
            INCONSISTENT_SCENARIO,
            f"ego is where the road has no lane, at s = {ego.s:g}, d = {ego.d:g}",
            table,
            expected="a place outside every `[[road.missing]]`",
            way_out="move ego, or shorten that `[[road.missing]]`",
        )


def check_collision(ego: Ego, obstacle: Obstacle, table: TomlTable, findings: Findings) -> None:
    """Check that ego and the obstacle are apart at time 0."""
    body = swept(obstacle, 0.0, 0.0)
    if body is not None and body.overlaps(ego.body):
        findings.add(
            INCONSISTENT_SCENARIO,
            f"ego stands inside {table.words}",
            TomlTable("ego", None, "ego"),
            expected=f"a place outside {body} at time 0",
            way_out="move one of the two",
        )


def check_signals(
    raw: dict[str, object], table: TomlTable, findings: Findings
) -> dict[str, SignalValue]:
    """Check the form of signals.

    They are passed on as they are, so only their form is looked at here.
    """
    signals: dict[str, SignalValue] = {}
    for name, value in raw.items():
        if name in RESERVED:
            findings.add(
                INCONSISTENT_SCENARIO,
                f"{table.words} sets {quoted(name)}, which the partition supplies",
                table,
                name,
                way_out="leave it out, or call the signal something else",
            )
        elif isinstance(value, (bool, str)):
            signals[name] = value
        elif isinstance(value, (int, float)) and abs(value) < 1e300 and isfinite(value):
            signals[name] = float(value)
        else:
            findings.add(
                UNFITTING_FIELD,
                f"{table.words}: {quoted(name)} is {shown(value)}",
                table,
                name,
                expected="true, false, a finite number, or a value's name in quotes",
            )
    return signals
