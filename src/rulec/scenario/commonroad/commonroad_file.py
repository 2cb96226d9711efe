"""A CommonRoad file through commonroad-io, which is installed on request.

The only file that knows the library. It reports mistakes as whatever exception they lead to, and
talks to the terminal; both are caught here.
"""

from __future__ import annotations

import io
import logging
import warnings
from collections.abc import Callable, Iterator, Mapping, Set
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from math import inf
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from rulec.diagnostics import RulecError, SourceLocation
from rulec.scenario.commonroad.commonroad_participants import (
    commonroad_participants,
    planning_problem,
)
from rulec.scenario.commonroad.commonroad_surroundings import (
    commonroad_junctions,
    commonroad_weather,
    stop_line,
)
from rulec.scenario.commonroad.required_elements import COMMONROAD, check_form
from rulec.scenario.recorded import recording
from rulec.scenario.recorded.adjacency import with_neighbours
from rulec.scenario.scenario_messages import COMMONROAD_MISSING
from rulec.scenario.xml_element import LARGEST

_MARKS: Mapping[str, recording.LaneMark] = MappingProxyType(
    {
        "solid": "solid",
        "broad_solid": "solid",
        "solid_solid": "double_solid",
        "dashed": "broken",
        "broad_dashed": "broken",
        "dashed_dashed": "broken",
        "no_marking": "none",
    }
)
"""CommonRoad's words for marks; those of two kinds say no more than nothing, for want of a side."""

_LEFT_HAND = """
AUS BGD BHS BMU BRN BTN BWA CYP FJI GBR GUY HKG IDN IND IRL JAM JPN KEN LKA LSO
MAC MDV MLT MOZ MUS MWI MYS NAM NPL NZL PAK PNG SGP SUR SWZ THA TTO TZA UGA ZAF
ZWE
"""
_RIGHT_HAND = """
ALB ARG ARM AUT AZE BEL BGR BIH BLR BRA CAN CHE CHL CHN COL CZE DEU DNK EGY ESP
EST FIN FRA GEO GRC HRV HUN ISL ISR ITA KAZ KOR LTU LUX LVA MAR MDA MEX MNE NLD
NOR PER PHL POL PRT ROU RUS SAU SRB SVK SVN SWE TUN TUR TWN UKR URY USA VNM
"""
"""The codes of countries (ISO 3166) by the side of traffic; names of scenarios begin with them."""


def read_commonroad(path: Path) -> recording.Recording:
    """Read the recording in a CommonRoad file.

    Raises RulecError R0610 for a file that cannot be read as CommonRoad, R0611 without the library,
    R0701 if the file cannot be opened.
    """
    drawn = check_form(path)
    with _quiet():
        reader = _library(path)
        try:
            scenario, problems = reader(path).open()
            return with_neighbours(_recording(path.stem, scenario, problems, drawn))
        except (OSError, MemoryError, RulecError):
            raise
        except Exception as reason:  # the library has no exception of its own
            raise _unreadable(path, reason) from None


def _library(path: Path) -> Callable[[Path], Any]:
    # The library is optional, and takes a second to import
    try:
        from commonroad.common.file_reader import CommonRoadFileReader  # an extra, and 1 s
    except ImportError:
        raise COMMONROAD_MISSING.error(
            SourceLocation(str(path)),
            "CommonRoad scenarios take the package `commonroad-io`, which is not installed",
            help="`pip install 'rulec[commonroad]'`, some 370 MB with what it needs",
        ) from None
    reader: Callable[[Path], Any] = CommonRoadFileReader
    return reader


@contextmanager
def _quiet() -> Iterator[None]:
    """Keep the library's remarks on old spellings from the terminal."""
    disabled = logging.root.manager.disable
    logging.disable(logging.CRITICAL)
    try:
        output = io.StringIO()
        with warnings.catch_warnings(), redirect_stdout(output), redirect_stderr(output):
            warnings.simplefilter("ignore")
            yield
    finally:
        logging.disable(disabled)


def _unreadable(path: Path, reason: Exception) -> RulecError:
    words = " ".join(str(reason).split())[:200]
    # Where something is missing the library stumbles over Python's None, which helps nobody
    if not words or "NoneType" in words:
        return COMMONROAD.refused(path, "something in it is missing or has an unknown name")
    why = f"something in it does not fit (commonroad-io says {type(reason).__name__}: {words})"
    return COMMONROAD.refused(path, why)


def _recording(name: str, scenario: Any, problems: Any, drawn: Set[str]) -> recording.Recording:
    """``drawn`` are the lanelets whose stop lines have a place in the file."""
    signs = {sign.traffic_sign_id: sign for sign in scenario.lanelet_network.traffic_signs}
    lights = {
        light.traffic_light_id: _light(light.traffic_light_cycle)
        for light in scenario.lanelet_network.traffic_lights
        if light.active
    }
    junctions = commonroad_junctions(scenario.lanelet_network)
    lanelets = {
        str(lanelet.lanelet_id): _lanelet(
            lanelet, signs, lights, junctions.get(lanelet.lanelet_id, ""), drawn
        )
        for lanelet in scenario.lanelet_network.lanelets
    }
    step_s = float(scenario.dt)
    if not 0 < step_s < inf:
        raise ValueError(f"a time step of {step_s:g} s is none")
    return recording.Recording(
        name,
        step_s,
        lanelets,
        tuple(commonroad_participants(scenario)),
        tuple(
            planning_problem(problem, lanelets)
            for _, problem in sorted(problems.planning_problem_dict.items())
        ),
        side=side_in(name),
        country=_country(name),
        weather=commonroad_weather(scenario.environment),
    )


def _light(cycle: Any) -> recording.Light:
    phases = tuple((phase.state.value, int(phase.duration)) for phase in cycle.cycle_elements)
    if not phases or min(duration for _, duration in phases) <= 0:
        raise ValueError("a traffic light has a phase that does not last")
    return recording.Light(int(cycle.time_offset), phases)


def _lanelet(
    lanelet: Any,
    signs: Mapping[int, Any],
    lights: Mapping[int, recording.Light],
    junction: str,
    drawn: Set[str],
) -> recording.Lanelet:
    elements = [
        element
        for number in sorted(lanelet.traffic_signs or ())
        if number in signs
        for element in signs[number].traffic_sign_elements
    ]
    limits = [
        float(element.additional_values[0])
        for element in elements
        if element.traffic_sign_element_id.name == "MAX_SPEED" and element.additional_values
    ]
    return recording.Lanelet(
        id=str(lanelet.lanelet_id),
        left=_points(lanelet.left_vertices),
        right=_points(lanelet.right_vertices),
        centre=_points(lanelet.center_vertices),
        successors=tuple(map(str, lanelet.successor or ())),
        predecessors=tuple(map(str, lanelet.predecessor or ())),
        left_of=_id(lanelet.adj_left) if lanelet.adj_left_same_direction else None,
        right_of=_id(lanelet.adj_right) if lanelet.adj_right_same_direction else None,
        types=frozenset(kind.value for kind in lanelet.lanelet_type or ())
        | frozenset({"intersection"} if junction else ()),
        signs=frozenset(element.traffic_sign_element_id.name for element in elements),
        limit_mps=min(limits, default=None),
        lights=tuple(lights[i] for i in sorted(lanelet.traffic_lights or ()) if i in lights),
        left_mark=_MARKS.get(lanelet.line_marking_left_vertices.value),
        right_mark=_MARKS.get(lanelet.line_marking_right_vertices.value),
        stop_line=stop_line(lanelet) if str(lanelet.lanelet_id) in drawn else None,
        junction=junction,
    )


def _id(number: int | None) -> str | None:
    return None if number is None else str(number)


def _points(vertices: Any) -> recording.Points:
    points = np.asarray(vertices, dtype=float)[:, :2]
    if len(points) < 2 or not (np.abs(points) < LARGEST).all():
        raise ValueError("a lanelet's bound has fewer than two points, or one that is no place")
    if np.ptp(points, axis=0).max() > recording.LONGEST_M:
        raise ValueError(f"a lanelet's bound is longer than {recording.LONGEST_M / 1000:g} km")
    return points


def _country(name: str) -> str:
    return name.removeprefix("C-").partition("_")[0].upper()


def side_in(name: str) -> recording.Side | None:
    """The side of ``DEU_Ulm-1_1_T-1``; None for other names, and for made-up countries.

    CommonRoad's own ``ZAM`` is the made-up country Zamunda, not Zambia.
    """
    country = _country(name)
    if country in _LEFT_HAND.split():
        return "left"
    return "right" if country in _RIGHT_HAND.split() else None
