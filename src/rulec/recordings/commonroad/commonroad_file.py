"""Reads a CommonRoad XML file, version 2018b or 2020a, as a recording."""

from __future__ import annotations

from pathlib import Path

from rulec.garbage_collection import no_garbage_collection
from rulec.recordings.commonroad.countries import country_in
from rulec.recordings.commonroad.scenario_content import Content, add, add_step, to_recording
from rulec.recordings.encodings.file_format import XmlFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.encodings.xml_tree import scan_trees
from rulec.recordings.recording import Recording
from rulec.recordings.road_map import RoadMap

COMMONROAD = XmlFormat(
    "a CommonRoad scenario",
    "CommonRoad's format is described at https://commonroad.in.tum.de",
    root="commonRoad",
)
VERSIONS = ("2018b", "2020a")

_SAME_STEP_S = 1e-6


def read_commonroad(path: Path) -> Recording:
    """Read the recording in a CommonRoad file.

    Raises RulecError R0610 for a file that cannot be read as CommonRoad, R0701 if it cannot be
    opened.
    """
    content = Content()
    with no_garbage_collection():
        scan_trees(
            path, COMMONROAD, lambda tree: begin(content, tree), lambda tree: add(content, tree)
        )
    return to_recording(content, path, COMMONROAD)


def read_commonroad_map(path: Path, step_s: float) -> RoadMap:
    """The roads in a CommonRoad file, as a map for a recording with time steps of ``step_s``.

    Raises RulecError as ``read_commonroad`` does, and R0610 if the file has no lanelet, or has
    traffic lights and another time step.
    """
    whole = read_commonroad(path)
    if not whole.lanelets:
        raise COMMONROAD.refused(path, "it has no lanelet, so it is not a map")
    lit = any(lanelet.lights or lanelet.lights_to for lanelet in whole.lanelets.values())
    if lit and abs(whole.step_s - step_s) > _SAME_STEP_S:
        own = f"its traffic lights use time steps of {whole.step_s:g} s"
        why = f"{own}, the recording uses {step_s:g} s"
        raise COMMONROAD.refused(path, why)
    return RoadMap(
        form=whole.form,
        lanelets=whole.lanelets,
        side=whole.side,
        country=whole.country,
        complete=whole.complete,
        remarks=whole.remarks,
    )


def begin(content: Content, root: Tree) -> None:
    """Read the root element: the version, the country and the time step."""
    version = root.attributes.get("commonRoadVersion", "")
    if version not in VERSIONS:
        why = f"its `commonRoadVersion` is `{short(version)}`"
        raise root.wrong(why, " or ".join(VERSIONS))
    # Signs have the ids of the benchmark's country, whatever the file's name is
    content.sign_country = country_in(root.attribute("benchmarkID"))
    add_step(content, root)
