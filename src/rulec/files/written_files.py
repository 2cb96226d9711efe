"""Files written completely or not at all, and folders for them."""

from __future__ import annotations

import os
import stat
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from errno import EACCES, EDQUOT, EEXIST, EISDIR, ENOENT, ENOSPC, ENOTDIR, EROFS
from pathlib import Path
from typing import IO, Final

from rulec.diagnostics import RulecError
from rulec.files.file_messages import no_temporary_files, not_the_same, unwritable
from rulec.files.work_trees import refuse_link_out

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


def make_folder(path: Path) -> None:
    """Make a folder and its parents. Raises RulecError R0702, R0730."""
    refuse_link_out(path)
    with refusals(path):
        path.mkdir(parents=True, exist_ok=True)


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
