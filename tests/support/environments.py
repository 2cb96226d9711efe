"""Environments of their own for programs that the tests compare with, in `.venv.NAME`."""

import subprocess
import sys
import tempfile
from pathlib import Path

_ROOT = Path(__file__).resolve().parents[2]


def environment(name, *requirements, python=sys.executable):
    """The folder of an environment with some packages; the first call installs them."""
    here = _ROOT / f".venv.{name}"
    if not here.exists():
        # Under another name until it is whole: several processes may ask at once
        folder = Path(tempfile.mkdtemp(prefix=f".venv.{name}-", dir=_ROOT))
        subprocess.run([python, "-m", "venv", folder], check=True)
        install = [folder / "bin/python", "-m", "pip", "install", "--quiet", *requirements]
        subprocess.run(install, check=True)
        if not here.exists():
            folder.rename(here)
    return here
