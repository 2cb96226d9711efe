"""File formats by name, and the error for a file that is not of the expected format."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rulec.diagnostics import RulecError, SourceLocation
from rulec.files.read_files import opened
from rulec.recordings.recording_messages import NOT_A_RECORDING


@dataclass(frozen=True, slots=True)
class FileFormat:
    """A file format: its name with an article, a help text, and the largest size of a file."""

    words: str
    help: str
    largest_bytes: int = 200_000_000

    def content(self, path: Path) -> bytes:
        """All bytes of a file.

        Raises RulecError R0610 if it is too large, R0701 if it cannot be read.
        """
        most = self.largest_bytes
        with opened(path) as stream:
            data = stream.read(most + 1)
        if len(data) > most:
            raise self.refused(path, f"it is too large: at most {most:,} bytes are read")
        return data

    def refused(
        self,
        path: Path,
        why: str,
        place: int | None = None,
        *,
        expected: str = "",
        help_text: str = "",
    ) -> RulecError:
        """The error (R0610) for a file that is not of this format, with the line if known."""
        at, line = self.placed(place)
        message = f"the file cannot be read as {self.words}: {at}{why}"
        where = SourceLocation(str(path), line)
        return NOT_A_RECORDING.error(where, message, expected=expected, help=help_text or self.help)

    def placed(self, place: int | None) -> tuple[str, int | None]:
        """What a message says of a place before its reason, and its line."""
        return "", place


@dataclass(frozen=True, slots=True, kw_only=True)
class XmlFormat(FileFormat):
    """A format of XML files, with its root element."""

    root: str


@dataclass(frozen=True, slots=True)
class BinaryFormat(FileFormat):
    """A format of binary files, in which places are byte offsets."""

    largest_bytes: int = 50_000_000

    def placed(self, place: int | None) -> tuple[str, int | None]:
        """The byte at a place, which has no line."""
        return "" if place is None else f"at byte {place:,}, ", None
