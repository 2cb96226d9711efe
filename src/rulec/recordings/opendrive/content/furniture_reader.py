"""Reads signals and objects on a road from the elements of an OpenDRIVE file."""

from __future__ import annotations

from dataclasses import replace

from rulec.recordings.encodings.file_values import number_in
from rulec.recordings.encodings.speed_units import SPEED_UNITS
from rulec.recordings.encodings.tree import Tree
from rulec.recordings.opendrive.content.elements import (
    RoadObject,
    RoadSignal,
    SignalReference,
    SignalSpeed,
)
from rulec.recordings.opendrive.content.tree_values import (
    length,
    name,
    number,
    orientation,
    text,
    validity,
)

_MOST_CORNERS = 10_000
_MOST_LINKS = 100
_CONDITION = "supplementary"


def read_signals(road: Tree) -> tuple[tuple[RoadSignal, ...], tuple[SignalReference, ...]]:
    """The signals on a road, and its references to signals of other roads."""
    signals, references = [], []
    for group in road.all("signals"):
        signals += [_signal(tree) for tree in group.all("signal")]
        references += [_reference(tree) for tree in group.all("signalReference")]
    return tuple(signals), tuple(references)


def _signal(tree: Tree) -> RoadSignal:
    own = _sign(tree, name(tree), length(tree, "s"), number(tree, "t", 0.0))
    boards = [sign for board in tree.all("staticBoard") for sign in board.all("sign")]
    linked = [text(x, "id") for x in tree.all("dependency")]
    linked += [
        text(x, "elementId") for x in tree.all("reference") if text(x, "elementType") != "object"
    ]
    return replace(
        own,
        linked=tuple(linked[:_MOST_LINKS]),
        board=tuple([_sign(x, own.id, own.s, own.t) for x in boards[:_MOST_LINKS]]),
        has_variable_board=tree.first("vmsBoard") is not None,
    )


def _sign(tree: Tree, key: str, s: float, t: float) -> RoadSignal:
    """A signal, or a sign on the board of one."""
    meanings = [x for group in tree.all("semantics") for x in group.children]
    conditions = [x for x in meanings if x.name.startswith(_CONDITION)]
    value = _value(tree)
    return RoadSignal(
        id=key,
        s=s,
        t=t,
        orientation=orientation(tree),
        type=text(tree, "type"),
        subtype=text(tree, "subtype"),
        country=text(tree, "country"),
        dynamic=text(tree, "dynamic") == "yes",
        value=value if 0.0 < value < 1000.0 else None,
        unit=text(tree, "unit"),
        lanes=validity(tree),
        speeds=tuple([_speed(x) for x in meanings if x.name == "speed"]),
        is_qualified=any(map(_qualifies, conditions)),
        has_meaning=len(meanings) > len(conditions),
    )


def _value(tree: Tree) -> float:
    # Some tools write a text where there is no value
    try:
        return number_in(text(tree, "value"))
    except ValueError:
        return 0.0


def _speed(tree: Tree) -> SignalSpeed:
    value, unit = _value(tree), SPEED_UNITS.get(text(tree, "unit").lower())
    is_known = unit is not None and 0.0 < value < 1000.0
    return SignalSpeed(text(tree, "type"), value * unit if unit and is_known else None)


def _qualifies(condition: Tree) -> bool:
    """Whether a condition says for whom or when a sign holds, and not only for how many metres."""
    kind = condition.name.removeprefix(_CONDITION)
    return kind != "Explanatory" and (kind, text(condition, "type")) != ("Distance", "for")


def _reference(tree: Tree) -> SignalReference:
    return SignalReference(name(tree), length(tree, "s"), orientation(tree), validity(tree))


def read_objects(road: Tree) -> tuple[RoadObject, ...]:
    """The crosswalks, stop lines and other objects on a road."""
    return tuple([_object(x) for group in road.all("objects") for x in group.all("object")])


def _object(tree: Tree) -> RoadObject:
    # Since 1.5 there may be several outlines; the first is that of the whole object
    group = tree.first("outlines")
    outline = tree.first("outline") if group is None else group.first("outline")
    corners: list[tuple[float, float]] = []
    on_road = False
    for corner in () if outline is None else outline.children[:_MOST_CORNERS]:
        if corner.name == "cornerLocal":
            corners.append((corner.number("u"), corner.number("v")))
        elif corner.name == "cornerRoad":
            on_road = True
            corners.append((corner.number("s"), corner.number("t")))
    return RoadObject(
        id=text(tree, "id"),
        type=text(tree, "type"),
        subtype=text(tree, "subtype"),
        name=text(tree, "name"),
        s=length(tree, "s", 0.0),
        t=number(tree, "t", 0.0),
        heading=number(tree, "hdg", 0.0),
        orientation=orientation(tree),
        length=length(tree, "length", 0.0),
        width=length(tree, "width", 0.0),
        corners=tuple(corners),
        on_road=on_road,
    )
