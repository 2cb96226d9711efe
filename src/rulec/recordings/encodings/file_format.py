"""Formats of files by name, and the error for a file of another one."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

from rulec.diagnostics import RulecError, SourceLocation
from rulec.files import opened
from rulec.recordings.recording_messages import NOT_A_RECORDING


@dataclass(frozen=True, slots=True)
class FileFormat:
    """A format of files: its name with an article, help, and how large a file may be."""

    words: str
    help: str
    largest_bytes: int = 200_000_000

    def content(self, path: Path) -> bytes:
        """All bytes of a file. Raises RulecError R0610 for too many, R0701 if it cannot be read."""
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
        """The error (R0610) for a file of another format, with the line if that is known."""
        message = f"the file cannot be read as {self.words}: {why}"
        where = SourceLocation(str(path), place)
        return NOT_A_RECORDING.error(where, message, expected=expected, help=help_text or self.help)


@dataclass(frozen=True, slots=True, kw_only=True)
class XmlFormat(FileFormat):
    """A format of XML files, with its root element."""

    root: str


@dataclass(frozen=True, slots=True)
class BinaryFormat(FileFormat):
    """A format of binary files, in which places are counted in bytes."""

    largest_bytes: int = 50_000_000

    def refused(
        self,
        path: Path,
        why: str,
        place: int | None = None,
        *,
        expected: str = "",
        help_text: str = "",
    ) -> RulecError:
        """The error (R0610) for a file of another format, with the byte if that is known."""
        where = "" if place is None else f"at byte {place:,}, "
        # The class's own: a dataclass with slots is made anew, so that ``super()`` is another one.
        return FileFormat.refused(
            self, path, f"{where}{why}", expected=expected, help_text=help_text
        )
