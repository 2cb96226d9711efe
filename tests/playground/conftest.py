"""The playground, built from this checkout and served to a Chromium of one's own."""

import os
import shutil
import subprocess
import sys
import sysconfig
import threading
from functools import partial
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path

import pytest

from support.environments import environment

ROOT = Path(__file__).resolve().parents[2]
NAMES = ("chromium", "chromium-browser", "google-chrome")
CHROMIUM = next(filter(None, map(shutil.which, NAMES)), None)
QUIET = (
    "--no-sandbox",
    "--disable-gpu",
    "--disable-background-networking",
    "--disable-component-update",
    "--disable-sync",
    "--no-first-run",
)
"""Without them Chromium, as root, does not start, or calls hosts of its maker's."""

PATIENCE_MS = 180_000


class QuietHandler(SimpleHTTPRequestHandler):
    def log_message(self, *_):
        pass


@pytest.fixture(scope="session")
def site(tmp_path_factory):
    """The page's folder, by its one command."""
    if shutil.which("npm") is None:
        pytest.skip("npm is not there, which Pyodide comes from")
    folder = tmp_path_factory.mktemp("playground") / "page"
    subprocess.run(
        [sys.executable, "-m", "tools.playground", "-o", folder],
        env={**os.environ, "PYTHONPATH": str(ROOT / "src")},
        check=True,
    )
    return folder


@pytest.fixture(scope="session")
def address(site):
    """Where the folder is served, as by ``python -m http.server``."""
    with ThreadingHTTPServer(("127.0.0.1", 0), partial(QuietHandler, directory=site)) as server:
        threading.Thread(target=server.serve_forever, daemon=True).start()
        yield f"http://127.0.0.1:{server.server_port}/"
        server.shutdown()


@pytest.fixture(scope="session")
def chromium():
    """A headless Chromium, driven by Playwright from an environment of its own."""
    if CHROMIUM is None:
        pytest.skip("Chromium is not there: apt-get install chromium")
    home = environment("playwright", "playwright>=1.50,<2")
    library = sysconfig.get_path("purelib", vars={"base": str(home), "platbase": str(home)})
    sys.path.append(library)
    # From the environment that has just been made.
    from playwright.sync_api import expect, sync_playwright

    expect.set_options(timeout=PATIENCE_MS)
    with sync_playwright() as playwright:
        started = playwright.chromium.launch(executable_path=CHROMIUM, args=list(QUIET))
        yield started
        started.close()
    sys.path.remove(library)
