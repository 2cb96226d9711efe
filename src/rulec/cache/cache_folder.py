"""The folder of everything cached between calls, and who may write to it."""

from __future__ import annotations

import os
import stat
from functools import cache
from hashlib import sha256
from pathlib import Path

from rulec.files.written_files import OF_OTHERS, is_own, private
from rulec.resources import package_files
from rulec.version import __version__


def cache_folder() -> Path | None:
    """``RULEC_CACHE_DIR``, or ``rulec`` in the user's cache folder; None without either."""
    if own := os.environ.get("RULEC_CACHE_DIR"):
        return Path(own)
    shared = os.environ.get("XDG_CACHE_HOME", "")
    if Path(shared).is_absolute():
        return Path(shared, "rulec")
    try:
        return Path.home() / ".cache" / "rulec"
    except RuntimeError:
        return None


def usable_folder() -> Path | None:
    """The cache's folder, which may not exist yet; None if others can write to it.

    Whoever can write there decides what is read from it. The default folder is closed to others.
    """
    folder = cache_folder()
    if folder is None:
        return None
    try:
        status = folder.stat()
        if status.st_uid == os.geteuid() and not os.environ.get("RULEC_CACHE_DIR"):
            folder.chmod(stat.S_IMODE(status.st_mode) & ~OF_OTHERS)
            status = folder.stat()
    except FileNotFoundError:
        return folder
    except (OSError, ValueError):
        return None
    return folder if is_own(status) else None


def write_own(path: Path, data: bytes) -> None:
    """Write a file of the cache, whole and accessible to its owner only. Raises OSError.

    It is not flushed to the disk: readers detect a file that was cut when the machine stopped.
    """
    path.parent.mkdir(mode=0o700, parents=True, exist_ok=True)
    part = path.with_name(f".{path.name}.{os.urandom(8).hex()}.part")
    try:
        with open(part, "xb", opener=private) as stream:
            stream.write(data)
        part.replace(path)
    except BaseException:
        part.unlink(missing_ok=True)
        raise


@cache
def program_digest() -> str:
    """A digest of the version, and the times and sizes of rulec's own files, at the first call."""
    seen = sha256(__version__.encode())
    for path, status in package_files():
        seen.update(os.fsencode(f"{path}\0{status.st_mtime_ns}\0{status.st_size}\n"))
    return seen.hexdigest()


def program_stamp() -> str:
    """``program_digest``, with the compiler and the limits that this call asks for."""
    variables = (os.environ.get(name, "") for name in ("RULEC_COMPILER", "RULEC_LIMITS"))
    return "\0".join((program_digest(), *variables))


def tidy(folder: Path, ending: str, most: int) -> None:
    """Remove the least recently used half of the files with an ending, if they exceed ``most``.

    It is called after each write, so at first it looks only at file names.
    """
    kept = [name for name in os.listdir(folder) if name.endswith(ending)]  # noqa: PTH208
    if len(kept) > most:
        paths = [folder / name for name in kept if not name.startswith(".")]
        for path in sorted(paths, key=lambda file: file.stat().st_mtime)[: len(kept) // 2]:
            path.unlink(missing_ok=True)
