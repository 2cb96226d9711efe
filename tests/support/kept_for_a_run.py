"""What is dear to make and the same for each process of a run: the first one to ask makes it."""

import os
import pickle
from collections.abc import Callable
from pathlib import Path
from typing import TypeVar

FOLDER = "RULEC_TESTS_KEEP"
"""The variable with the folder of what the processes of a run keep, which their first one makes."""

Made = TypeVar("Made")


def kept_for_a_run(name: str, make: Callable[[], Made]) -> Made:
    """What ``make`` returns, or has returned in a process beside this one.

    It has a name of its own, can be pickled, and depends on nothing that a test changes.
    """
    file = Path(os.environ[FOLDER]) / name
    if file.exists():
        return pickle.loads(file.read_bytes())
    made = make()
    part = file.with_suffix(f".{os.getpid()}")
    part.write_bytes(pickle.dumps(made))
    part.replace(file)
    return made
