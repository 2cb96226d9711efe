"""Recorded traffic from a file."""

from __future__ import annotations

from pathlib import Path

from rulec.scenario.commonroad.reading import read_recording
from rulec.scenario.commonroad.safe_xml import refused
from rulec.scenario.model import Scenario
from rulec.scenario.recorded.choice import Choice
from rulec.scenario.recorded.convert import to_scenario

__all__ = ["is_recording", "read_recording", "read_scene"]


def is_recording(file: str) -> bool:
    """Does a file's name say that it holds recorded traffic?"""
    return file.lower().endswith((".xml", ".xml.gz"))


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
