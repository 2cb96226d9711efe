"""What is read of a file, the order of its parts included, is the same in every process.

Python orders sets of texts anew in each process, unless a seed is given.
"""

import os
import subprocess
import sys
from pathlib import Path

import pytest

from support.builders.recorded_data import DATA

SAMPLES = Path(__file__).parents[2] / "docs" / "samples"
MAPS = (".xodr", ".osm", ".net.xml")
KINDS = (".xml", ".pb", ".osi", ".mcap", ".pkl", ".parquet", ".tfrecord", ".gz", *MAPS)
SHARED = [file for file in sorted(DATA.rglob("*")) if file.name.endswith(KINDS)]

# Sets are sorted, since nobody asks for their order; of all else the order counts.
PROGRAM = """
import hashlib, sys
from dataclasses import fields, is_dataclass
from pathlib import Path
import numpy as np
import rulec

def shown(value):
    if isinstance(value, frozenset | set):
        return "{%s}" % ",".join(sorted(map(shown, value)))
    if hasattr(value, "items"):
        return "[%s]" % ",".join(f"{shown(k)}:{shown(v)}" for k, v in value.items())
    if isinstance(value, list | tuple):
        return "(%s)" % ",".join(map(shown, value))
    if isinstance(value, np.ndarray):
        return f"{value.shape}{value.tobytes().hex()}"
    if is_dataclass(value):
        return type(value).__name__ + shown([getattr(value, own.name) for own in fields(value)])
    return str(value)

path = Path(sys.argv[1])
try:
    is_map = path.name.endswith((".xodr", ".osm", ".net.xml"))
    read = rulec.read_map(path, step_s=0.1) if is_map else rulec.read_recording(path)
except rulec.RulecError as problem:
    read = str(problem)
print(hashlib.sha256(shown(read).encode()).hexdigest(), isinstance(read, str))
"""


def read_with(seed, path):
    call = [sys.executable, "-c", PROGRAM, str(path)]
    environment = {**os.environ, "PYTHONHASHSEED": seed}
    return subprocess.run(call, env=environment, capture_output=True, check=True).stdout


@pytest.mark.parametrize(
    "path",
    [
        SAMPLES / "following.xml",
        SAMPLES / "passing.net.xml",
        *[pytest.param(file, id=file.name, marks=pytest.mark.long) for file in SHARED],
    ],
)
def test_a_file_is_read_alike_whatever_order_sets_have(path):
    first = read_with("1", path)
    assert path in SHARED or b"False" in first, "it can be read"
    assert {read_with(seed, path) for seed in "23"} == {first}
