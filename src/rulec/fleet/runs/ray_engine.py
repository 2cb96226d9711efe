"""Judge units of work with Ray Data, on the current cluster or on this machine."""

from __future__ import annotations

import logging
import os
import pickle
from collections.abc import Iterator, Sequence
from functools import partial
from typing import Any

from rulec.batch.jobs import Jobs
from rulec.fleet.fleet_messages import engine_missing
from rulec.fleet.runs.fleet_engine import Engine
from rulec.fleet.runs.fleet_tally import FleetTally
from rulec.fleet.runs.unit_work import UnitWorker
from rulec.fleet.runs.work_units import WorkUnit

_BLOCKS = 16
"""Number of tasks per process: fewer leave some processes idle, more add overhead."""


def ray_engine() -> Engine:
    """Ray as an engine. Raises RulecError R0713 without it."""
    try:
        import ray  # an extra, and seconds
        import ray.data  # as above
    except ImportError:
        raise engine_missing("ray", "ray[data]") from None
    return partial(_judged_by, ray)


def _judged_by(
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
            partial(_judged, pickle.dumps(worker)),
            batch_size=1,
            batch_format="pyarrow",
            compute=ray.data.TaskPoolStrategy(jobs.processes),
        )
        for row in done.iter_rows():
            yield pickle.loads(row["tally"])
    finally:
        if own:
            ray.shutdown()


def _judged(sent: bytes, units: Any) -> dict[str, list[bytes]]:
    """The tally of each unit in a table; the rulebook is read once in each process."""
    worker: UnitWorker = pickle.loads(sent)
    work_units = (pickle.loads(unit) for unit in units.column("unit").to_pylist())
    return {"tally": [pickle.dumps(worker.judged(unit)) for unit in work_units]}
