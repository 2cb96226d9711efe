"""Messages as dictionaries of their fields, already checked against the field tables."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np

from rulec.recordings.encodings.file_values import LARGEST
from rulec.recordings.encodings.wire_format import Fields, Table, WireFile, fields_of
from rulec.recordings.recording import Points


def decoded(data: bytes, table: Table, file: WireFile) -> Fields:
    """The fields of a message that was kept as bytes from ``file``."""
    return fields_of(WireFile(data, file.path, file.form).fields(table))


def id_of(fields: Fields, name: str = "id") -> str | None:
    """The id in a field; None if there is none. Protocol Buffers 3 senders omit an id of 0."""
    identifier = fields.get(name)
    return None if identifier is None else str(identifier.get("value", 0))


def ids_of(fields: Fields, name: str) -> tuple[str, ...]:
    """The ids in a repeated field, without duplicates."""
    return tuple(dict.fromkeys(str(entry.get("value", 0)) for entry in fields.get(name, ())))


def assigned_lanes(fields: Fields) -> tuple[str, ...]:
    """The ids of the lanes, then of the logical lanes, that a classification is assigned to."""
    logical = (
        id_of(entry, "assigned_lane_id") for entry in fields.get("logical_lane_assignment", ())
    )
    return tuple(dict.fromkeys((*ids_of(fields, "assigned_lane_id"), *filter(None, logical))))


def part(fields: Fields, *names: str) -> Fields:
    """A message nested in a message; without fields if it is missing."""
    for name in names:
        fields = fields.get(name, {})
    return fields


def number(fields: Fields, name: str, wrong: WireFile) -> float:
    """A number, 0 if missing. Raises RulecError R0610 if it is huge or not finite."""
    value = float(fields.get(name, 0.0))
    if not abs(value) < LARGEST:
        raise wrong.form.refused(
            wrong.path, f"`{name}` is {value:g}, which is not a number that can be read"
        )
    return value


def places(vectors: Iterable[Fields], wrong: WireFile) -> Points:
    """Places (m) from vectors. Raises RulecError R0610 if a number is huge or not finite."""
    rows = [(number(vector, "x", wrong), number(vector, "y", wrong)) for vector in vectors]
    return np.array(rows, dtype=float).reshape(-1, 2)
