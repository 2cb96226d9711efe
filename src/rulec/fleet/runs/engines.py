"""Engines, which judge units of work: in processes of this machine, with Ray Data, or Spark."""

from __future__ import annotations

import logging
import os
import pickle
import shutil
import sys
from collections.abc import Callable, Iterator, Sequence
from functools import partial
from typing import Any, TypeAlias

from rulec.batch.jobs import Jobs, LostTask
from rulec.batch.worker_pool import in_order
from rulec.fleet.fleet_messages import engine_missing, java_missing
from rulec.fleet.runs.fleet_tally import FleetTally
from rulec.fleet.runs.unit_work import UnitWorker
from rulec.fleet.runs.work_units import WorkUnit
from rulec.trace.formats.arrow.parquet import arrow

Engine: TypeAlias = Callable[[UnitWorker, Sequence[WorkUnit], Jobs], Iterator[FleetTally]]
"""Gives the tally of each unit, in any order; a unit whose worker fails is judged again."""

_BLOCKS = 16
"""Number of Ray's tasks per process: fewer leave some processes idle, more add overhead."""


def local_engine() -> Engine:
    """The engine that needs no further package."""
    return judged_locally


def judged_locally(
    worker: UnitWorker, units: Sequence[WorkUnit], jobs: Jobs
) -> Iterator[FleetTally]:
    """The tally of each unit; a unit whose process is killed twice is only listed as lost."""
    for unit, result in in_order(_Work(worker), units, jobs):
        yield FleetTally(lost=[unit.path]) if isinstance(result, LostTask) else result


class _Work:
    """The work of a process on one unit."""

    def __init__(self, worker: UnitWorker) -> None:
        self._worker = worker

    def __call__(self, unit: WorkUnit) -> Iterator[FleetTally]:
        yield self._worker.judged(unit)


def _tallies(sent: bytes, units: Any) -> dict[str, list[bytes]]:
    """The tally of each unit in a table; the rulebook is read once in each process."""
    worker: UnitWorker = pickle.loads(sent)
    work_units = (pickle.loads(unit) for unit in units.column("unit").to_pylist())
    return {"tally": [pickle.dumps(worker.judged(unit)) for unit in work_units]}


def ray_engine() -> Engine:
    """Ray as an engine, on the current cluster or here. Raises RulecError R0713 without it."""
    try:
        import ray.data  # an extra, and seconds
    except ImportError:
        raise engine_missing("ray", "ray[data]") from None
    return partial(_judged_by_ray, ray)


def _judged_by_ray(
    ray: Any, worker: UnitWorker, units: Sequence[WorkUnit], jobs: Jobs
) -> Iterator[FleetTally]:
    """The tally of each unit, in the order in which they finish."""
    own = not ray.is_initialized()
    for name in ("ray", "ray.data"):
        # Ray's progress messages are of no interest to a user who wants findings.
        logging.getLogger(name).setLevel(logging.ERROR)
    if own:
        here = {} if os.environ.get("RAY_ADDRESS") else {"num_cpus": jobs.processes}
        ray.init(include_dashboard=False, log_to_driver=False, logging_level=logging.ERROR, **here)
    try:
        ray.data.DataContext.get_current().enable_progress_bars = False
        blocks = max(1, min(len(units), _BLOCKS * jobs.processes))
        rows = [{"unit": pickle.dumps(unit)} for unit in units]
        dataset = ray.data.from_items(rows, override_num_blocks=blocks)
        done = dataset.map_batches(
            partial(_tallies, pickle.dumps(worker)),
            batch_size=1,
            batch_format="pyarrow",
            compute=ray.data.TaskPoolStrategy(jobs.processes),
        )
        for row in done.iter_rows():
            yield pickle.loads(row["tally"])
    finally:
        if own:
            ray.shutdown()


def spark_engine() -> Engine:
    """Spark as an engine, on the current session or here.

    Raises RulecError R0713 without it, or without Java.
    """
    try:
        from pyspark.sql import SparkSession  # an extra, and seconds
    except ImportError:
        raise engine_missing("spark", "pyspark") from None
    running = SparkSession.getActiveSession()
    home = os.environ.get("JAVA_HOME")
    if running is None and shutil.which(f"{home}/bin/java" if home else "java") is None:
        raise java_missing(home)
    return partial(_judged_by_spark, SparkSession, running)


def _judged_by_spark(
    sessions: Any, running: Any, worker: UnitWorker, units: Sequence[WorkUnit], jobs: Jobs
) -> Iterator[FleetTally]:
    """The tally of each unit, in any order."""
    pyarrow, _ = arrow("the table of units")
    # Workers run the same Python as this process, not the first one on the path.
    os.environ.setdefault("PYSPARK_PYTHON", sys.executable)
    builder = sessions.builder.appName("rulec fleet").master(f"local[{jobs.processes}]")
    spark = running or builder.config("spark.ui.enabled", "false").getOrCreate()
    tallies = partial(_tallies, pickle.dumps(worker))

    def judged(table: Any) -> Any:
        return pyarrow.table(tallies(table))

    try:
        rows = [(number, pickle.dumps(unit)) for number, unit in enumerate(units)]
        frame = spark.createDataFrame(rows, "number long, unit binary")
        done = frame.repartition(max(1, len(rows)), "number").groupBy("number")
        for row in done.applyInArrow(judged, "tally binary").toLocalIterator():
            yield pickle.loads(bytes(row["tally"]))
    finally:
        if running is None:
            spark.stop()
