"""Findings of verdicts as events in MCAP, which viewers show beside the recording.

Lichtblick and Foxglove show the types ``foxglove.Log`` and ``foxglove.SceneUpdate``:
https://docs.foxglove.dev/docs/sdk/schemas. The frame is called global by viewers of OSI.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from io import BytesIO
from itertools import count
from typing import IO, Any

from mcap.writer import CompressionType, Writer

from rulec.diagnostics import SourceLocation
from rulec.files.file_messages import UNWRITABLE_FILE
from rulec.report.findings.verdict_finding import (
    COLUMNS,
    FindingContext,
    RecordingFindings,
    VerdictFinding,
)

FRAME = "global"
"""The frame of the recording's coordinates, as named by the OSI converter of viewers."""

LEAST_SHOWN_S = 1.0
"""The time for which a violation is shown at least."""

_NS = 1_000_000_000
_NEVER_NS = 1 << 64
_TEXT_HEIGHT_M = 3.0
_LEVELS = {"hard": 4, "soft": 3}
_INFO = 2
_COLOURS = {"hard": (0.84, 0.15, 0.16, 1.0), "soft": (0.93, 0.6, 0.0, 1.0)}


class McapWriter:
    """Three topics: each finding as data, as a line of a log, and as a label at the vehicle.

    A file has one time line, so it contains one recording.
    """

    def __init__(self, stream: IO[bytes], about: FindingContext, name: str) -> None:
        self._stream = stream
        self._about = about
        self._name = name
        self._recording: RecordingFindings | None = None

    def add(self, recording: RecordingFindings) -> None:
        """Store the findings of the recording. Raises RulecError R0702 for a second one."""
        if self._recording is not None:
            raise UNWRITABLE_FILE.error(
                SourceLocation(self._name),
                "MCAP has one time line, and there are several recordings to write into the file",
                help="give one recording, or choose one with --scenario",
            )
        self._recording = recording

    def close(self) -> None:
        """Write the file."""
        recording = self._recording or RecordingFindings("", "", (), ())
        not_judged = sorted(
            {finding.rule for finding in recording.findings if finding.outcome == "not_judged"}
        )
        about = {
            "file": recording.file,
            "recording": recording.recording,
            "rulebook": self._about.rulebook.name,
            "drives": str(len(recording.drives)),
            "not_judged": ", ".join(name for name in not_judged if name),
        }
        messages = [message for finding in recording.findings for message in _messages(finding)]
        if any(time >= _NEVER_NS for time, _, _ in messages):
            raise UNWRITABLE_FILE.error(
                SourceLocation(self._name),
                "MCAP counts time in ns up to 584 years, and some finding is later",
                help="write JSON Lines or CSV, or give the trace its real `step_s`",
            )
        # Standard output has no positions
        content = BytesIO()
        writer = Writer(content, compression=CompressionType.NONE)
        writer.start(library=f"rulec {self._about.version}")
        channels = {}
        for topic, (name, example) in _EXAMPLES.items():
            schema = json.dumps({"title": name, **_schema_of(example)}).encode()
            number = writer.register_schema(name, "jsonschema", schema)
            channels[topic] = writer.register_channel(topic, "json", number), count()
        for time, topic, message in sorted(messages, key=lambda message: message[0]):
            number, places = channels[topic]
            writer.add_message(number, time, json.dumps(message).encode(), time, next(places))
        # A file's name need not be Unicode
        printable = {k: v.encode("utf-8", "backslashreplace").decode() for k, v in about.items()}
        writer.add_metadata("rulec", printable)
        writer.finish()
        self._stream.write(content.getvalue())


def _messages(finding: VerdictFinding) -> Iterator[tuple[int, str, dict[str, Any]]]:
    """Time (ns), topic and content of a finding's messages; none if it has no time."""
    at_s = finding.from_s if finding.at_s is None else finding.at_s
    if at_s is None:
        return
    begin_ns = max(0, round(at_s * _NS)) if at_s < _NEVER_NS else _NEVER_NS
    # Without null values, which fit none of the types announced to viewers
    known = {name: value for name, value in finding.row().items() if value is not None}
    yield begin_ns, "/rulec/findings", {"version": 1, **known}
    yield begin_ns, "/rulec/log", _log(finding, begin_ns)
    if finding.outcome == "violated" and finding.x is not None and finding.y is not None:
        yield begin_ns, "/rulec/scene", _scene_update(finding, begin_ns)


def _log(finding: VerdictFinding, begin_ns: int) -> dict[str, Any]:
    return {
        "timestamp": _time(begin_ns),
        "level": _LEVELS[finding.strength] if finding.outcome == "violated" else _INFO,
        "message": finding.says,
        "name": f"rulec {finding.rulebook}",
        "file": finding.file,
        "line": 0,
    }


def _scene_update(finding: VerdictFinding, begin_ns: int) -> dict[str, Any]:
    begins_s = begin_ns / _NS
    lasts_s = max((finding.to_s or 0.0) - begins_s, LEAST_SHOWN_S)
    position = {"x": finding.x, "y": finding.y, "z": _TEXT_HEIGHT_M}
    label = {
        "pose": {"position": position, "orientation": {"x": 0.0, "y": 0.0, "z": 0.0, "w": 1.0}},
        "billboard": True,
        "font_size": 14.0,
        "scale_invariant": True,
        "color": dict(zip("rgba", _COLOURS[finding.strength], strict=True)),
        "text": finding.says,
    }
    entity = {
        "timestamp": _time(begin_ns),
        "frame_id": FRAME,
        "id": "/".join((finding.rule, finding.vehicle, *finding.other)),
        "lifetime": _time(round(lasts_s * _NS)),
        "frame_locked": False,
        "metadata": [
            {"key": "rule", "value": finding.rule},
            {"key": "provision", "value": finding.provision},
        ],
        **{name: [] for name in _NO_SHAPES},
        "texts": [label],
    }
    return {"deletions": [], "entities": [entity]}


def _time(time_ns: int) -> dict[str, int]:
    return {"sec": time_ns // _NS, "nsec": time_ns % _NS}


_NO_SHAPES = ("arrows", "cubes", "spheres", "cylinders", "lines", "triangles", "models")


def _schema_of(example: object) -> dict[str, Any]:
    """The JSON schema of messages like this one; a list without items may contain any object."""
    if isinstance(example, dict):
        properties = {name: _schema_of(value) for name, value in example.items()}
        return {"type": "object", "properties": properties}
    if isinstance(example, list):
        return {"type": "array", "items": _schema_of(example[0]) if example else {"type": "object"}}
    return {"type": _TYPES[type(example)]}


_TYPES = {bool: "boolean", int: "integer", float: "number", str: "string"}
_ANY = VerdictFinding(file="", strength="hard", outcome="violated", x=0.0, y=0.0)
# Viewers support no alternatives: a value that may be null has its other type here, or is left out.
_VALUES = {str: "", float: 0.0, list: [""]}
_FINDING = {"version": 1, **{name: _VALUES[kind] for name, kind in COLUMNS.items()}}
_DELETION = {"timestamp": _time(0), "type": 0, "id": ""}
_EXAMPLES = {
    "/rulec/findings": ("rulec.Finding", _FINDING),
    "/rulec/log": ("foxglove.Log", _log(_ANY, 0)),
    "/rulec/scene": ("foxglove.SceneUpdate", {**_scene_update(_ANY, 0), "deletions": [_DELETION]}),
}
"""Topic -> its type, and a message."""
