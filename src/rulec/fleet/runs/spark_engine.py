"""Judge units of work with Spark, on the current session or on this machine."""

from __future__ import annotations

import os
import pickle
import shutil
import sys
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

from rulec.batch.jobs import Jobs
from rulec.fleet.fleet_messages import engine_missing, java_missing
from rulec.fleet.runs.fleet_engine import Engine
from rulec.fleet.runs.fleet_tally import FleetTally
from rulec.fleet.runs.unit_work import UnitWorker
from rulec.fleet.runs.work_units import WorkUnit
from rulec.trace.formats.arrow.parquet import arrow


def spark_engine() -> Engine:
    """Spark as an engine. Raises RulecError R0713 without it, or without Java."""
    try:
        from pyspark.sql import SparkSession  # an extra, and seconds
    except ImportError:
        raise engine_missing("spark", "pyspark") from None
    running = SparkSession.getActiveSession()
    home = os.environ.get("JAVA_HOME")
    if running is None and shutil.which(f"{home}/bin/java" if home else "java") is None:
        raise java_missing(home)
    return partial(_judged_by, SparkSession, running)


def _judged_by(
    sessions: Any, running: Any, worker: UnitWorker, units: Sequence[WorkUnit], jobs: Jobs
) -> Iterator[FleetTally]:
    """The tally of each unit, in any order."""
    pyarrow, _ = arrow("the table of units")
    # Workers run the same Python as this process, not the first one on the path.
    os.environ.setdefault("PYSPARK_PYTHON", sys.executable)
    builder = sessions.builder.appName("rulec fleet").master(f"local[{jobs.processes}]")
    spark = running or builder.config("spark.ui.enabled", "false").getOrCreate()
    sent = pickle.dumps(worker)

    def judged(table: Any) -> Any:
        own = pickle.loads(sent)
        work_units = (pickle.loads(unit) for unit in table.column("unit").to_pylist())
        return pyarrow.table({"tally": [pickle.dumps(own.judged(unit)) for unit in work_units]})

    try:
        rows = [(number, pickle.dumps(unit)) for number, unit in enumerate(units)]
        frame = spark.createDataFrame(rows, "number long, unit binary")
        done = frame.repartition(max(1, len(rows)), "number").groupBy("number")
        for row in done.applyInArrow(judged, "tally binary").toLocalIterator():
            yield pickle.loads(bytes(row["tally"]))
    finally:
        if running is None:
            spark.stop()
