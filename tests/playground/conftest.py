"""The playground, built from this checkout and served."""

import os
import shutil
import subprocess
import sys

import pytest

from tools.browser.served import served
from tools.programs import ROOT


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
    with served(site) as url:
        yield url
