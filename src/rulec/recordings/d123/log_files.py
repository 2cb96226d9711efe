"""The files of a 123D log, and their metadata.

According to the API and the writer of py123d 0.7 (`autonomousvision/py123d`), a log is a folder
with ``sync.arrow`` and a file for each modality, ``logs/SPLIT/LOG`` in the data's folder; its map
is ``map.arrow`` there, or that of its place, ``maps/DATASET/DATASET_PLACE.arrow``. Metadata are
MessagePack within the schema's metadata.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import msgspec

from rulec.diagnostics import SourceLocation
from rulec.recordings.commonroad.countries import PLACES, country_at
from rulec.recordings.encodings.arrow.arrow_tables import LONGEST_TEXT, ArrowTable
from rulec.recordings.encodings.file_format import FileFormat
from rulec.recordings.recording_messages import NET_MISSING

LOG = FileFormat(
    "a log of 123D",
    "it is a folder with `sync.arrow`, `box_detections_se3.arrow` and `ego_state_se3.arrow`, as "
    "py123d writes them",
    1_000_000_000,
)
SYNC, BOXES, EGO = "sync.arrow", "box_detections_se3.arrow", "ego_state_se3.arrow"
LIGHTS, MAP = "traffic_light_detections.arrow", "map.arrow"

WAYMO = "wod"
"""The prefix of the names of Waymo's data sets, whose maps have all stop signs."""

_COUNTRIES = {**dict.fromkeys(("av2", WAYMO, "pandaset"), "USA"), "kitti360": "DEU", **PLACES}
"""How the names of data sets and places begin -> the country."""

_DEEPEST = 16
"""Limit on the depth of nested values; the metadata read here have four levels."""


class OddPackError(Exception):
    """The bytes are not MessagePack, or contain an unsupported type."""


def unpacked(data: bytes) -> Any:
    """The single value in the bytes. Raises OddPackError, also for times and other extensions."""
    try:
        value = msgspec.msgpack.decode(data)
    except (ValueError, RecursionError):  # msgspec's errors are the former, and Unicode's
        raise OddPackError from None
    _check_plain(value)
    return value


def _check_plain(value: object, depth: int = 0) -> None:
    inner: Iterable[object] = ()
    match value:
        case list() if depth < _DEEPEST:
            inner = value
        case dict() if depth < _DEEPEST and all(isinstance(x, str | bytes | int) for x in value):
            inner = value.values()
        case str() | bytes() | int() | float() | None:
            pass
        case _:
            raise OddPackError
    for part in inner:
        _check_plain(part, depth + 1)


def said_in(table: ArrowTable) -> Mapping[Any, Any]:
    """The metadata of a file. Raises RulecError R0610."""
    try:
        metadata = unpacked(table.metadata.get(b"metadata", b""))
    except OddPackError:
        raise table.form.refused(table.path, "its `metadata` are no MessagePack") from None
    if not isinstance(metadata, dict):
        raise table.form.refused(table.path, "its `metadata` are no table of names and values")
    return metadata


def word(metadata: Mapping[Any, Any], name: str) -> str:
    """A text in metadata; empty if it is not a text, or not a plain name."""
    text = metadata.get(name)
    if not isinstance(text, str) or len(text) > LONGEST_TEXT or not text.isprintable():
        return ""
    return text


def country_of(data_set: str, place: str) -> str:
    """The country of a place, or of all places of a data set; empty if unknown."""
    return country_at((place, data_set), _COUNTRIES)


def map_of(path: Path, data_set: str, place: str) -> Path:
    """The map of the log with this ``sync.arrow``. Raises RulecError R0614 if there is none."""
    own = path.with_name(MAP)
    folders = path.absolute().parents
    if own.is_file():
        return own
    if len(folders) > 3 and data_set and place:
        shared = folders[3] / "maps" / data_set / f"{data_set}_{place}.arrow"
        if shared.is_file():
            return shared
    raise NET_MISSING.error(
        SourceLocation(str(path)),
        f"the log has no map: neither `{MAP}` beside it, nor that of its place in `maps`",
        help="name the map with --map FILE",
    )
