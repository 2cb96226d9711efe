"""The messages of an ASAM OSI trace, one after the other: `.osi` and MCAP."""

from __future__ import annotations

import struct
from collections import Counter
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any, NamedTuple

from rulec.diagnostics import RulecError, named
from rulec.files.read_files import opened
from rulec.recordings.encodings.file_format import BinaryFormat
from rulec.recordings.encodings.mcap_file import MAGIC, McapChannel, read_messages
from rulec.recordings.encodings.wire_format import Table, WireFile, fields_of
from rulec.recordings.osi.message_fields import id_of
from rulec.recordings.osi.osi_tables import LIKE_TRUTH, MESSAGES, TRUTHS, VIEWS

OSI = BinaryFormat(
    "an ASAM OSI trace",
    "its messages have to be `GroundTruth`, or `SensorView` with ground truth in them",
)
LARGEST_MESSAGE = 100_000_000
"""Limit on the size of a message in bytes; the map of a whole town has a tenth of it."""

_SIZE = struct.Struct("<I")
_HINTS = {"gt": "GroundTruth", "sv": "SensorView", "sd": "SensorData"}
"""Part of a file's name -> message type: 20210818T150542Z_gt_370_300_1523_track.osi."""


class Frame(NamedTuple):
    """The ground truth at a moment, its time (ns), its host vehicle, and the message it is from."""

    ground_truth: dict[str, Any]
    time: int
    host: str | None
    file: WireFile


def frames(path: Path) -> Iterator[Frame]:
    """The frames of a trace. Raises RulecError R0610 or R0701, possibly during iteration."""
    with opened(path) as stream:
        is_mcap = stream.read(len(MAGIC)) == MAGIC
    messages = _in_mcap(path) if is_mcap else _in_osi(path)
    empty = True
    for number, (kind, data) in enumerate(messages, 1):
        empty = False
        form = replace(OSI, words=f"{OSI.words} (its message {number:,})")
        file = WireFile(data, path, form)
        frame = _frame(kind, file)
        if frame is not None:
            yield frame
    if empty:
        raise OSI.refused(path, "it is empty")


def _frame(kind: str, file: WireFile) -> Frame | None:
    """The ground truth in a message; None if it has none."""
    message = fields_of(file.fields(MESSAGES[kind]))
    views = message.get("sensor_view", [message])
    view = next((view for view in views if "global_ground_truth" in view), None)
    if kind != "GroundTruth" and view is None:
        return None
    truth = message if view is None or kind == "GroundTruth" else view["global_ground_truth"]
    stamps = [x["timestamp"] for x in (truth, view or {}, message) if "timestamp" in x]
    stamp = stamps[0] if stamps else {}
    time = stamp.get("seconds", 0) * 1_000_000_000 + stamp.get("nanos", 0)
    host = id_of(truth, "host_vehicle_id") or id_of(view or {}, "host_vehicle_id")
    return Frame(truth, time, host, file)


def _in_osi(path: Path) -> Iterator[tuple[str, bytes]]:
    """Type and bytes of each message of a file in which every message follows its size."""
    kind, place = "", 0
    with opened(path) as stream:
        while head := stream.read(_SIZE.size):
            if len(head) < _SIZE.size:
                raise OSI.refused(path, "it ends within the size of a message", place)
            (size,) = _SIZE.unpack(head)
            if size > LARGEST_MESSAGE:
                why = f"a message has {size:,} bytes: at most {LARGEST_MESSAGE:,} are read"
                raise OSI.refused(path, why, place)
            data = stream.read(size)
            if len(data) < size:
                why = f"a message of {size:,} bytes begins, and {len(data):,} are left"
                expected = "expected messages with their sizes (4 bytes) before them"
                raise OSI.refused(path, why, place, expected=expected)
            kind = kind or _kind(path, data)
            yield kind, data
            place += len(head) + size


def _kind(path: Path, data: bytes) -> str:
    """The type of a file's messages: from its name, else from the first message.

    Where ground truth has lights, a view has its ground truth; where ground truth has marks, sensor
    data have views. Neither lights nor marks have as many fields, or a time of whole numbers.
    """
    hints = {_HINTS[part] for part in path.name.lower().split("_") if part in _HINTS}
    if len(hints) == 1:
        return hints.pop()
    for kind, table in (("SensorData", VIEWS), ("SensorView", TRUTHS)):
        fields = _probed(path, data, table)
        truths = [x for view in fields.get("view", [fields]) for x in view.get("truth", ())]
        if any(_probed(path, truth, LIKE_TRUTH) for truth in truths):
            return kind
    return "GroundTruth"


def _probed(path: Path, data: bytes, table: Table) -> dict[str, Any]:
    """The fields of bytes that may be a message of this table; none if they are not."""
    try:
        return fields_of(WireFile(data, path, OSI).fields(table))
    except RulecError:
        return {}


def _in_mcap(path: Path) -> Iterator[tuple[str, bytes]]:
    """Type and bytes of the messages of one channel: the one with the most messages.

    Channels of ground truth are preferred to those of views, and these to sensor data with views.
    """
    counts = Counter(message.channel for message in read_messages(path, OSI))
    order = list(MESSAGES)
    kinds = {channel: _kind_of(channel) for channel in counts if _kind_of(channel)}
    if not kinds:
        schemas = sorted({channel.schema or "no schema" for channel in counts})
        held = f"its channels are of {named(schemas[:5])}" if schemas else "it has no messages"
        raise OSI.refused(path, f"it is MCAP without ground truth: {held}")
    chosen = min(kinds, key=lambda x: (order.index(kinds[x]), -counts[x], x.id))
    for message in read_messages(path, OSI):
        if message.channel == chosen:
            yield kinds[chosen], message.data


def _kind_of(channel: McapChannel) -> str:
    """The type of a channel's messages; empty if it is not usable here."""
    package, _, name = channel.schema.rpartition(".")
    known = package in ("osi3", "") and name in MESSAGES and channel.encoding == "protobuf"
    return name if known else ""
