"""Ray judges as one process does: the units of a run, and a data set that is grouped by drives."""

import logging
import os

import pytest
from pyarrow import parquet

from rulec.batch.jobs import Jobs
from rulec.extraction.selection import RequestedDrives
from rulec.fleet import FleetJudge
from rulec.fleet.runs.fleet_run import FleetSettings, run_fleet
from rulec.recordings.recording_format import RecordingSource
from support.builders.fleet_inputs import fleet_file, trace_table


def in_order(table):
    return sorted(map(repr, table))


@pytest.fixture(scope="module")
def ray():
    """One processor's worth of Ray, which takes seconds to start."""
    ray = pytest.importorskip("ray", reason="no release for this Python")
    pytest.importorskip("ray.data")
    ray.init(num_cpus=1, include_dashboard=False, log_to_driver=False, logging_level=logging.ERROR)
    logging.getLogger("ray.data").setLevel(logging.ERROR)
    ray.data.DataContext.get_current().enable_progress_bars = False
    yield ray
    ray.shutdown()


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
    if os.environ.get("RULEC_TEST_PROFILE") != "long":
        return  # to shuffle a data set takes half a minute
    drives = ray.data.from_arrow([traces.slice(0, half), traces.slice(half)])
    judged = drives.groupby("trace").map_groups(
        FleetJudge(compiled, grouped=True), batch_format="pyarrow"
    )
    assert in_order(judged.take_all()) == expected
