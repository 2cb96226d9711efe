"""States of a running trace as JSON Lines; see docs/online.md."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import IO, Any

import msgspec

from rulec.diagnostics import RulecError, SourceLocation
from rulec.trace.formats.foreign_files import foreign
from rulec.trace.formats.json_line_problems import Kind
from rulec.trace.formats.stream_lines import lines_as_they_come
from rulec.trace.trace_model import State

LONGEST_LINE_BYTES = 256 << 20
"""A longer line is refused: it is not a state but a stream that lacks its line ends."""


@dataclass(frozen=True, slots=True)
class LiveState:
    """State with its objects, their types, and its source location."""

    state: State
    objects: dict[str, str]
    place: SourceLocation


class _Record(msgspec.Struct, forbid_unknown_fields=True):
    state: dict[str, bool | float | str | dict[str, Any]]
    objects: dict[str, str] = {}


_STATE = Kind(
    "state",
    _Record.__struct_fields__,
    'a state is a line such as {"state": {…}, "objects": {"v1": "vehicle"}}',
)
_DECODER = msgspec.json.Decoder(_Record)


def read_live(stream: IO[bytes], file: str) -> Iterator[LiveState | RulecError]:
    """Read the states of a stream as their lines arrive.

    Blank lines are skipped.

    Args:
        stream: the open file.
        file: its name, for messages.

    Yields:
        For every line a LiveState, or the RulecError (R0501) that says why it is none.
    """
    number = 0
    for lines in lines_as_they_come(stream, LONGEST_LINE_BYTES):
        for line in lines:
            number += 1
            if number == 1:
                line = line.removeprefix(b"\xef\xbb\xbf")
                result = foreign(line)
                if result is not None:
                    message = f"these are no states, but {result.noun}"
                    yield _STATE.bad(message, SourceLocation(file), result.help)
                    return
            if line.strip():
                yield _read(line, SourceLocation(file, number))


def _read(line: bytes, place: SourceLocation) -> LiveState | RulecError:
    if len(line) > LONGEST_LINE_BYTES:
        return _STATE.bad(f"the line is longer than {LONGEST_LINE_BYTES >> 20} MiB", place)
    try:
        record = _DECODER.decode(line)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as problem:
        return _STATE.refused(problem, line, place)
    return LiveState(record.state, record.objects, place)
