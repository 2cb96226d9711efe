"""Ray judges as one process does: the units of a run, and a data set that is grouped by drives."""

import logging

import pyarrow
import pytest
from pyarrow import parquet

from rulec.batch.jobs import Jobs
from rulec.extraction.selection import RequestedDrives
from rulec.fleet import FleetJudge
from rulec.fleet.runs.fleet_run import FleetSettings, run_fleet
from rulec.recordings.recording_format import RecordingSource
from support.builders.fleet_inputs import fleet_file, lanes, trace_table, tracks


def in_order(table):
    return sorted(map(repr, table))


@pytest.fixture(scope="module")
def ray():
    """A little of Ray, which takes seconds to start: an actor, and tasks that read and write."""
    ray = pytest.importorskip("ray", reason="no release for this Python")
    pytest.importorskip("ray.data")
    # Workers are started when there is work for them, not as many as there may be before any.
    monkeypatch = pytest.MonkeyPatch()
    monkeypatch.setenv("RAY_prestart_worker_first_driver", "0")
    ray.init(num_cpus=3, include_dashboard=False, log_to_driver=False, logging_level=logging.ERROR)
    logging.getLogger("ray.data").setLevel(logging.ERROR)
    ray.data.DataContext.get_current().enable_progress_bars = False
    yield ray
    ray.shutdown()
    monkeypatch.undo()


@pytest.mark.filterwarnings("ignore")
def test_ray_finds_what_one_process_finds(ray, tmp_path):
    traces, compiled = trace_table(range(6)), fleet_file(tmp_path)
    half = len(traces) // 2
    (tmp_path / "in").mkdir()
    for number, part in enumerate((traces.slice(0, half), traces.slice(half))):
        parquet.write_table(part, tmp_path / "in" / f"{number}.parquet")
    expected = in_order(FleetJudge(compiled)(traces).to_pylist())
    usual = FleetSettings(RequestedDrives(), RecordingSource(tmp_path), engine="ray", jobs=Jobs(1))
    done = run_fleet([str(tmp_path / "in")], compiled, tmp_path / "out", usual)
    assert (done.units, done.tally.judged) == (2, 6)
    found = parquet.read_table(done.findings, partitioning=None)
    assert in_order(found.to_pylist()) == expected


@pytest.mark.filterwarnings("ignore")
@pytest.mark.parametrize(
    "grouped", [False, pytest.param(True, marks=pytest.mark.long)], ids=["whole", "grouped"]
)
def test_the_recipe_finds_the_same(grouped, ray, tmp_path):
    """A class, its arguments and actors, as docs/fleet.md has it; a shuffle takes a minute."""
    table, compiled = pyarrow.table(tracks([0, 1])), str(fleet_file(tmp_path))
    roads = str(lanes(tmp_path))
    expected = in_order(FleetJudge(compiled, roads)(table).to_pylist())
    half = len(table) // 2 if grouped else len(tracks([0])["t"])
    (tmp_path / "in").mkdir()
    for number, part in enumerate((table.slice(0, half), table.slice(half))):
        parquet.write_table(part, tmp_path / "in" / f"{number}.parquet")
    drives = ray.data.read_parquet(str(tmp_path / "in"), include_paths=False)
    shared = {
        "fn_constructor_args": (compiled, roads),
        "batch_format": "pyarrow",
        "compute": ray.data.ActorPoolStrategy(size=1),
    }
    if grouped:
        more = {"fn_constructor_kwargs": {"grouped": True}}
        found = drives.groupby("recording").map_groups(FleetJudge, **shared, **more)
    else:
        found = drives.map_batches(FleetJudge, batch_size=None, **shared)
    found.write_parquet(str(tmp_path / "found"))
    assert in_order(parquet.read_table(tmp_path / "found").to_pylist()) == expected
