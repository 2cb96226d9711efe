"""The wheel as a stranger installs it, away from the checkout and with nothing else beside it."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from pathlib import Path

from rulec.version import __version__
from tools.programs import ROOT, environment, run

SAMPLE = "following.xml"

PROGRAM = f"""
import rulec

found = rulec.verify("{SAMPLE}", "de")
print(found.worst.rule)
"""

VERSION = f"rulec {__version__}"
BROKEN = "following_distance [§ 4(1)]"


def faults_of_wheel(wheel: Path) -> Iterator[str]:
    """What goes wrong where the wheel is installed by pip, and run by uvx and pipx.

    Raises MissingPartError if it cannot be installed.
    """
    installers = environment("installers", "uv", "pipx") / "bin"
    with tempfile.TemporaryDirectory() as work:
        here = Path(work)
        shutil.copy(ROOT / "docs/samples" / SAMPLE, here)
        run([sys.executable, "-m", "venv", here / "empty"], here)
        run([here / "empty/bin/python", "-m", "pip", "install", "--quiet", wheel], here)
        rulec, python = here / "empty/bin/rulec", here / "empty/bin/python"
        uvx = (installers / "uvx", "--from", wheel, "rulec")
        pipx = (installers / "python", "-m", "pipx", "run", "--spec", wheel, "rulec")
        yield from _faults((rulec, "--version"), here, 0, VERSION)
        yield from _faults((rulec, "verify", SAMPLE, "-r", "de"), here, 1, BROKEN)
        yield from _faults((python, "-c", PROGRAM), here, 0, "following_distance")
        yield from _faults((*uvx, "--version"), here, 0, VERSION)
        yield from _faults((*pipx, "--version"), here, 0, VERSION)


def _faults(command: Sequence[str | Path], folder: Path, status: int, says: str) -> Iterator[str]:
    """Nothing if a command ends with this status and says so, among other things."""
    done = subprocess.run(
        command,
        cwd=folder,
        env=_variables(folder),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode != status or says not in done.stdout:
        said = f"{done.stdout}{done.stderr}".strip()
        shown = " ".join(map(str, command[:4]))
        yield f"{shown} ended with {done.returncode}, not {status} and {says!r}:\n{said}"


def _variables(folder: Path) -> dict[str, str]:
    """The environment's, without the checkout's; whatever is cached goes into a folder."""
    ours = ("PYTHON", "RULEC", "VIRTUAL_ENV")
    kept = {name: value for name, value in os.environ.items() if not name.startswith(ours)}
    return {**kept, "RULEC_CACHE_DIR": f"{folder}/cache", "PIPX_HOME": f"{folder}/pipx"}
