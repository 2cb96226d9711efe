"""The obstacles of a scenario file, with their predictions and signals."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from itertools import pairwise
from math import isfinite
from typing import Any

import msgspec

from rulec.diagnostics import SourceLocation
from rulec.scenario import scenario_model as model
from rulec.scenario.motion import stands_forever
from rulec.scenario.scenario_messages import MISSING_OR_UNKNOWN_FIELD, UNFITTING_FIELD
from rulec.scenario.toml.schema import MOST_OBSTACLES, RawObstacle, RawPrediction
from rulec.scenario.toml.toml_tables import TomlFile, TomlTable, quoted, shown
from rulec.vocabulary.partial_values import UNKNOWN, Interval

LocatedObstacle = tuple[model.Obstacle, TomlTable]

RESERVED = ("position", "surface", "station", "lateral")
"""Signals that come from the partition, so that a file may not define them."""

_PREDICTED = ("s", "d", "speed", "acceleration", "lateral_speed", "until_d")


def read_obstacles(raw: object, file: TomlFile) -> list[LocatedObstacle]:
    """The obstacles without mistakes, each with its place in the file."""
    if not isinstance(raw, list) or len(raw) > MOST_OBSTACLES:
        return []
    listed: list[LocatedObstacle] = []
    numbers: dict[str, int] = {}
    predictions = 0
    for number, item in enumerate(raw, start=1):
        fields = item if isinstance(item, Mapping) else {}
        name, before = fields.get("id"), predictions
        words = f"obstacle {number}"
        if isinstance(name, str):
            words += f" ({quoted(name)})"
        if isinstance(fields.get("prediction"), list):
            predictions += len(fields["prediction"])
        table = TomlTable(file, words, "obstacle", number)
        values = table.read(RawObstacle, item)
        if isinstance(name, str) and (first := numbers.setdefault(name, number)) != number:
            table.add(
                f"obstacles {first} and {number} are both called {quoted(name)}",
                "id",
                expected="an id that no other obstacle has",
            )
        if values is None:
            continue
        motions = _predictions(values, fields, table, before)
        signals = TomlTable(file, words, "obstacle.signals", number)
        own_signals = read_signals(values.signals, signals)
        if not motions:
            continue
        likeliest, *others = motions
        obstacle = model.Obstacle(
            id=values.id,
            type=values.type,
            length=values.length,
            width=values.width,
            motion=likeliest.motion,
            walking_direction=values.walking_direction,
            signals=own_signals,
            weight=likeliest.weight,
            alternatives=tuple(others),
        )
        stands = any(stands_forever(prediction.motion) for prediction in motions)
        if obstacle.type == model.PEDESTRIAN and obstacle.walking_direction is None and stands:
            table.add(
                f"{words} stands still and has no `walking_direction`",
                expected="a pedestrian's direction, because its regions depend on it",
                way_out="add a line `walking_direction = 90` for one who faces left, -90 for right",
                code=MISSING_OR_UNKNOWN_FIELD,
            )
        listed.append((obstacle, table))
    return listed


def places_of(obstacle: model.Obstacle, table: TomlTable) -> dict[tuple[str, str], SourceLocation]:
    """Where the file gives an obstacle's type and its signals, by (signal, obstacle id)."""
    own = TomlTable(table.file, "", "obstacle.signals", table.number)
    locations = {("", obstacle.id): table.place("type")}
    for name in obstacle.signals:
        place = own.place(name)
        # An inline table has no heading.
        locations[name, obstacle.id] = table.place("signals") if place.line is None else place
    return locations


def read_signals(raw: Mapping[str, object], table: TomlTable) -> dict[str, model.SignalValue]:
    """The signals of a table; only their form is checked here."""
    signals: dict[str, model.SignalValue] = {}
    for name, value in raw.items():
        if name in RESERVED:
            table.add(
                f"{table.words} sets {quoted(name)}, which the partition supplies",
                name,
                way_out="leave it out, or call the signal something else",
            )
        elif (given := _signal(value)) is not None:
            signals[name] = given
        else:
            table.add(
                f"{table.words}: {quoted(name)} is {shown(value)}",
                name,
                expected="true, false, a finite number, a value's name in quotes, "
                '`"?"` for an unknown value, or `{ from = 30, to = 50 }` for a number in between',
                code=UNFITTING_FIELD,
            )
    return signals


def _signal(value: object) -> model.SignalValue | None:
    """The value of a signal; None if it has the wrong form."""
    match value:
        case "?":
            return UNKNOWN
        case bool() | str():
            return value
        case {"from": first, "to": last, **others} if not others:
            low, high = _number(first), _number(last)
            if low is None or high is None or low > high:
                return None
            return Interval(low, high)
    return _number(value)


def _number(value: object) -> float | None:
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return None
    return float(value) if abs(value) < 1e300 and isfinite(value) else None


def _predictions(
    obstacle: RawObstacle, fields: Mapping[str, Any], table: TomlTable, before: int
) -> Sequence[model.Alternative]:
    """The obstacle's motions, the likeliest first; none if there are mistakes.

    ``before`` is the number of predictions before these in the file.
    """
    if not obstacle.prediction:
        motion = _motion(obstacle, fields, table)
        return [] if motion is None else [model.Alternative(Fraction(1), motion)]
    if obstacle.trajectory is not None:
        table.add(
            f"{table.words} has a `trajectory` and also predictions",
            "trajectory",
            expected="either the one or the other",
            way_out="give each prediction a `trajectory` of its own",
        )
        return []
    motions: list[model.Alternative] = []
    for number, raw in enumerate(obstacle.prediction, start=1):
        words = f"{table.words}, prediction {number}"
        place = TomlTable(table.file, words, "obstacle.prediction", before + number)
        prediction = place.read(RawPrediction, raw)
        if prediction is None:
            continue
        if prediction.trajectory is None and (obstacle.s is None or obstacle.d is None):
            _motion(obstacle, fields, table)
            return []
        own = {name: raw[name] for name in raw if name != "weight"}
        values = {name: getattr(prediction, name) for name in own}
        motion = _motion(msgspec.structs.replace(obstacle, **values), own, place)
        if motion is not None:
            motions.append(model.Alternative(Fraction(str(prediction.weight)), motion))
    if len(motions) < len(obstacle.prediction):
        return []
    total = sum((motion.weight for motion in motions), Fraction(0))
    if not model.is_distribution(total):
        table.add(
            f"the weights of {table.words}'s predictions add up to {float(total):g}",
            expected="weights that add up to 1",
        )
        return []
    return model.weighted(motions)


def _motion(
    values: RawObstacle, fields: Mapping[str, Any], table: TomlTable
) -> model.Motion | None:
    if values.trajectory is not None:
        return _trajectory(values.trajectory, fields, table)
    if values.s is None or values.d is None:
        for key in ("s", "d"):
            if getattr(values, key) is None:
                table.add(
                    f"{table.words} has no `{key}`",
                    expected="its centre at time 0 in metres: s along the road, d across it",
                    way_out=f"add a line `{key} = …`, or give a `trajectory` instead",
                    code=MISSING_OR_UNKNOWN_FIELD,
                )
        return None
    sideways, until = values.lateral_speed, values.until_d
    if until is not None and (until - values.d) * sideways <= 0:
        table.add(
            f"{table.words} never reaches `until_d = {until:g}`",
            "until_d",
            expected=f"an offset to which `lateral_speed = {sideways:g}` leads from {values.d:g}",
            way_out="change the sign of `lateral_speed`, or leave `until_d` out",
        )
        return None
    return model.ConstantAcceleration(**{key: getattr(values, key) for key in _PREDICTED})


def _trajectory(
    points: list[tuple[float, float, float]], fields: Mapping[str, Any], table: TomlTable
) -> model.Motion | None:
    both = [key for key in _PREDICTED if key in fields]
    if both:
        table.add(
            f"{table.words} has a `trajectory` and also {', '.join(map(quoted, both))}",
            both[0],
            expected="either a trajectory, or a start and a prediction",
            way_out="leave out one of the two",
        )
        return None
    for before, after in pairwise(points):
        if after[0] <= before[0]:
            table.add(
                f"{table.words}: in `trajectory`, time {after[0]:g} follows {before[0]:g}",
                "trajectory",
                expected="times in ascending order, each once",
            )
            return None
    return model.Trajectory(tuple(points))
