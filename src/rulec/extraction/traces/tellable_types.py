"""The types of road users that files of a format can tell apart."""

from __future__ import annotations

from rulec.recordings.recording import OBSTACLE_TYPES
from rulec.vocabulary import Vocabulary

_WAYMO = ("vehicle", "pedestrian", "bicycle", "unknown")
_MARKED = ("car", "truck", "bus", "motorcycle", "bicycle", "pedestrian", "train", "unknown")
_KINDS_BY_BEGINNING: tuple[tuple[str, tuple[str, ...]], ...] = (
    ("CommonRoad", tuple(OBSTACLE_TYPES.keys() - {"vehicle", "rider"})),
    ("SUMO", (*_MARKED, "taxi", "priorityVehicle")),
    ("Waymo", _WAYMO),
    ("ScenarioNet", (*_WAYMO, "car", "truck", "bus", "motorcycle")),
    ("OSI", (*_MARKED, "priorityVehicle")),
    ("ASAM OSI", (*_MARKED, "priorityVehicle")),
    ("Omega-Prime", (*_MARKED, "priorityVehicle")),
    ("highD", ("car", "truck")),
    ("NGSIM", ("motorcycle", "car", "truck")),
    ("Argoverse-Motion", (*_WAYMO, "bus", "motorcycle")),
    ("Argoverse 2 motion", (*_WAYMO, "bus", "motorcycle")),
    ("Argoverse-Sensor", (*_MARKED, "vehicle", "rider")),
    ("Argoverse 2 sensor", (*_MARKED, "vehicle", "rider")),
)
"""Beginning of a format's name, or of a recording's form -> types of participants that it has.

Files of the others, such as tables, may name every type that a recording can have.
"""


def told_types(source: str, vocabulary: Vocabulary) -> frozenset[str]:
    """The vocabulary's types of which a source can have an object; of others it never has one.

    ``source`` is the name of a format, or the form of a recording. A supertype is told if one of
    its subtypes is.
    """
    kinds = next(
        (
            own
            for begin, own in _KINDS_BY_BEGINNING
            if source.casefold().startswith(begin.casefold())
        ),
        tuple(OBSTACLE_TYPES),
    )
    told = {name for kind in kinds for name in OBSTACLE_TYPES[kind]} & vocabulary.types.keys()
    return frozenset(
        name for name in vocabulary.types if any(vocabulary.is_subtype(own, name) for own in told)
    )
