"""Files that appear whole or not at all."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from rulec.diagnostics import Diagnostic, RulecError


@contextmanager
def written_whole(path: Path) -> Iterator[IO[bytes]]:
    """A stream whose bytes become the file ``path`` when the block ends well, and vanish otherwise.

    Raises:
        RulecError: R0702 if the file cannot be written.
    """
    try:
        if path.exists() and not path.is_file():
            # A pipe or a device such as /dev/null: there is nothing to replace.
            with path.open("wb") as stream:
                yield stream
            return
        with _beside(path) as stream:
            yield stream
    except OSError as problem:
        raise RulecError(_unwritable(path, problem)) from None


@contextmanager
def _beside(path: Path) -> Iterator[IO[bytes]]:
    path = path.resolve()
    handle, name = tempfile.mkstemp(prefix=f".{path.name}.", suffix=".part", dir=path.parent)
    try:
        with os.fdopen(handle, "wb") as stream:
            yield stream
        # mkstemp keeps its files private; an ordinary new file is as the umask says.
        mask = os.umask(0)
        os.umask(mask)
        Path(name).chmod(0o666 & ~mask)
        Path(name).replace(path)
    except BaseException:
        Path(name).unlink(missing_ok=True)
        raise


def make_folder(path: Path) -> None:
    """Make a folder and those above it. Raises RulecError R0702."""
    try:
        path.mkdir(parents=True, exist_ok=True)
    except OSError as problem:
        raise RulecError(_unwritable(path, problem)) from None


@contextmanager
def opened(path: Path) -> Iterator[IO[bytes]]:
    """A file opened for reading. Raises RulecError R0701."""
    try:
        stream = path.open("rb")
        stream.peek(1)
    except OSError as problem:
        reason = problem.strerror or str(problem)
        raise RulecError(Diagnostic("R0701", f"cannot read {path}: {reason.lower()}")) from None
    with stream:
        yield stream


def _unwritable(path: Path, problem: OSError) -> Diagnostic:
    reason = (problem.strerror or str(problem)).lower()
    return Diagnostic("R0702", f"cannot write {path}: {reason}")
