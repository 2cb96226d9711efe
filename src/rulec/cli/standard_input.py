"""Standard input where a file is read more than once, or from its middle."""

from __future__ import annotations

import sys
from pathlib import Path

import click

STANDARD_INPUT = "-"


def file_named(argument: str) -> str:
    """The path that an argument is; for ``-`` that of a copy, kept as long as the command runs."""
    if argument != STANDARD_INPUT:
        return argument
    # Archives and random names, 4 ms: not for files.
    import shutil
    from tempfile import TemporaryDirectory

    folder = click.get_current_context().with_resource(TemporaryDirectory(prefix="rulec-"))
    copy = Path(folder, "standard input")
    with copy.open("wb") as stream:
        shutil.copyfileobj(sys.stdin.buffer, stream)
    return str(copy)
