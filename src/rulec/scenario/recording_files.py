"""Recorded traffic from files of any format, known by root element."""

# Imports within functions: a reader takes 10 ms and a scene 30 ms, and a command needs few of them.

from __future__ import annotations

from pathlib import Path

from rulec.diagnostics import SourceLocation
from rulec.scenario.recorded.recording import Recording
from rulec.scenario.safe_xml import is_xml, root_of
from rulec.scenario.scenario_messages import OTHER_CHOICE
from rulec.scenario.scenario_model import Choice, Scenario
from rulec.scenario.xml_element import XmlFormat, short

RECORDING = XmlFormat(
    "recorded traffic",
    "",
    "a recording is a CommonRoad scenario, or SUMO's floating-car data with their net",
)


def read_recording(path: Path, net: Path | None = None) -> Recording:
    """Read a file of recorded traffic; ``net`` is for SUMO's data, which have none.

    Raises:
        RulecError: R0610 for a file that cannot be read as what it seems to be, R0611 without the
            library for CommonRoad, R0613 for a net where none is needed, R0614 and R0615 for a
            missing or wrong one, R0701 if a file cannot be opened.
    """
    root = root_of(path, RECORDING)
    if root == "fcd-export":
        from rulec.scenario.sumo.sumo_recording import read_sumo

        return read_sumo(path, net)
    if root == "net":
        way_out = "give the floating-car data, and this file with --net"
        raise RECORDING.refused(path, "it is a SUMO net, which has only roads", help_text=way_out)
    if root != "commonRoad":
        why = f"it is XML of `{short(root)}`"
        expected = "expected `commonRoad` or `fcd-export`"
        raise RECORDING.refused(path, why, expected=expected)
    if net is not None:
        raise OTHER_CHOICE.error(
            SourceLocation(str(path)),
            f"`{path.name}` has its own roads, and takes no net",
            help="leave out --net, which is for SUMO's floating-car data",
        )
    from rulec.scenario.commonroad.commonroad_file import read_commonroad

    return read_commonroad(path)


def is_recording(file: str) -> bool:
    """True if a file's name or first bytes show recorded traffic."""
    return is_xml(Path(file))


def read_scene(path: Path, choice: Choice) -> Scenario:
    """The scenario in a recording, seen from the chosen ego.

    Raises:
        RulecError: as for ``read_recording``, R0612 if what is chosen is not in the file.
    """
    from rulec.scenario.recorded.recorded_scene import to_scenario

    recording = read_recording(path, choice.net)
    try:
        return to_scenario(recording, choice, str(path))
    except ValueError as reason:
        raise RECORDING.refused(path, f"its road makes no sense, {reason}") from None
