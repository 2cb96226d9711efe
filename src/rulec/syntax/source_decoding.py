"""From bytes to a source that can be a rulebook's text."""

from __future__ import annotations

from rulec.diagnostics import Source, SourceLocation
from rulec.file_messages import FILE_TOO_LARGE
from rulec.files import MAX_SOURCE_BYTES, decoded, without_null


def decode(name: str, data: bytes) -> Source:
    """The text of a rulebook file; a byte order mark is dropped.

    Raises:
        RulecError: more than ``MAX_SOURCE_BYTES``, not UTF-8, or not a text at all.
    """
    _check_size(name, len(data))
    return decoded(name, data)


def checked(source: Source) -> Source:
    """The source, if it can be a rulebook's text.

    Raises:
        RulecError: too large, or it holds a null character.
    """
    _check_size(source.name, len(source.text))
    return without_null(source)


def _check_size(name: str, size: int) -> None:
    if size > MAX_SOURCE_BYTES:
        raise FILE_TOO_LARGE.error(
            SourceLocation(name),
            f"the file is too large: at most {MAX_SOURCE_BYTES:,} bytes are read",
            help="split it into several rulebooks",
        )
