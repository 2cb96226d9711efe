"""The version stands in one file, and everything else reads it there."""

import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import rulec

ROOT = Path(__file__).resolve().parents[2]


def test_the_package_is_of_this_version():
    assert version("rulec") == rulec.__version__


def test_the_command_says_this_version():
    done = subprocess.run(
        [sys.executable, "-m", "rulec", "--version"], capture_output=True, text=True, check=True
    )
    assert rulec.__version__ in done.stdout.split()


def test_no_other_file_of_the_project_has_a_version_of_its_own():
    pyproject = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    assert 'dynamic = ["version"]' in pyproject
    assert not re.search(r"^version = ", pyproject, re.MULTILINE)
