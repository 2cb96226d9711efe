"""SUMO's programs: those that RULEC_SUMO names, or an environment of their own in `.venv.sumo`."""

import os
from pathlib import Path

from tools.programs import environment

RELEASE = "1.28.0"


def sumo_programs():
    """The folder of `sumo`, `netgenerate` and `netconvert`; the first call takes 600 MB."""
    named = os.environ.get("RULEC_SUMO")
    if named:
        return Path(named)
    folder = environment("sumo", f"eclipse-sumo=={RELEASE}")
    return next(folder.glob("lib/python*/site-packages/sumo/bin"))
