"""A recording's map prepared for drives."""

from __future__ import annotations

from rulec.extraction.computed_once import KeepsResults, kept
from rulec.extraction.tracks.driven_road import DrivenRoad, DrivenRoads
from rulec.extraction.tracks.matching.lanelet_graph import LaneletGraph
from rulec.recordings.recording import Recording
from rulec.scenario.recorded.junction_lanelets import junction_lanelets


class LaidOutMap(KeepsResults):
    """Its lanelet graph, and the roads already laid out along routes."""

    def __init__(self, recording: Recording) -> None:
        self.graph = LaneletGraph(recording)
        self.numbers = {name: number for number, name in enumerate(recording.lanelets)}
        self._driven_roads = DrivenRoads(recording, junction_lanelets(recording))

    @kept
    def road(self, route: tuple[str, ...]) -> tuple[DrivenRoad, int] | str:
        """The road of a route and the piece in which the route begins, or why there is none."""
        try:
            return self._driven_roads.along(route)
        except ValueError as reason:
            return f"its road is invalid: {reason}"
