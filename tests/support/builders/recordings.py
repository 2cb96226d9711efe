"""Recordings made by hand."""

from dataclasses import replace
from math import cos, sin
from pathlib import Path

import numpy as np

from rulec.recordings.recording import (
    Lanelet,
    Participant,
    PlanningProblem,
    Recording,
    TrackState,
)

_TOP = Path(__file__).resolve().parents[3]
_SAMPLES = _TOP / "tests/recordings/commonroad/samples"
SAMPLES = {
    file: _SAMPLES / f"{file.stem}.json"
    for file in (
        _TOP / "docs/samples/following.xml",
        _SAMPLES / "DEU_EveryElement-1_1_T-1.xml",
        _SAMPLES / "USA_Old-1_1_T-1.xml",
    )
}
"""Small files of CommonRoad -> what commonroad-io reads in them."""

ROAD_XML = """\
<commonRoad commonRoadVersion="2018b" benchmarkID="ZAM_Road-1_1_T-1" timeStepSize="0.1"
    author="" affiliation="" source="" tags="" date="2020-01-01">
  <lanelet id="1">
    <leftBound><point><x>0</x><y>2</y></point><point><x>99</x><y>2</y></point></leftBound>
    <rightBound><point><x>0</x><y>-2</y></point><point><x>99</x><y>-2</y></point></rightBound>
  </lanelet>
  <obstacle id="3">
    <role>dynamic</role>
    <type>car</type>
    <shape><rectangle><length>4</length><width>2</width></rectangle></shape>
    <initialState>
      <position><point><x>40</x><y>0</y></point></position>
      <orientation><exact>0</exact></orientation><time><exact>0</exact></time>
      <velocity><exact>5</exact></velocity>
    </initialState>
  </obstacle>
  <planningProblem id="2">
    <initialState>
      <position><point><x>9</x><y>0</y></point></position>
      <velocity><exact>5</exact></velocity><orientation><exact>0</exact></orientation>
      <yawRate><exact>0</exact></yawRate><slipAngle><exact>0</exact></slipAngle>
      <time><exact>0</exact></time>
    </initialState>
    <goalState>
      <time><intervalStart>0</intervalStart><intervalEnd>40</intervalEnd></time>
    </goalState>
  </planningProblem>
</commonRoad>
"""


def lanelet(number, centre, width=4.0, **more):
    """A lanelet around a centre line of two points or more, of one width or of one at each.

    Ids may be given as numbers.
    """
    centre = np.array(centre, dtype=float)
    ahead = np.gradient(centre, axis=0)
    across = np.stack((-ahead[:, 1], ahead[:, 0]), axis=1) / np.hypot(*ahead.T)[:, None]
    half = np.broadcast_to(np.asarray(width, dtype=float) / 2, len(centre))[:, None] * across
    for beside in ("left_of", "right_of"):
        if more.get(beside) is not None:
            more[beside] = str(more[beside])
    for along in ("successors", "predecessors"):
        more[along] = tuple(map(str, more.get(along, ())))
    plain = Lanelet(
        id=str(number),
        left=centre + half,
        right=centre - half,
        centre=centre,
        successors=(),
        predecessors=(),
        left_of=None,
        right_of=None,
        types=frozenset(),
        signs=frozenset(),
        limit_mps=None,
    )
    return replace(plain, **more)


def straight(number, start, end, y=0.0, width=4.0, **more):
    """A lanelet along the x axis."""
    return lanelet(number, [(start, y), (end, y)], width, **more)


def rectangle(x, y, length, width, heading=0.0):
    """Its corners."""
    corners = np.array([(1, 1), (1, -1), (-1, -1), (-1, 1)]) * (length / 2, width / 2)
    turn = np.array([(cos(heading), sin(heading)), (-sin(heading), cos(heading))])
    return corners @ turn + (x, y)


def vehicle(number, places, kind="car", length=4.0, width=2.0, speed=0.0, **more):
    """A participant: step -> x and y, heading along the x axis unless ``heading`` says else."""
    heading = more.pop("heading", 0.0)
    acceleration = more.pop("acceleration", 0.0)
    states = {
        step: TrackState(x, y, heading, speed, acceleration) for step, (x, y) in places.items()
    }
    outlines = {step: rectangle(x, y, length, width, heading) for step, (x, y) in places.items()}
    return Participant(str(number), kind, more.get("standing", False), states, outlines)


def recording(lanelets, participants=(), ego=(0.0, 0.0), goals=(), heading=0.0, step_s=0.5):
    """A recording with one planning problem, number 99, at step 0."""
    start = TrackState(*ego, heading, 0.0, 0.0)
    problem = PlanningProblem("99", 0, start, np.array(goals, dtype=float).reshape(-1, 2))
    return Recording(
        "made by hand", step_s, {x.id: x for x in lanelets}, tuple(participants), (problem,)
    )
