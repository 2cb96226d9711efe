"""Whatever mistakes are in Argoverse 2's files: they are read, or refused."""

import json
import random

import pyarrow
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pyarrow import feather, parquet

from rulec import read_recording
from rulec.diagnostics import RulecError
from support.builders.argoverse_files import (
    LOG_ID,
    SCENARIO_ID,
    box,
    pose,
    rows_of,
    town,
    write_log,
    write_motion,
)
from support.generators.mutated_files import mutated

MOTION_ROWS = [
    *rows_of("AV", "vehicle", {step: (10 + step, -1.75) for step in range(9)}),
    *rows_of("7", "pedestrian", {step: (40, step) for step in range(3, 7)}),
]
POSES = [pose(10**9 + 10**8 * k, 20.0 + k, -1.75) for k in range(5)]
BOXES = [
    box(x["timestamp_ns"], name, category, 9.0, y)
    for x in POSES
    for name, category, y in (("a", "REGULAR_VEHICLE", 0.0), ("b", "BICYCLIST", 2.0))
]


@pytest.fixture(scope="module")
def files(tmp_path_factory):
    """Names and contents of a small scenario and a small log, and of the same tables in others."""
    folder = tmp_path_factory.mktemp("whole")
    motion = write_motion(folder, MOTION_ROWS)
    log = write_log(folder, BOXES, POSES)
    found = {
        "scenario": motion.read_bytes(),
        "annotations": log.read_bytes(),
        "poses": (folder / "city_SE3_egovehicle.feather").read_bytes(),
        "map": json.dumps(town()).encode(),
    }
    plain = folder / "plain"
    feather.write_feather(pyarrow.Table.from_pylist(BOXES), plain, compression="uncompressed")
    found["plain annotations"] = plain.read_bytes()
    parquet.write_table(pyarrow.Table.from_pylist(MOTION_ROWS), plain, compression="none")
    found["plain scenario"] = plain.read_bytes()
    return found


def with_bytes_changed(data, pick):
    """A few bytes of it others, a part of it away, or doubled."""
    content = bytearray(data)
    for _ in range(pick.choice((1, 1, 2, 5, 20))):
        at = pick.randrange(len(content))
        content[at] = pick.choice((0, 1, 0x7F, 0x80, 0xFF, pick.randrange(256)))
    if pick.random() < 0.2:
        start = pick.randrange(len(content))
        end = min(len(content), start + pick.randrange(1, 99))
        content[start:end] = pick.choice((b"", bytes(content[start:end]) * 2))
    return bytes(content)


@given(seed=st.integers(0, 2**32))
def test_a_mistake_is_read_or_refused(tmp_path_factory, files, seed):
    pick = random.Random(seed)
    folder = tmp_path_factory.mktemp("mutated")
    (folder / "map").mkdir()
    which = pick.choice(list(files))
    content = {name: files[name] for name in files if not name.startswith("plain") or name == which}
    change = mutated_text if which == "map" and pick.random() < 0.7 else with_bytes_changed
    content[which.removeprefix("plain ")] = change(files[which], pick)
    (folder / f"scenario_{SCENARIO_ID}.parquet").write_bytes(content["scenario"])
    (folder / "annotations.feather").write_bytes(content["annotations"])
    (folder / "city_SE3_egovehicle.feather").write_bytes(content["poses"])
    (folder / "map" / f"log_map_archive_{LOG_ID}.json").write_bytes(content["map"])
    assert_read_or_refused(folder / f"scenario_{SCENARIO_ID}.parquet")
    assert_read_or_refused(folder / "annotations.feather")


def assert_read_or_refused(path):
    try:
        recording = read_recording(path)
        assert recording.participants
        assert recording.step_s > 0
    except RulecError as refused:
        (found,) = refused.diagnostics
        assert found.code == "R0610"
        assert found.place.file.startswith(str(path.parent))
        assert "\n" not in found.message
        assert len(found.message) < 400


def mutated_text(data, pick):
    return mutated(data.decode(), pick)
