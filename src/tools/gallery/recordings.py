"""Recordings of others: found in a folder or fetched, and known by their digests."""

from __future__ import annotations

import urllib.request
from hashlib import sha256
from pathlib import Path

from tools.gallery.drives import Recorded
from tools.programs import MissingPartError

PUBLIC = "https://raw.githubusercontent.com"
"""Where files of public repositories are read from."""


def put_recording(recorded: Recorded, work: Path, folder: Path | None) -> Path:
    """Put a recording into a folder for work; returns its path there.

    It is looked for in a folder at any depth, or fetched. Raises MissingPartError: it is not
    there, or is not the file that is meant.
    """
    if folder is None:
        data = _fetched(recorded)
    else:
        data = next((path.read_bytes() for path in sorted(folder.rglob(recorded.name))), b"")
        if not data:
            raise MissingPartError(f"{folder} has no {recorded.name}")
    if sha256(data).hexdigest() != recorded.sha256:
        raise MissingPartError(f"{recorded.name} is another file than that of {recorded.commit}")
    path = work / recorded.name
    path.write_bytes(data)
    return path


def _fetched(recorded: Recorded) -> bytes:
    address = f"{PUBLIC}/{recorded.repository}/{recorded.commit}/{recorded.path}"
    try:
        with urllib.request.urlopen(address, timeout=60) as answer:
            return bytes(answer.read())
    except OSError as error:
        raise MissingPartError(
            f"{address} cannot be read ({error}): --recordings names a folder with {recorded.name}"
        ) from error
