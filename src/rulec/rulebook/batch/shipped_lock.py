"""``rulec.lock``: the hashes of shipped files that a project builds upon."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from hashlib import sha256
from pathlib import Path

from rulec.diagnostics import Diagnostic, RulecError, SourceLocation
from rulec.files.read_files import MAX_SETTINGS_BYTES, decoded, opened, read_whole
from rulec.files.work_trees import refuse_link_out
from rulec.files.written_files import written_whole
from rulec.resources import rulebooks_folder
from rulec.rulebook.batch.batch_check import is_vocabulary
from rulec.rulebook.files.search_path import read_bytes
from rulec.rulebook.rulebook_messages import NOT_AS_LOCKED, WRONG_LOCK
from rulec.settings import settings_file
from rulec.toml import parsed_toml

FILE_NAME = "rulec.lock"

_HEAD = "# What ships with rulec and is built upon here. `rulec check --lock` writes it anew.\n"
_HOW = "`rulec check --lock` writes it anew"


def lock_file() -> Path:
    """The lock beside the nearest ``rulec.toml``, or in the working folder."""
    settings = settings_file()
    return Path(FILE_NAME) if settings is None else settings.parent / FILE_NAME


def write_lock(files: Iterable[str], search_path: Sequence[Path], at: str) -> tuple[Path, int]:
    """Lock what rulebooks and vocabularies build upon; returns the path, and the number of files.

    Raises RulecError: R0702, and for mistakes in the files.
    """
    from rulec.rulebook.reading.rulebook_reader import read_rulebook  # 50 ms, not for each check

    shipped = rulebooks_folder().resolve()
    hashes: dict[str, str] = {}
    for file in files:
        read = [file]
        if not is_vocabulary(Path(file)):
            read = [*read_rulebook(file if "/" in file else f"./{file}", search_path, at).sources]
        for path in map(Path, read):
            with suppress(ValueError):  # what does not ship is the project's own
                name = path.resolve().relative_to(shipped).as_posix()
                hashes[name] = sha256(read_bytes(path)).hexdigest()
    path = lock_file()
    lines = [f'"{name}" = "{hashes[name]}"\n' for name in sorted(hashes)]
    with written_whole(path) as stream:
        stream.write("".join([_HEAD, *lines]).encode())
    return path, len(hashes)


def not_as_locked() -> tuple[Diagnostic, ...]:
    """The differences from the lock, if there is one. Raises RulecError R0101, R0701, R0726."""
    path = lock_file()
    if not path.exists():
        return ()
    shipped = rulebooks_folder()
    return tuple(
        NOT_AS_LOCKED.at(
            SourceLocation(str(path)),
            f"`{name}` {'is not what' if digest else 'does not ship any more as it'} was locked",
            help="see what has changed (`rulec diff`, the changelog), then `rulec check --lock`",
        )
        for name, locked in _locked(path).items()
        if (digest := _digest(shipped / name)) != locked
    )


def _locked(path: Path) -> Mapping[str, str]:
    refuse_link_out(path)
    with opened(path) as stream:
        source = decoded(str(path), read_whole(stream, path, MAX_SETTINGS_BYTES))
    locked = parsed_toml(source, WRONG_LOCK, _HOW)
    for name, value in locked.items():
        parts = Path(name).parts
        if not isinstance(value, str) or ".." in parts or Path(name).is_absolute():
            message = f"`{name}` is no file that ships with rulec, with the hash of its content"
            raise WRONG_LOCK.error(SourceLocation(str(path)), message, help=_HOW)
    return locked


def _digest(path: Path) -> str:
    """The hash of a file; empty if there is none."""
    with suppress(RulecError):
        return sha256(read_bytes(path)).hexdigest()
    return ""
