"""Recorded traffic from a file."""

from __future__ import annotations

from pathlib import Path

from rulec.scenario.commonroad.reading import read_recording
from rulec.scenario.commonroad.safe_xml import refused
from rulec.scenario.model import Scenario
from rulec.scenario.recorded.choice import Choice
from rulec.scenario.recorded.convert import to_scenario


def read_scene(path: Path, choice: Choice) -> Scenario:
    """The scenario in a recording, seen from the chosen ego.

    Raises:
        RulecError: R0610, R0611 and R0701 as for ``read_recording``, R0612 if what is chosen is not
            in the file.
    """
    recording = read_recording(path)
    try:
        return to_scenario(recording, choice, str(path))
    except ValueError as reason:
        raise refused(path, f"its road makes no sense, {reason}", None) from None
