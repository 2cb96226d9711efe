"""JSON read into types within limits; keys that no type declares are skipped."""

from __future__ import annotations

from codecs import BOM_UTF8
from pathlib import Path
from typing import TypeVar

import msgspec

from rulec.recordings.encodings.file_format import FileFormat

T = TypeVar("T")


def read_json(path: Path, form: FileFormat, kind: type[T]) -> T:
    """The content of a file as a value of a type, which bounds its depth.

    Raises RulecError R0610 for a file that is too large for the format, broken, or of other
    content, with the place as a path of keys or a byte; R0701 if it cannot be opened.
    """
    data = form.content(path)
    try:
        return msgspec.json.decode(data.removeprefix(BOM_UTF8), type=kind)
    except (msgspec.DecodeError, UnicodeDecodeError, ValueError) as reason:
        words = "".join(x if x.isprintable() else "?" for x in str(reason)[:200])
        raise form.refused(path, words) from None
    except RecursionError:
        raise form.refused(path, "its parts are too deep in each other") from None
