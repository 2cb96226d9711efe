"""States of a running trace as JSON Lines; see docs/online.md."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import chain
from typing import IO, Any

import msgspec

from rulec.diagnostics import RulecError, SourceLocation
from rulec.trace.formats.json_line_problems import LONGEST_LINE_BYTES, Kind
from rulec.trace.formats.stream_lines import foreign, lines_as_they_come
from rulec.trace.trace_model import State


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
    _Record,
    'a state is a line such as {"state": {…}, "objects": {"v1": "vehicle"}}',
)


def read_live(stream: IO[bytes], file: str) -> Iterator[LiveState | RulecError]:
    """Read the states of a stream as their lines arrive.

    For every line that is not blank there is a LiveState, or the RulecError (R0501) that says why
    it is none; the stream is called ``file`` in messages.
    """
    lines = chain.from_iterable(lines_as_they_come(stream, LONGEST_LINE_BYTES))
    for number, line in enumerate(lines, 1):
        if number == 1:
            line = line.removeprefix(b"\xef\xbb\xbf")
            result = foreign(line)
            if result is not None:
                message = f"these are no states, but {result.noun}"
                yield _STATE.bad(message, SourceLocation(file), result.help)
                return
        if line.strip():
            place = SourceLocation(file, number)
            record = _STATE.read(line, place)
            if isinstance(record, RulecError):
                yield record
            else:
                yield LiveState(record.state, record.objects, place)
