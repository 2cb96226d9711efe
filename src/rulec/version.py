"""The version, and the command that installs an extra into rulec's own environment."""

from __future__ import annotations

import sys
from contextlib import suppress
from functools import cache

__version__ = "0.1.0"


@cache
def install_command(extra: str) -> str:
    """A command such as ``pip install 'rulec[rates]'`` for this Python and rulec's origin.

    The origin is the checkout or file that rulec was installed from; otherwise its name is used.
    """
    # Imported late (20 ms): only needed if a package is missing.
    from importlib.metadata import PackageNotFoundError, distribution
    from importlib.util import find_spec
    from json import loads
    from shlex import quote
    from urllib.parse import unquote

    python = quote(sys.executable)
    # An environment made by uv has no pip.
    pip = f"{python} -m pip install" if find_spec("pip") else f"uv pip install --python {python}"
    with suppress(PackageNotFoundError, OSError, ValueError):
        origin = loads(distribution("rulec").read_text("direct_url.json") or "{}")
        if origin.get("url", "").startswith("file://"):
            path = unquote(origin["url"].removeprefix("file://"))
            editable = "-e " if origin.get("dir_info", {}).get("editable") else ""
            return f"{pip} {editable}{quote(f'{path}[{extra}]')}"
    return f"{pip} {quote(f'rulec[{extra}]')}"
