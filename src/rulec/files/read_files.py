"""Files read, as bytes or as UTF-8 text, decompressed if needed."""

from __future__ import annotations

import os
import re
import zlib
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import replace
from io import SEEK_CUR, SEEK_END, BufferedReader, RawIOBase
from pathlib import Path
from typing import IO, Any, Final, cast
from unicodedata import normalize

from rulec.diagnostics import Label, RulecError, Source, SourceLocation, Span, nearest_name
from rulec.enforced_limits import allow_for
from rulec.files.file_messages import (
    NOT_UTF8,
    TOO_LONG_TO_READ,
    UNREADABLE_FILE,
    not_utf8,
    reason_in_words,
)

MAX_SOURCE_BYTES: Final = 5_000_000
"""The largest rulebook source (bytes); rulebooks have thousands of characters."""

MAX_LAW_BYTES: Final = 5_000_000
"""The largest law text or saved audit (bytes); no road traffic act has half of that."""

MAX_SAVED_BYTES: Final = 100_000_000
"""The largest compiled rulebook or saved monitor (bytes)."""

MAX_SETTINGS_BYTES: Final = 1_000_000
"""The largest settings file (bytes)."""

LARGEST_UNPACKED: Final = 4_000_000_000
"""The most bytes of a decompressed file; the gzip file may be a thousandth as large."""

PACKED: Final = b"\x1f\x8b"
"""The first bytes of gzip files (RFC 1952)."""

STANDARD_INPUT_COPY: Final = "RULEC_STANDARD_INPUT"
"""The environment variable with the name of a copy of standard input, also for worker processes.

A file of that name in the working folder means the copy.
"""

FileState = tuple[int, int]
"""A file's size (bytes) and the time at which it was last changed (ns)."""

_noted: ContextVar[dict[str, FileState] | None] = ContextVar("_noted", default=None)


@contextmanager
def files_read() -> Iterator[dict[str, FileState]]:
    """The files opened for reading in the block, with their state at that time."""
    states: dict[str, FileState] = {}
    token = _noted.set(states)
    try:
        yield states
    finally:
        _noted.reset(token)


def note_read(path: str | Path) -> FileState | None:
    """Record that a file counts as read here; its state when first read, None if it is missing."""
    try:
        state = file_state(path)
    except OSError:
        return None
    noted = _noted.get()
    return state if noted is None else noted.setdefault(str(path), state)


def file_state(path: str | Path) -> FileState:
    """The size and time of a file. Raises OSError."""
    result = Path(path).stat()
    return result.st_size, result.st_mtime_ns


def from_here(file: str) -> str:
    """The relative name of a file below the working folder, as test runners expect it."""
    below = os.path.relpath(file) if os.path.isabs(file) else file  # noqa: PTH117 - a name alone
    return file if below.startswith(os.pardir) else below


def is_folder(path: Path) -> bool:
    """Whether a path is a folder; False for impossible names, such as one that is too long."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


@contextmanager
def opened(
    path: Path,
    way_out: str = "check its name and its permissions",
    labels: tuple[Label, ...] = (),
) -> Iterator[IO[bytes]]:
    """A file opened for reading; a gzip file is decompressed while it is read.

    Raises RulecError: R0701, with this way out and these labels; while reading, R0701 for a damaged
    gzip file, or one larger than ``LARGEST_UNPACKED``.
    """
    try:
        stream = _in_place_of(path).open("rb")
        is_packed = stream.peek(len(PACKED)).startswith(PACKED)
    except (OSError, ValueError) as problem:  # ValueError: a null character in the name
        message = f"the file cannot be read: {reason_in_words(problem)}"
        if path.parts[:1] in (("http:",), ("https:",)):
            way_out = "download it first: rulec opens no connections"
        elif isinstance(problem, FileNotFoundError):
            way_out = _beside(path) or way_out
        place = SourceLocation(str(path))
        raise UNREADABLE_FILE.error(place, message, help=way_out, labels=labels) from None
    note_read(path)
    allow_for(str(path), os.fstat(stream.fileno()).st_size)
    with stream:
        if is_packed:
            with BufferedReader(_Unpacking(stream, path)) as unpacked:
                yield cast("IO[bytes]", unpacked)
        else:
            yield stream


def _beside(path: Path) -> str:
    """A question suggesting a file with a similar name in the folder; empty if there is none."""
    with suppress(OSError, ValueError):
        near = nearest_name(path.name, sorted(os.listdir(path.parent)), alike=0.8)  # noqa: PTH208 - names alone
        if near is not None:
            return f"did you mean `{path.with_name(near)}`?"
    return ""


def read_whole(stream: IO[bytes], path: Path, most: int) -> bytes:
    """All bytes of an open file. Raises RulecError R0736 if there are more than ``most``."""
    data = stream.read(most + 1)
    if len(data) > most:
        raise TOO_LONG_TO_READ.error(
            SourceLocation(str(path)),
            f"the file has more than {most:,} bytes, packed ones unpacked",
            help="no file of its kind is as long; is it another one?",
        )
    return data


def _in_place_of(path: Path) -> Path:
    copy = os.environ.get(STANDARD_INPUT_COPY, "")
    return Path(copy) if copy and str(path) == os.path.basename(copy) else path  # noqa: PTH119


class _Unpacking(RawIOBase):
    """The decompressed content of a gzip file, up to a limit."""

    def __init__(self, stream: IO[bytes], path: Path) -> None:
        import gzip  # 1 ms, only for gzip files

        self._gzip = gzip.GzipFile(fileobj=stream)
        self._damaged = gzip.BadGzipFile, zlib.error
        self._path = path

    def readable(self) -> bool:
        return True

    def seekable(self) -> bool:
        return True

    def tell(self) -> int:
        return self._gzip.tell()

    def seek(self, offset: int, whence: int = 0) -> int:
        if whence == SEEK_END:
            # The position of the end is only known after reading everything.
            while self.read(1 << 16):
                pass
            whence = SEEK_CUR
        return self._gzip.seek(offset, whence)

    def readinto(self, buffer: Any) -> int:
        try:
            data = self._gzip.read(len(buffer))
        except EOFError:
            raise self._refused("it is packed, and ends too soon") from None
        except self._damaged:
            raise self._refused("it is packed, and damaged") from None
        allow_for(str(self._path), self._gzip.tell())
        if self._gzip.tell() > LARGEST_UNPACKED:
            raise self._refused(
                f"it is packed, and larger than {LARGEST_UNPACKED:,} bytes when unpacked"
            )
        buffer[: len(data)] = data
        return len(data)

    def _refused(self, why: str) -> RulecError:
        return UNREADABLE_FILE.error(
            SourceLocation(str(self._path)),
            f"the file cannot be read: {why}",
            help="pack it anew, with `gzip`, or give it as it was before",
        )


def decoded(name: str, data: bytes) -> Source:
    """The text of a UTF-8 file, normalized.

    A byte order mark is dropped, every line end becomes one line feed, and letters with diacritics
    are composed, so that names that look the same are the same.

    Raises RulecError: R0101 if it has another encoding, or is not text.
    """
    try:
        text = data.decode("utf-8")
    except UnicodeDecodeError as reason:
        raise RulecError(not_utf8(name, data, reason.start)) from None
    text = text.removeprefix("\ufeff").replace("\r\n", "\n").replace("\r", "\n")
    return without_null(Source(name, normalize("NFC", text)))


def without_null(source: Source) -> Source:
    """The source itself. Raises RulecError R0101 for a null character."""
    null = source.text.find("\0")
    if null >= 0:
        place = Span(source, null, null + 1).place
        raise NOT_UTF8.error(
            # No excerpt: the file may be anything, such as a process's environment.
            replace(place, excerpt=""),
            "the file holds a null character and is not a text",
            help="give a file of plain text in UTF-8",
        )
    return source


_HEAD_BYTES: Final = 4096
_KINDS: Final = (
    (rb'"format": "rulec comp', "it is a compiled rulebook: `rulec verify TRAFFIC -r {}` uses it"),
    (rb"\A(?:\s|#.*)*(?:rulebook|vocabulary)\s", "it is a source of rules: see `rulec check {}`"),
    (rb'"outcome": ?|\Akind,.*,outcome,', "it has findings, which `rulec rates {}` counts"),
    (rb'"satisfied": ?', "it has verdicts of `rulec verify`; give what was judged"),
    (rb'"states": ?|\Atrace,step,', "it has traces, which `rulec verify {} -r de` judges"),
    (rb"(?m)^\[+(?:road|obstacle)", "it is a scenario, for `rulec maneuvers {} -r esterle2019`"),
)
"""What is found at the beginning of a file, and what to do with it."""


def what_reads(file: str) -> str:
    """Help that says what a file of rulec's own is, and which verb reads it; empty for others."""
    head = b""
    with suppress(RulecError, ValueError), opened(Path(file)) as stream:
        head = stream.read(_HEAD_BYTES)
    return next((text.format(file) for sign, text in _KINDS if re.search(sign, head)), "")
