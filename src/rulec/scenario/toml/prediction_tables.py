"""The predictions of an obstacle in a scenario file."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction

import msgspec

from rulec.scenario.alternatives import Weighted, is_distribution, weighted
from rulec.scenario.scenario_messages import INCONSISTENT_SCENARIO
from rulec.scenario.scenario_model import Motion
from rulec.scenario.toml.field_check import Findings, read_table
from rulec.scenario.toml.field_locations import TomlTable
from rulec.scenario.toml.schema import RawObstacle, RawPrediction

ReadMotion = Callable[[RawObstacle, Mapping[str, object], TomlTable, Findings], Motion | None]
"""Gives the motion of a table's fields; the mapping is what the file has there."""


def read_predictions(
    table: RawObstacle,
    item: Mapping[str, object],
    place: TomlTable,
    *,
    before: int,
    findings: Findings,
    motion_of: ReadMotion,
) -> Weighted | None:
    """The obstacle's motions; None after mistakes, which are then in ``findings``.

    So many predictions stand ``before`` these in the file.
    """
    if not table.prediction:
        motion = motion_of(table, item, place, findings)
        return None if motion is None else Weighted(motion)
    if table.trajectory is not None:
        findings.add(
            INCONSISTENT_SCENARIO,
            f"{place.words} has a `trajectory` and also predictions",
            place,
            "trajectory",
            expected="either the one or the other",
            way_out="give each prediction a `trajectory` of its own",
        )
        return None
    motions: list[tuple[Fraction, Motion]] = []
    for number, raw in enumerate(table.prediction, start=1):
        words = f"{place.words}, prediction {number}"
        here = TomlTable("obstacle.prediction", before + number, words)
        prediction = read_table(RawPrediction, raw, here, findings)
        if prediction is None:
            continue
        if prediction.trajectory is None and (table.s is None or table.d is None):
            motion_of(table, item, place, findings)
            return None
        own = {name: raw[name] for name in raw if name != "weight"}
        values = {name: getattr(prediction, name) for name in own}
        motion = motion_of(msgspec.structs.replace(table, **values), own, here, findings)
        if motion is not None:
            motions.append((Fraction(str(prediction.weight)), motion))
    if len(motions) < len(table.prediction):
        return None
    total = sum((weight for weight, _ in motions), Fraction(0))
    if not is_distribution(total):
        findings.add(
            INCONSISTENT_SCENARIO,
            f"the weights of {place.words}'s predictions add up to {float(total):g}",
            place,
            expected="weights that add up to 1",
        )
        return None
    return weighted(motions)
