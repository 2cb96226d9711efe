"""A real environment, from the package index: slow, so only in the long run of the tests."""

import os
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = ["grammar", "rulebooks", "src", "docs", "tests"]
FILES = ["rulec", "pyproject.toml", "README.md", "LICENSE"]
SHOW_DATA = """
from rulec import resources
folders = resources.rulebooks_folder(), resources.scenarios_folder()
for file in (resources.grammar_file("rulec.lark"), *(f for d in folders for f in d.rglob("*"))):
    if file.is_file():
        print(file.name)
"""

pytestmark = pytest.mark.skipif(
    os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds environments: --long"
)


@pytest.fixture
def clone(tmp_path):
    """A fresh copy of the checkout, as git would make it."""
    home = tmp_path / "a clone"
    home.mkdir()
    ignored = shutil.ignore_patterns("__pycache__", "*.egg-info")
    for folder in FOLDERS:
        shutil.copytree(ROOT / folder, home / folder, ignore=ignored)
    for file in FILES:
        shutil.copy(ROOT / file, home / file)
    return home


def run(*command, **options):
    return subprocess.run(
        [str(part) for part in command],
        capture_output=True,
        text=True,
        check=True,
        timeout=600,
        **options,
    ).stdout


def data_files(folder):
    return {file.name for file in folder.rglob("*") if file.is_file()} - {"__pycache__"}


def shipped(home):
    builtin = home / "src/rulec/scenario/builtin"
    return {"rulec.lark"} | data_files(home / "rulebooks") | data_files(builtin)


def test_fresh_clone_runs(clone):
    variables = os.environ | {"RULEC_PYTHON": sys.executable}
    first = run(clone / "rulec", "--version", env=variables, cwd="/")
    assert first.startswith("rulec ")
    assert run(clone / "rulec", "--version", cwd="/") == first
    assert run(clone / ".venv/bin/python", "-m", "rulec", "--version") == first
    assert set(run(clone / ".venv/bin/python", "-c", SHOW_DATA).split()) == shipped(clone)


@pytest.mark.parametrize("way", ["folder", "source distribution"])
def test_installed_package_brings_its_data(clone, tmp_path, way):
    run(sys.executable, "-m", "venv", tmp_path / "v")
    python = tmp_path / "v/bin/python"
    source = clone
    if way == "source distribution":
        run(python, "-m", "pip", "install", "--quiet", "build")
        run(python, "-m", "build", "--sdist", "--outdir", tmp_path, clone)
        (source,) = tmp_path.glob("rulec-*.tar.gz")
    run(python, "-m", "pip", "install", "--quiet", source)
    wanted = shipped(clone)
    shutil.rmtree(clone)
    assert set(run(python, "-c", SHOW_DATA, cwd="/").split()) == wanted
    assert run(tmp_path / "v/bin/rulec", "--version", cwd="/").startswith("rulec ")
