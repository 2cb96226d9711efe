"""Trajectories of maneuvers as JSON."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict

from msgspec import UNSET, UnsetType

from rulec.planning.ranking.cheapest import Maneuver
from rulec.report.json_document import JsonPart, filled


class TrajectoryData(JsonPart, frozen=True, kw_only=True):
    """A trajectory that proves a maneuver drivable: in m, m/s and m/s², and what it costs.

    ``states`` are at the ends of pieces: time, s, speed along, d, speed across. In between
    accelerations are constant.
    """

    greatest_acceleration: float
    greatest_braking: float
    costs: Mapping[str, float]
    states: Sequence[tuple[float, float, float, float, float]]


def trajectory_data(maneuver: Maneuver) -> TrajectoryData | UnsetType:
    """The trajectory of a maneuver, if it has one, with all that it costs."""
    driven = maneuver.trajectory
    if driven is None:
        return UNSET
    costs = {"changes": maneuver.changes or 0.0, **asdict(driven.cost)}
    return filled(TrajectoryData, driven, costs=costs)
