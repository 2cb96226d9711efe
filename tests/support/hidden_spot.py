"""Spot hidden from the tests, as if it was not installed: with RULEC_TESTS_WITHOUT_SPOT=1."""

import os
import sys
from importlib.util import find_spec
from pathlib import Path

VARIABLE = "RULEC_TESTS_WITHOUT_SPOT"


def hide(folder: Path) -> None:
    """Put modules that cannot be loaded before Spot's, for processes that are started, too."""
    folder.mkdir(exist_ok=True)
    for name in ("spot", "buddy"):
        text = 'raise ModuleNotFoundError("Spot is hidden from the tests")\n'
        (folder / f"{name}.py").write_text(text)
    sys.path.insert(0, str(folder))
    others = os.environ.get("PYTHONPATH")
    os.environ["PYTHONPATH"] = os.pathsep.join([str(folder), *([others] if others else [])])


def is_there() -> bool:
    """Tell whether the tests have Spot."""
    return VARIABLE not in os.environ and find_spec("spot") is not None
