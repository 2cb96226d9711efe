"""Traces as JSON Lines: one trace a line, read and written one at a time. See docs/traces.md."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import IO, Any

import msgspec

from rulec.diagnostics import Diagnostic, Place, RulecError
from rulec.diagnostics.json_words import json_words
from rulec.trace.model import Trace

LONGEST_LINE_BYTES = 256 << 20
"""A longer line is refused: it is not a trace but a file that lacks its line ends."""


class _Record(msgspec.Struct, forbid_unknown_fields=True):
    states: list[dict[str, bool | float | str | dict[str, Any]]]
    id: str | int = ""
    step_s: float = 1.0
    objects: dict[str, str] = {}
    present: dict[str, tuple[int, int]] = {}


_DECODER = msgspec.json.Decoder(_Record)


def read_traces(stream: IO[bytes], file: str) -> Iterator[Trace | RulecError]:
    """The traces of a stream, one per line, blank lines skipped; never more than a line in memory.

    Args:
        stream: the open file.
        file: its name, for messages.

    Yields:
        For every line a Trace, or the RulecError (R0501) that says why it is none; for a stream
        without any trace one RulecError (R0501).
    """
    number = found = 0
    while line := stream.readline(LONGEST_LINE_BYTES + 1):
        number += 1
        if number == 1:
            line = line.removeprefix(b"\xef\xbb\xbf")
        place = Place(file, number)
        found += bool(line.strip())
        if len(line) > LONGEST_LINE_BYTES:
            yield _bad(f"the line is longer than {LONGEST_LINE_BYTES >> 20} MiB", place)
            while line and not line.endswith(b"\n"):
                line = stream.readline(LONGEST_LINE_BYTES)
        elif line.strip():
            yield _trace(line, place)
    if not found:
        yield _bad("there is no trace in this file", Place(file))


def _trace(line: bytes, place: Place) -> Trace | RulecError:
    try:
        record = _DECODER.decode(line)
    except RecursionError:
        return _bad("this is not a trace: it is nested too deep", place)
    except (msgspec.MsgspecError, UnicodeDecodeError) as problem:
        message = f"this is not a trace: {json_words(problem)}"
        return _bad(message, place, 'a trace is a line such as {"id": "t1", "states": [{…}, {…}]}')
    return Trace(
        str(record.id) or f"line {place.line}",
        record.step_s,
        record.objects,
        tuple(record.states),
        record.present,
        place,
    )


def _bad(message: str, place: Place, help_text: str = "") -> RulecError:
    return RulecError(Diagnostic("R0501", message, place, help=help_text))


def write_traces(traces: Iterable[Trace], stream: IO[bytes]) -> int:
    """Write traces, one a line, and return how many."""
    encoder = msgspec.json.Encoder()
    count = 0
    for count, trace in enumerate(traces, 1):  # noqa: B007 - the count is the result
        stream.write(encoder.encode(as_record(trace)))
        stream.write(b"\n")
    return count


def as_record(trace: Trace) -> dict[str, Any]:
    """A trace as the object of its line."""
    record: dict[str, Any] = {
        "id": trace.id,
        "step_s": trace.step_s,
        "objects": trace.objects,
        "states": trace.states,
    }
    return {**record, "present": trace.present} if trace.present else record
