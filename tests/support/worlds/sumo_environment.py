"""SUMO's programs: those that RULEC_SUMO names, or an environment of their own in `.venv.sumo`."""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

RELEASE = "1.28.0"
_ROOT = Path(__file__).resolve().parents[3]
_HERE = _ROOT / ".venv.sumo"


def sumo_programs():
    """The folder of `sumo`, `netgenerate` and `netconvert`; the first call takes 600 MB."""
    named = os.environ.get("RULEC_SUMO")
    if named:
        return Path(named)
    if not _HERE.exists():
        _make()
    return next(_HERE.glob("lib/python*/site-packages/sumo/bin"))


def _make():
    # Under another name until it is whole: several processes may ask at once
    folder = Path(tempfile.mkdtemp(prefix=".venv.sumo-", dir=_ROOT))
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    install = [folder / "bin/python", "-m", "pip", "install", "--quiet", f"eclipse-sumo=={RELEASE}"]
    subprocess.run(install, check=True)
    if not _HERE.exists():
        folder.rename(_HERE)
