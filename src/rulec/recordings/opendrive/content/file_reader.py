"""Reads an OpenDRIVE file into its elements."""

from __future__ import annotations

from pathlib import Path

from rulec.recordings.encodings.file_format import XmlFormat
from rulec.recordings.encodings.file_values import short
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.encodings.xml_tree import scan_trees
from rulec.recordings.opendrive.content.elements import Connection, OpenDrive, RoadJunction
from rulec.recordings.opendrive.content.road_reader import read_road
from rulec.recordings.opendrive.content.tree_values import contact_point, lane_number, name, text

OPENDRIVE = XmlFormat(
    "an OpenDRIVE map", "ASAM describes the format: https://www.asam.net", root="OpenDRIVE"
)


def read_file(path: Path) -> OpenDrive:
    """The content of a file. Raises RulecError R0610 for another kind, R0701 if unreadable."""
    content = OpenDrive({}, {}, {})
    scan_trees(path, OPENDRIVE, lambda _: None, lambda tree: _add(content, tree))
    if not content.roads:
        raise OPENDRIVE.refused(path, "it has no road")
    return content


def _add(content: OpenDrive, tree: Tree) -> None:
    match tree.name:
        case "header":
            version, minor = text(tree, "revMajor"), text(tree, "revMinor")
            # Roads have no `rule` up to version 1.4
            content.may_have_rules = minor not in ("0", "1", "2", "3", "4")
            if version not in ("", "1"):
                why = f"its version is {short(version)}.{short(minor)}"
                raise tree.wrong(why, "1.4 to 1.8")
        case "include":
            content.included.append(text(tree, "file"))
        case "road":
            content.included += [text(x, "file") for x in tree.all("include")]
            road = read_road(tree)
            if road.id in content.roads:
                raise tree.wrong(f"there are two roads `{short(road.id)}`")
            content.roads[road.id] = road
        case "junction":
            junction = _junction(tree)
            if junction.id in content.junctions:
                raise tree.wrong(f"there are two junctions `{short(junction.id)}`")
            content.junctions[junction.id] = junction
        case "controller":
            controls = [name(x, "signalId") for x in tree.all("control")]
            content.controllers[name(tree)] = tuple(controls)


def _junction(tree: Tree) -> RoadJunction:
    connections = [x for child in tree.all("connection") if (x := _connection(child))]
    priorities = [(text(x, "high"), text(x, "low")) for x in tree.all("priority") if text(x, "low")]
    return RoadJunction(name(tree), tuple(connections), tuple(priorities))


def _connection(tree: Tree) -> Connection | None:
    """A connection; None if it lacks a road, as in virtual junctions."""
    incoming = text(tree, "incomingRoad")
    # Junctions of the type ``direct`` have no connecting roads
    road = text(tree, "connectingRoad") or text(tree, "linkedRoad")
    if not incoming or not road:
        return None
    pairs = [(lane_number(x, "from"), lane_number(x, "to")) for x in tree.all("laneLink")]
    return Connection(incoming, road, contact_point(tree) or "start", tuple(pairs))
