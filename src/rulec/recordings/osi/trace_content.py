"""The contents of an ASAM OSI trace, collected message by message."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.recordings.encodings.wire_format import Fields, Table, WireFile
from rulec.recordings.osi.light_heads import Bulb
from rulec.recordings.osi.message_fields import decoded, id_of
from rulec.recordings.osi.moving_objects import MovingObject
from rulec.recordings.osi.osi_tables import STATIC
from rulec.recordings.osi.trace_file import OSI, Frame, frames
from rulec.recordings.recording import MOST_STEPS

MOST_STATIC_BYTES = 200_000_000
"""Limit on the bytes of all lanes, boundaries, signs and other static messages, each once."""

MOST_OBJECTS = 100_000
_ONLY_ID: Table = {1: STATIC["lane"][1]}


@dataclass(slots=True)
class TraceContent:
    """A trace read so far. ``static``: kind -> id -> message."""

    times: list[int] = field(default_factory=list)
    objects: dict[str, MovingObject] = field(default_factory=dict)
    bulbs: dict[str, Bulb] = field(default_factory=dict)
    static: dict[str, dict[str, Fields]] = field(default_factory=lambda: {x: {} for x in STATIC})
    environment: Fields = field(default_factory=dict)
    country: int = 0
    host: str | None = None
    changing_signs: set[str] = field(default_factory=set)
    skipped: int = 0
    _bytes: int = 0
    _latest: dict[str, list[bytes]] = field(default_factory=dict)
    _first: dict[str, dict[str, bytes]] = field(default_factory=lambda: {x: {} for x in STATIC})

    def add(self, frame: Frame) -> None:
        """Add the contents of a frame. Raises RulecError R0610."""
        if self.times and frame.time <= self.times[-1]:
            if frame.time == self.times[-1]:
                # Several sensors may have a view of one moment
                self.skipped += 1
                return
            raise _wrong(frame.file, "its time is before that of the message before it")
        if len(self.times) == MOST_STEPS:
            raise _wrong(frame.file, f"there are more than {MOST_STEPS:,} of them")
        moment = len(self.times)
        self.times.append(frame.time)
        truth = frame.ground_truth
        self.host = self.host or frame.host
        self.country = self.country or truth.get("country_code", 0)
        self.environment = self.environment or truth.get("environmental_conditions", {})
        for fields in truth.get("moving_object", ()):
            self._add_object(moment, fields, frame.file)
        for fields in truth.get("traffic_light", ()):
            self._add_bulb(moment, fields, frame.file)
        for kind, table in STATIC.items():
            if kind in truth:
                self._add_static(kind, table, truth[kind], frame.file)

    def _add_object(self, moment: int, fields: Fields, file: WireFile) -> None:
        key = _id(fields, "a moving object", file)
        body = self.objects.get(key)
        if body is None:
            self._check_count(len(self.objects), file)
            body = self.objects[key] = MovingObject()
        body.add(moment, fields, file)

    def _add_bulb(self, moment: int, fields: Fields, file: WireFile) -> None:
        key = _id(fields, "a traffic light", file)
        bulb = self.bulbs.get(key)
        if bulb is None:
            self._check_count(len(self.bulbs), file)
            bulb = self.bulbs[key] = Bulb.of(key, fields, file)
        bulb.add(moment, fields)

    def _check_count(self, count: int, file: WireFile) -> None:
        if count == MOST_OBJECTS:
            raise _wrong(file, f"it has more than {MOST_OBJECTS:,} objects or lights")

    def _add_static(self, kind: str, table: Table, messages: list[bytes], file: WireFile) -> None:
        latest = self._latest.get(kind)
        if messages == latest:
            return
        known = set(latest or ())
        self._latest[kind] = messages
        for data in messages:
            if data in known:
                continue
            key = _id(decoded(data, _ONLY_ID, file), f"a message of `{kind}`", file)
            if key not in self.static[kind]:
                self._bytes += len(data)
                if self._bytes > MOST_STATIC_BYTES:
                    why = f"lanes, signs and the like have more than {MOST_STATIC_BYTES:,} bytes"
                    raise _wrong(file, why)
                self.static[kind][key] = decoded(data, table, file)
                if kind == "traffic_sign":
                    self._first[kind][key] = data
            elif kind == "traffic_sign" and data != self._first[kind][key]:
                self.changing_signs.add(key)


def read_content(path: Path) -> TraceContent:
    """Read a trace. Raises RulecError R0610, R0701."""
    content = TraceContent()
    for frame in frames(path):
        content.add(frame)
    if not content.times:
        raise OSI.refused(path, "its messages have no ground truth in them")
    return content


def _id(fields: Fields, name: str, file: WireFile) -> str:
    key = id_of(fields)
    if key is None:
        raise _wrong(file, f"{name} has no `id`")
    return key


def _wrong(file: WireFile, why: str) -> RulecError:
    return file.form.refused(file.path, why)
