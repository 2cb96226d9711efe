"""Spark judges as one process does: the units of a run, and a frame that is grouped by drives.

Spark takes 500 MB and Java, hence only in the long run of the tests.
"""

import os
import shutil
import subprocess
from pathlib import Path

import pytest
from pyarrow import parquet

from rulec.fleet import FleetJudge
from support.builders.fleet_inputs import fleet_file, trace_table
from tools.programs import environment

pytestmark = [
    pytest.mark.skipif(
        os.environ.get("RULEC_TEST_PROFILE") != "long", reason="builds an environment: --long"
    ),
    pytest.mark.skipif(shutil.which("java") is None, reason="Spark takes Java 17"),
]
TOP = Path(__file__).resolve().parents[2]

PROGRAM = """
import sys
from pathlib import Path
from pyarrow import parquet
from pyspark.sql import SparkSession
from pyspark.sql.pandas.types import from_arrow_schema
from rulec.batch.jobs import Jobs
from rulec.extraction.selection import RequestedDrives
from rulec.fleet import FleetJudge, arrow_schema
from rulec.fleet.runs.fleet_run import FleetSettings, run_fleet
from rulec.recordings.recording_format import RecordingSource

folder, compiled = Path(sys.argv[1]), sys.argv[2]
usual = FleetSettings(RequestedDrives(), RecordingSource(folder), engine="spark", jobs=Jobs(2))
run_fleet([str(folder / "in")], compiled, folder / "out", usual)
spark = SparkSession.builder.master("local[2]").config("spark.ui.enabled", "false").getOrCreate()
judge = FleetJudge(compiled, grouped=True)
frame = spark.read.parquet(str(folder / "in")).groupBy("trace")
judged = frame.applyInArrow(lambda table: judge(table), from_arrow_schema(arrow_schema()))
parquet.write_table(judged.toArrow(), folder / "judged.parquet")
spark.stop()
"""


def in_order(table):
    return sorted(map(repr, table.to_pylist()))


def test_spark_finds_what_one_process_finds(tmp_path):
    traces, compiled = trace_table(range(12)), fleet_file(tmp_path)
    half = len(traces) // 2
    (tmp_path / "in").mkdir()
    for number, part in enumerate((traces.slice(0, half), traces.slice(half))):
        parquet.write_table(part, tmp_path / "in" / f"{number}.parquet")
    python = environment("spark", f"{TOP}[spark]") / "bin/python"
    own = {**os.environ, "PYSPARK_PYTHON": str(python)}
    subprocess.run([python, "-c", PROGRAM, tmp_path, compiled], check=True, env=own)
    expected = in_order(FleetJudge(compiled)(traces))
    assert in_order(parquet.read_table(tmp_path / "judged.parquet")) == expected
    (folder,) = (tmp_path / "out").glob("book=*")
    assert in_order(parquet.read_table(folder, partitioning=None)) == expected
