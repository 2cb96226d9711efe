"""The work tree that contains a file: links out of it, pipes and devices are refused.

The author of a checkout chose its files, which need not be trusted: a link may lead to any file of
this machine, and a pipe may never end.
"""

from __future__ import annotations

import os
import stat
from pathlib import Path

from rulec.diagnostics import Label, SourceLocation
from rulec.files.file_messages import LINK_OUT, NO_ORDINARY_FILE, UNREADABLE_FILE, reason_in_words

_OF_THE_SYSTEM = ("/dev/", "/proc/self/fd/")
"""Folders whose links are the system's own, such as ``/dev/stdout``."""


def tree_of(folder: Path) -> Path:
    """The git work tree that contains a folder; the folder itself if there is none.

    Links in the folder's own name are kept, because the user gave them deliberately.
    """
    here = Path(os.path.abspath(folder))  # noqa: PTH100 - Path.absolute() keeps `..`
    return next((place for place in (here, *here.parents) if os.path.lexists(place / ".git")), here)


def leads_out(path: Path, tree: Path | None = None) -> bool:
    """Whether a path is behind a link out of a tree, by default the tree of the path itself."""
    root = os.path.realpath(tree or tree_of(path.parent))
    real = os.path.realpath(path)
    return real != root and not real.startswith(root.rstrip("/") + "/")


def refuse_link_out(path: Path, labels: tuple[Label, ...] = (), tree: Path | None = None) -> None:
    """Refuse a path behind a link out of its tree. Raises RulecError R0730, R0701."""
    try:
        if str(path).startswith(_OF_THE_SYSTEM) or not leads_out(path, tree):
            return
    except (OSError, ValueError) as problem:  # a null character, or a name that is too long
        message = f"the file cannot be read: {reason_in_words(problem)}"
        raise UNREADABLE_FILE.error(
            SourceLocation(str(path)), message, help="check its name", labels=labels
        ) from None
    raise LINK_OUT.error(
        SourceLocation(str(path)),
        "it is a link that leads out of its tree",
        help="if the file behind it is meant, give its own path",
        labels=labels,
    )


def is_ordinary(path: Path) -> bool:
    """Whether a path is a file, also behind a link, and not a pipe, socket, device or folder."""
    try:
        return stat.S_ISREG(path.stat().st_mode)
    except (OSError, ValueError):
        return False


def refuse_no_source(path: Path, labels: tuple[Label, ...] = (), tree: Path | None = None) -> None:
    """Refuse a path that cannot be a source of its tree.

    Missing files and folders are left to the code that opens them.

    Raises RulecError: R0730 for a link out of the tree, R0731 for pipes, sockets and devices.
    """
    refuse_link_out(path, labels, tree)
    refuse_no_file(path, labels)


def refuse_no_file(path: Path, labels: tuple[Label, ...] = ()) -> None:
    """Refuse pipes, sockets and devices. Raises RulecError R0731."""
    try:
        mode = path.stat().st_mode
    except (OSError, ValueError):
        return
    if not (stat.S_ISREG(mode) or stat.S_ISDIR(mode)):
        raise NO_ORDINARY_FILE.error(
            SourceLocation(str(path)),
            "it is a pipe, a socket or a device, not a regular file",
            help="leave it out, or give `-` to read standard input",
            labels=labels,
        )
