"""The version stands in one file, and everything else reads it there."""

import re
import subprocess
import sys
from importlib.metadata import version
from pathlib import Path

import yaml

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


def test_the_citation_names_this_version():
    page = (ROOT / "docs" / "citation.md").read_text(encoding="utf-8")
    citation = yaml.safe_load(page.split("```yaml\n")[1].split("```")[0])
    assert citation["version"] == rulec.__version__
    assert f"version = {{{rulec.__version__}}}" in page


def test_the_changelog_begins_with_what_is_not_released_or_with_this_version():
    page = (ROOT / "docs" / "changelog.md").read_text(encoding="utf-8")
    first = re.search(r"^## \[(.+?)\]", page, re.MULTILINE)
    assert first is not None
    assert first[1] in ("Unreleased", rulec.__version__)
