"""Files: read as bytes or UTF-8 text, decompressed if needed, written completely or not at all."""

from __future__ import annotations

import gc
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import replace
from errno import EACCES, EDQUOT, EEXIST, EISDIR, ENOENT, ENOSPC, ENOTDIR, EROFS
from io import SEEK_CUR, SEEK_END, BufferedReader, RawIOBase
from pathlib import Path
from typing import IO, Any, Final, cast
from unicodedata import normalize

from rulec.diagnostics import Label, RulecError, Source, SourceLocation, Span, nearest_name
from rulec.file_messages import (
    NOT_UTF8,
    TOO_LONG_TO_READ,
    UNREADABLE_FILE,
    no_temporary_files,
    not_the_same,
    not_utf8,
    reason_in_words,
    unwritable,
)
from rulec.work_trees import refuse_link_out

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


OF_OTHERS: Final = stat.S_IWGRP | stat.S_IWOTH
"""Write permissions for anybody but the owner."""


def is_own(status: os.stat_result) -> bool:
    """Whether a file or folder belongs to this user, and nobody else may write to it."""
    return status.st_uid == os.geteuid() and not status.st_mode & OF_OTHERS


@contextmanager
def written_whole(path: Path, *, in_place: bool = False) -> Iterator[IO[bytes]]:
    """Open a stream that replaces a file only when the block succeeds.

    A replaced file keeps its permissions, and has to be writable. The new file is on the disk
    before the old one is removed.

    Args:
        path: the file; a link is followed, unless it leads out of its tree.
        in_place: refuse a file that would not be the same afterwards: one with further hard links,
            or an owner who cannot be kept.

    Raises RulecError: R0702 if the file cannot be written, R0730 behind a link out of the tree,
    R0734 with ``in_place``.
    """
    refuse_link_out(path)
    with refusals(path):
        if not is_replaced(path):
            with path.open("wb") as stream:
                yield stream
            return
        real = Path(os.path.realpath(path))  # replaces the file behind a link, not the link
        if in_place and real.stat().st_nlink > 1:
            raise not_the_same(path, "it has several names, which would no longer be the same file")
        # Only the beginning of a long name: file names have at most 255 bytes.
        beginning = os.fsencode(real.name)[:200].decode("utf-8", "ignore")
        name = real.with_name(f".{beginning}.{os.urandom(8).hex()}.part")
        # Everything is created inside the `try`, so that nothing is left behind by a signal.
        try:
            with open(name, "xb", opener=private) as stream:
                yield stream
                put_on_disk(stream)
            if not as_before(name, real) and in_place:
                raise not_the_same(path, "its owner could not be kept")
            name.replace(real)
        except BaseException:
            name.unlink(missing_ok=True)
            raise
        put_folder_on_disk(real.parent)


@contextmanager
def refusals(path: Path) -> Iterator[None]:
    """Turn OSErrors of writing a file into RulecError R0702."""
    try:
        yield
    except OSError as problem:
        raise RulecError(unwritable(path, problem)) from None


def is_replaced(path: Path) -> bool:
    """Whether a file may be replaced; a pipe or a device such as /dev/null may not."""
    if path.is_dir():
        raise IsADirectoryError(EISDIR, "it is a folder")
    if not path.exists():
        return True
    if path.is_file() and not os.access(path, os.W_OK):
        raise PermissionError(EACCES, os.strerror(EACCES))
    return path.is_file()


def refuse_unwritable(path: Path, *, is_folder: bool = False) -> None:
    """Refuse a file, or a folder for files, if it is already clear that it cannot be written.

    Called before computing the content, which may take long; nothing is created.

    Raises RulecError: R0702; R0730 behind a link out of the tree.
    """
    refuse_link_out(path)
    with refusals(path):
        place = path if is_folder else path.parent
        if not is_folder and not is_replaced(path):
            return
        while is_folder and not os.path.lexists(place) and place != place.parent:
            place = place.parent
        if not place.is_dir():
            place.stat()
            wrong = EEXIST if place == path else ENOTDIR
            raise OSError(wrong, os.strerror(wrong))
        if os.statvfs(place).f_flag & os.ST_RDONLY:
            raise OSError(EROFS, os.strerror(EROFS))
        if not os.access(place, os.W_OK | os.X_OK):
            raise PermissionError(EACCES, os.strerror(EACCES))


def put_on_disk(stream: IO[bytes]) -> None:
    """Wait until what was written would survive a crash of the machine."""
    stream.flush()
    with suppress(OSError):  # some file systems do not support it
        os.fsync(stream.fileno())


def put_folder_on_disk(folder: Path) -> None:
    """The same for the names in a folder."""
    with suppress(OSError):
        handle = os.open(folder, os.O_RDONLY)
        try:
            os.fsync(handle)
        finally:
            os.close(handle)


def private(name: str, flags: int) -> int:
    """Open a file that only its owner may access."""
    return os.open(name, flags, 0o600)


def as_before(name: Path, path: Path) -> bool:
    """Give a new file the permissions and the owner of the file that it replaces, if any.

    Returns whether the owner could be kept. Without an old file the umask applies.
    """
    is_kept = True
    if path.exists():
        before, now = path.stat(), name.stat()
        if (before.st_uid, before.st_gid) != (now.st_uid, now.st_gid):
            try:
                os.chown(name, before.st_uid, before.st_gid)
            except OSError:
                is_kept = False
        mode = stat.S_IMODE(before.st_mode)
    else:
        mask = os.umask(0)
        os.umask(mask)
        mode = 0o666 & ~mask
    name.chmod(mode)  # after the owner, since changing it clears some permissions
    return is_kept


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


def make_folder(path: Path) -> None:
    """Make a folder and its parents. Raises RulecError R0702, R0730."""
    refuse_link_out(path)
    with refusals(path):
        path.mkdir(parents=True, exist_ok=True)


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
        # Imported late (1 ms): only needed for gzip files.
        import gzip
        import zlib

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


TEMPORARY: Final = "rulec-"
"""How names of folders for temporary files begin."""

_NO_ROOM = (ENOSPC, EDQUOT, ENOENT)
"""Errors of writing, which name no file, and that of a temporary folder that is nowhere."""


@contextmanager
def temporary_files() -> Iterator[None]:
    """While temporary files are written, and nothing else.

    Raises RulecError R0723 if there is no room for them, or no folder.
    """
    try:
        yield
    except OSError as problem:
        name = problem.filename
        if problem.errno not in _NO_ROOM if name is None else f"/{TEMPORARY}" not in str(name):
            raise
        raise no_temporary_files(os.environ.get("TMPDIR") or "/tmp", problem) from None


@contextmanager
def no_garbage_collection() -> Iterator[None]:
    """Switch garbage collection off while many long-lived objects are built: nothing is freed."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
