"""A headless Chromium of the project's own, which Playwright drives.

It comes from npm, in the release of ``package-lock.json``, with the libraries and a font that a
system without a desktop lacks; so neither an installed browser nor an administrator is needed. It
runs on Linux for x86-64.
"""

from __future__ import annotations

import os
import sys
import tarfile
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from hashlib import sha256
from pathlib import Path
from typing import Any

from tools.programs import MissingPartError, environment, library, made_once, put_packages, run

HERE = Path(__file__).resolve().parent

PATIENCE_MS = 180_000
"""How long a page may take until it shows what is expected of it."""

_QUIET = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
"""Without them Chromium, as root, does not start, or calls hosts of its maker's."""

_UNPACK = """
const [packed, file] = process.argv.slice(1);
const { readFileSync, writeFileSync } = require("fs");
writeFileSync(file, require("zlib").brotliDecompressSync(readFileSync(packed)));
"""

_FONTS = """<?xml version="1.0"?>
<!DOCTYPE fontconfig SYSTEM "fonts.dtd">
<fontconfig><dir>/usr/share/fonts</dir><dir prefix="relative">fonts</dir></fontconfig>
"""


@contextmanager
def chromium() -> Iterator[Any]:
    """Start the browser, a ``Browser`` of Playwright's. Raises MissingPartError."""
    home = _installed()
    packages = library(environment("playwright", "playwright>=1.50,<2"))
    sys.path.append(packages)
    # From the environment that has just been made.
    from playwright.sync_api import Error, expect, sync_playwright

    expect.set_options(timeout=PATIENCE_MS)
    variables = {
        **os.environ,
        "LD_LIBRARY_PATH": str(home / "lib"),
        "FONTCONFIG_FILE": str(home / "fonts.conf"),
    }
    try:
        with sync_playwright() as playwright:
            try:
                started = playwright.chromium.launch(
                    executable_path=home / "chromium", args=list(_QUIET), env=variables
                )
            except Error as error:
                reason = str(error).strip().partition("\n")[0]
                raise MissingPartError(f"Chromium does not start: {reason}") from error
            yield started
            started.close()
    finally:
        sys.path.remove(packages)


def accessibility_rules() -> str:
    """The script of Deque's axe, which looks for what is not accessible in a page."""
    return (_installed() / "axe.min.js").read_text("utf-8")


def _installed() -> Path:
    lock = sha256((HERE / "package-lock.json").read_bytes()).hexdigest()
    return made_once(f"browser-{lock[:8]}", _install)


def _install(folder: Path) -> None:
    with tempfile.TemporaryDirectory() as work:
        put_packages(HERE, Path(work))
        packages = Path(work, "node_modules")
        (packages / "axe-core/axe.min.js").rename(folder / "axe.min.js")
        packed = packages / "@sparticuz/chromium/bin"
        for name in ("chromium", "al2023.tar", "fonts.tar"):
            run(["node", "-e", _UNPACK, packed / f"{name}.br", folder / name], folder)
    for name in ("al2023.tar", "fonts.tar"):
        with tarfile.open(folder / name) as archive:
            archive.extractall(folder, filter="data")
        (folder / name).unlink()
    (folder / "chromium").chmod(0o755)
    (folder / "fonts.conf").write_text(_FONTS, "utf-8")
