"""Programs that do not ship with Python: how they are run, and installed in the checkout."""

from __future__ import annotations

import shutil
import subprocess
import sys
import sysconfig
import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]


class MissingPartError(Exception):
    """A part of what is built is not available."""


def run(command: Sequence[str | Path], folder: Path) -> str:
    """Run a program in a folder, and return its output.

    Raises MissingPartError with that output if the program fails.
    """
    done = subprocess.run(
        command, cwd=folder, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, check=False
    )
    said = done.stdout.decode(errors="replace").strip()
    if done.returncode != 0:
        raise MissingPartError(f"{Path(command[0]).name} ended with {done.returncode}:\n{said}")
    return said


def npm() -> str:
    """The path of npm. Raises MissingPartError without it."""
    found = shutil.which("npm")
    if found is None:
        raise MissingPartError("npm is not found: install Node.js")
    return found


def put_packages(locked: Path, work: Path, *options: str) -> None:
    """Install what a folder's ``package-lock.json`` lists into ``node_modules`` of another one.

    No script of any package runs. Raises MissingPartError.
    """
    program = npm()
    for name in ("package.json", "package-lock.json"):
        shutil.copy(locked / name, work)
    quiet = ("--ignore-scripts", "--no-audit", "--no-fund", "--silent")
    run([program, "ci", *quiet, *options], work)


def made_once(name: str, make: Callable[[Path], object]) -> Path:
    """The folder ``.venv.NAME`` of the checkout, whose content the first call makes."""
    here = ROOT / f".venv.{name}"
    if not here.exists():
        # Under another name until it is whole: several processes may ask at once
        folder = Path(tempfile.mkdtemp(prefix=f".venv.{name}-", dir=ROOT))
        make(folder)
        if not here.exists():
            folder.rename(here)
    return here


def environment(name: str, *requirements: str, python: str = sys.executable) -> Path:
    """The folder ``.venv.NAME``: an environment with some packages, made by the first call.

    Its scripts do not run, as they name another folder: ``python -m`` does. Raises
    MissingPartError.
    """

    def make(folder: Path) -> None:
        run([python, "-m", "venv", folder], ROOT)
        run([folder / "bin/python", "-m", "pip", "install", "--quiet", *requirements], ROOT)

    return made_once(name, make)


def library(home: Path) -> str:
    """The folder of an environment's packages, for the path of this Python."""
    return sysconfig.get_path("purelib", vars={"base": str(home), "platbase": str(home)})
