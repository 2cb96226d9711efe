"""Files: read as bytes or UTF-8 text, unpacked on the way, written whole or never."""

from __future__ import annotations

import gc
import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from contextvars import ContextVar
from dataclasses import replace
from errno import EACCES, EEXIST, EISDIR, ENOTDIR, EROFS
from io import SEEK_CUR, SEEK_END, BufferedReader, RawIOBase
from pathlib import Path
from typing import IO, Any, Final, cast
from unicodedata import normalize

from rulec.diagnostics import Label, RulecError, Source, SourceLocation, Span, nearest_name
from rulec.file_messages import (
    NOT_UTF8,
    TOO_LONG_TO_READ,
    UNREADABLE_FILE,
    not_the_same,
    not_utf8,
    reason_in_words,
    unwritable,
)
from rulec.work_trees import refuse_link_out

MAX_SOURCE_BYTES: Final = 5_000_000
"""A rulebook has thousands of characters; millions are a mistake."""

MAX_LAW_BYTES: Final = 5_000_000
"""The text of a law, or a saved audit; no state's road traffic act has half of it."""

MAX_SAVED_BYTES: Final = 100_000_000
"""A compiled rulebook or a saved monitor."""

MAX_SETTINGS_BYTES: Final = 1_000_000
"""A project's settings."""

LARGEST_UNPACKED: Final = 4_000_000_000
"""Bytes of a packed file, unpacked; a thousandth of them may hide so many."""

PACKED: Final = b"\x1f\x8b"
"""How files packed with gzip begin (RFC 1952)."""

STANDARD_INPUT_COPY: Final = "RULEC_STANDARD_INPUT"
"""The environment variable that names a copy of standard input: a file of the copy's name in the
working folder means that copy, in processes that work for this one, too."""

FileState = tuple[int, int]
"""A file's size (bytes) and the time at which it was last changed (ns)."""

_noted: ContextVar[dict[str, FileState] | None] = ContextVar("_noted", default=None)


@contextmanager
def files_read() -> Iterator[dict[str, FileState]]:
    """What files are opened for reading in the block, and what they are like then."""
    states: dict[str, FileState] = {}
    token = _noted.set(states)
    try:
        yield states
    finally:
        _noted.reset(token)


def note_read(path: str | Path) -> FileState | None:
    """Say that a file counts as read here, perhaps before; what it is like, if it is there."""
    try:
        state = file_state(path)
    except OSError:
        return None
    noted = _noted.get()
    return state if noted is None else noted.setdefault(str(path), state)


def file_state(path: str | Path) -> FileState:
    """What a file is like. Raises OSError."""
    result = Path(path).stat()
    return result.st_size, result.st_mtime_ns


OF_OTHERS: Final = stat.S_IWGRP | stat.S_IWOTH
"""Permissions to write for anybody but the owner."""


def is_own(status: os.stat_result) -> bool:
    """Tell whether a file or a folder is this user's, and nobody else may write to it."""
    return status.st_uid == os.geteuid() and not status.st_mode & OF_OTHERS


@contextmanager
def written_whole(path: Path, *, in_place: bool = False) -> Iterator[IO[bytes]]:
    """Open a stream that replaces a file only when the block succeeds.

    A file that is replaced keeps its permissions, and has to permit it. It is on the disk before
    the old one is gone.

    Args:
        path: the file; a link is followed, unless it leads out of its tree.
        in_place: refuse a file that would not be the same afterwards: that has further names, or
            an owner who cannot be kept.

    Raises RulecError: R0702 if the file cannot be written, R0730 behind a link out of the tree,
        R0734 with ``in_place``.
    """
    refuse_link_out(path)
    with refusals(path):
        if not is_replaced(path):
            with path.open("wb") as stream:
                yield stream
            return
        real = Path(os.path.realpath(path))  # the file behind a link, not the link, is replaced
        if in_place and real.stat().st_nlink > 1:
            raise not_the_same(path, "it has several names, which would not be one file any more")
        # Of a long name only the beginning: a folder takes no more than 255 bytes.
        beginning = os.fsencode(real.name)[:200].decode("utf-8", "ignore")
        name = real.with_name(f".{beginning}.{os.urandom(8).hex()}.part")
        # What is made here is made inside the `try`: whenever a signal comes, nothing stays behind.
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
    """What goes wrong with a file that is written, as a message. Raises RulecError R0702."""
    try:
        yield
    except OSError as problem:
        raise RulecError(unwritable(path, problem)) from None


def is_replaced(path: Path) -> bool:
    """Whether a file may be replaced; what is a pipe or a device such as /dev/null is not."""
    if path.is_dir():
        raise IsADirectoryError(EISDIR, "it is a folder")
    if not path.exists():
        return True
    if path.is_file() and not os.access(path, os.W_OK):
        raise PermissionError(EACCES, os.strerror(EACCES))
    return path.is_file()


def refuse_unwritable(path: Path, *, is_folder: bool = False) -> None:
    """Refuse a file, or a folder for files, of which can be told that it cannot be written.

    It is asked before there is anything to write, which may take long; nothing is made.

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
    """Wait until what was written would survive that the machine stops."""
    stream.flush()
    with suppress(OSError):  # some file systems cannot
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
    """Open a file that is for its owner alone."""
    return os.open(name, flags, 0o600)


def as_before(name: Path, path: Path) -> bool:
    """Give a new file the permissions and the owner of the one that it replaces, if there is one.

    Returns whether the owner could be kept. A new one has the default permissions of the umask.
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
    name.chmod(mode)  # after the owner, with whom some permissions go
    return is_kept


def from_here(file: str) -> str:
    """A file below the working folder as it is named from there, as runners of tests want it."""
    below = os.path.relpath(file) if os.path.isabs(file) else file  # noqa: PTH117 - a name alone
    return file if below.startswith(os.pardir) else below


def is_folder(path: Path) -> bool:
    """True for a folder; a name that nothing can have, such as one too long, is none."""
    try:
        return path.is_dir()
    except (OSError, ValueError):
        return False


def make_folder(path: Path) -> None:
    """Make a folder and those above it. Raises RulecError R0702, R0730."""
    refuse_link_out(path)
    with refusals(path):
        path.mkdir(parents=True, exist_ok=True)


@contextmanager
def opened(
    path: Path,
    way_out: str = "check its name and its permissions",
    labels: tuple[Label, ...] = (),
) -> Iterator[IO[bytes]]:
    """A file opened for reading; one that is packed with gzip is unpacked on the way.

    Raises RulecError: R0701, with this way out and these labels; while it is read, R0701 for what
    is packed and damaged, or larger than ``LARGEST_UNPACKED``.
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
    """The question whether a file beside a missing one is meant; empty if none is called alike."""
    with suppress(OSError, ValueError):
        near = nearest_name(path.name, sorted(os.listdir(path.parent)), alike=0.8)  # noqa: PTH208 - names alone
        if near is not None:
            return f"did you mean `{path.with_name(near)}`?"
    return ""


def read_whole(stream: IO[bytes], path: Path, most: int) -> bytes:
    """The bytes of an open file that is read as a whole. Raises RulecError R0736 beyond a limit."""
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
    """The content of a packed file, up to a limit."""

    def __init__(self, stream: IO[bytes], path: Path) -> None:
        # 1 ms: only for what is packed.
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
            # Where the end is shows only there.
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
    """The text of a file in UTF-8, whatever editor it came from.

    A byte order mark is dropped, every line end becomes one line feed, and letters with marks take
    their composed form, so that names that look alike are alike.

    Raises RulecError: R0101 if it is in another encoding, or no text at all.
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
            # It is no rulebook, and may be anything, such as a process's environment.
            replace(place, excerpt=""),
            "the file holds a null character and is not a text",
            help="give a file of plain text in UTF-8",
        )
    return source


@contextmanager
def no_garbage_collection() -> Iterator[None]:
    """Let no garbage be looked for while much is read, or made of it, that stays: it takes long."""
    was_on = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if was_on:
            gc.enable()
