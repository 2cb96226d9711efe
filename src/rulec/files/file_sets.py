"""Sets of files in a folder that are replaced together: all are new, or all are old.

A list of the new files and their final names (the manifest) is written once all new files are on
the disk. From then on the new ones count: the next program that writes to the folder finishes what
a killed program left undone. Before that point, leftover new files are removed.

A manifest that came with somebody else's files is ignored: it contains, for itself and for each new
file, the inode number given by the system, and for the new files the time of the last change
(ctime). Nobody can choose these, and neither a checkout nor an archive restores them.
"""

from __future__ import annotations

import fcntl
import json
import os
import re
import signal
from collections.abc import Iterator, Mapping
from contextlib import contextmanager, suppress
from pathlib import Path
from threading import current_thread, main_thread
from typing import Any

import msgspec

from rulec.files.work_trees import is_ordinary, refuse_no_source
from rulec.files.written_files import (
    as_before,
    is_own,
    is_replaced,
    private,
    put_folder_on_disk,
    put_on_disk,
    refusals,
)

MANIFEST = ".rulec-writing.json"
_PART = re.compile(r"\.rulec-[0-9a-f]{16}-[0-9]+\.part")
_MOST_BYTES = 100_000_000


def write_together(folder: Path, contents: Mapping[str, bytes]) -> None:
    """Write files of a folder, given by their names, all or none.

    One file is open at a time.

    Raises RulecError: R0702 if one cannot be written, R0730 for links out of the tree, R0731 for
    pipes and devices.
    """
    with refusals(folder), _alone_in(folder):
        _finish(folder)
        mark = os.urandom(8).hex()
        names: dict[str, str] = {}
        try:
            for number, (name, content) in enumerate(contents.items()):
                path = folder / name
                refuse_no_source(path)
                with refusals(path):
                    is_replaced(path)
                    part = f".rulec-{mark}-{number}.part"
                    names[part] = name
                    _write_new(folder / part, path, content)
            with _signals_held_back():
                _commit(folder, mark, names)
                _finish(folder)
        except BaseException:
            # In any case: if there is a manifest the new files count, else the old ones.
            with _signals_held_back():
                _finish(folder)
            raise


@contextmanager
def _signals_held_back() -> Iterator[None]:
    """Delay Ctrl-C and other termination signals until the block has ended.

    Otherwise a signal could come between two renames, and leave the rest to the next program. Only
    the main thread receives signals, so other threads delay nothing.
    """
    came: list[int] = []
    before: dict[int, Any] = {}
    try:
        for wish in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
            handler = signal.getsignal(wish)
            if callable(handler) and current_thread() is main_thread():
                before[wish] = handler
                signal.signal(wish, lambda number, _: came.append(number))
        yield
    finally:
        for number, handler in before.items():
            signal.signal(number, handler)
        for number in came[:1]:
            before[number](number, None)


@contextmanager
def _alone_in(folder: Path) -> Iterator[None]:
    """Wait until no other program writes a set of files to the folder."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        with suppress(OSError):  # some file systems do not support locks
            fcntl.flock(handle, fcntl.LOCK_EX)
        yield
    finally:
        with _signals_held_back():
            os.close(handle)


def _write_new(part: Path, path: Path, content: bytes) -> None:
    with part.open("xb") as stream:
        stream.write(content)
        put_on_disk(stream)
    as_before(part, path)


def _commit(folder: Path, mark: str, names: Mapping[str, str]) -> None:
    """Make new files count from now on, in one step: the manifest gets its final name."""
    part = f".rulec-{mark}-{len(names)}.part"
    try:
        with open(folder / part, "xb", opener=private) as stream:
            known = {own: [name, *_identity(folder / own)] for own, name in names.items()}
            manifest = {"inode": os.fstat(stream.fileno()).st_ino, "files": known}
            stream.write(json.dumps(manifest).encode())
            put_on_disk(stream)
        put_folder_on_disk(folder)
        os.replace(folder / part, folder / MANIFEST)  # noqa: PTH105 - one call for both steps
    except BaseException:
        (folder / part).unlink(missing_ok=True)
        raise
    put_folder_on_disk(folder)


def _finish(folder: Path) -> None:
    """Rename new files to their final names if they count, and remove the rest of them."""
    for part, (name, *identity) in _left_to_do(folder / MANIFEST).items():
        if is_part(folder / part) and _identity(folder / part) == identity:
            with refusals(folder / name):
                os.replace(folder / part, folder / name)  # noqa: PTH105
    put_folder_on_disk(folder)
    (folder / MANIFEST).unlink(missing_ok=True)
    with os.scandir(folder) as entries:
        left = [entry.name for entry in entries if is_part(folder / entry.name)]
    for name in left:
        (folder / name).unlink(missing_ok=True)


def is_part(path: Path) -> bool:
    """Whether a path is a file of an unfinished set, and not a link."""
    return bool(_PART.fullmatch(path.name)) and not path.is_symlink() and is_ordinary(path)


def _identity(path: Path) -> list[int]:
    """Attributes of a file that nobody can choose: inode, and time of the last change (ns)."""
    status = path.stat()
    return [status.st_ino, status.st_ctime_ns]


def _left_to_do(manifest: Path) -> Mapping[str, tuple[str, int, int]]:
    """The new files of a manifest, with their final names and identities.

    None without a manifest, or if it was not written here by this user.
    """
    if manifest.is_symlink() or not is_ordinary(manifest):
        return {}
    try:
        with manifest.open("rb") as stream:
            status = os.fstat(stream.fileno())
            listed = msgspec.json.decode(stream.read(_MOST_BYTES), type=_Manifest)
    except (OSError, ValueError, RecursionError):
        return {}
    names = [name for name, *_ in listed.files.values()]
    fits = all(map(_PART.fullmatch, listed.files)) and all(map(_is_name, names))
    return listed.files if fits and is_own(status) and listed.inode == status.st_ino else {}


class _Manifest(msgspec.Struct, forbid_unknown_fields=True):
    inode: int
    files: dict[str, tuple[str, int, int]]


def _is_name(name: str) -> bool:
    """Whether a name from a manifest is that of a file in the folder itself."""
    return bool(name) and name not in (".", "..") and "/" not in name and "\0" not in name
