"""A CommonRoad file, version 2018b or 2020a, read as a recording."""

from __future__ import annotations

from pathlib import Path

from rulec.scenario.commonroad.countries import country_in
from rulec.scenario.commonroad.scenario_content import Content, add, add_step, to_recording
from rulec.scenario.recorded.recording import Recording
from rulec.scenario.tree import Tree
from rulec.scenario.xml_element import XmlFormat, short
from rulec.scenario.xml_tree import scan_trees

COMMONROAD = XmlFormat(
    "a CommonRoad scenario",
    "commonRoad",
    "CommonRoad's format is described at https://commonroad.in.tum.de",
)
VERSIONS = ("2018b", "2020a")


def read_commonroad(path: Path) -> Recording:
    """Read the recording in a CommonRoad file.

    Raises RulecError R0610 for a file that cannot be read as CommonRoad, R0701 if it cannot be
    opened.
    """
    content = Content()
    scan_trees(path, COMMONROAD, lambda tree: begin(content, tree), lambda tree: add(content, tree))
    return to_recording(content, path, COMMONROAD)


def begin(content: Content, root: Tree) -> None:
    """Read the root, which says version, country and time step."""
    version = root.attributes.get("commonRoadVersion", "")
    if version not in VERSIONS:
        why = f"its `commonRoadVersion` is `{short(version)}`"
        raise root.wrong(why, " or ".join(VERSIONS))
    # Signs have the ids of the country that the benchmark is in, whatever the file is called
    content.sign_country = country_in(root.attribute("benchmarkID"))
    add_step(content, root)
