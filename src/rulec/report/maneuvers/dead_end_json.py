"""Dead ends of a scenario as JSON."""

from __future__ import annotations

from collections.abc import Sequence

from rulec.planning import Maneuvers
from rulec.report.json_document import JsonPart


class DeadEndData(JsonPart, frozen=True, kw_only=True):
    """When the last layer begins that a way reaches, who closes it, which options open one."""

    last_s: float
    closed_by: Sequence[str]
    opened_by: Sequence[str]


def dead_end_data(maneuvers: Maneuvers) -> DeadEndData | None:
    """The dead end, if there is no maneuver."""
    end = maneuvers.dead_end
    if end is None:
        return None
    last_s = maneuvers.graph.layers[end.layer].start_s
    return DeadEndData(last_s=last_s, closed_by=end.closed_by, opened_by=end.opened_by)
