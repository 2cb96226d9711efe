"""The editors' files, and programs that may be missing."""

import shutil
import subprocess
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="session")
def editors():
    """The folder ``src/editors``."""
    return ROOT / "src" / "editors"


@pytest.fixture
def program():
    """Find a program; a test whose program is missing is skipped, and says which one it was."""

    def found(name, instead=""):
        path = shutil.which(name)
        if path is None:
            pytest.skip(f"{name} is not installed{instead}")
        return path

    return found


@pytest.fixture
def done():
    """Run a command, which has to succeed, and return what it prints."""

    def run(*command, timeout=540, **options):
        ended = subprocess.run(
            [str(part) for part in command],
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            stdin=subprocess.DEVNULL,
            text=True,
            timeout=timeout,
            check=False,
            **options,
        )
        assert ended.returncode == 0, ended.stdout
        return ended.stdout

    return run
