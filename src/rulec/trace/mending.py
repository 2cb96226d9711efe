"""The way out for who has written a line that cannot be read."""

from __future__ import annotations

import re
from collections.abc import Iterable

from rulec.diagnostics import did_you_mean

_UNKNOWN_FIELD = re.compile(r"unknown field `(.*?)`(?! - at)", re.DOTALL)
_REFUSED_BYTE = re.compile(r"\(byte ([0-9]+)\)")


def way_out(problem: Exception, line: bytes, fields: Iterable[str], example: str) -> str:
    """Help with a line that the decoder of a record with these fields refuses in these words."""
    words = str(problem)
    unknown = _UNKNOWN_FIELD.search(words)
    if unknown is not None:
        near = did_you_mean(unknown[1], fields)
        if near:
            return near
    refused = _REFUSED_BYTE.search(words)
    if refused is not None:
        found = line[int(refused[1]) :]
        if found.lstrip(b"-+").startswith((b"NaN", b"nan", b"Infinity", b"inf")):
            return "JSON has no `NaN` and no infinity: a value has to be a number"
        if found.startswith((b"'", b"True", b"False", b"None")):
            return "in JSON texts stand in double quotes, and it is `true`, `false`, `null`"
    return example
