"""Units of work judged in this process, or in several on this machine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.batch.jobs import Jobs
from rulec.batch.worker_pool import LostTask, in_order
from rulec.fleet.runs.fleet_engine import Engine
from rulec.fleet.runs.fleet_tally import FleetTally
from rulec.fleet.runs.unit_work import UnitWorker
from rulec.fleet.runs.work_units import WorkUnit


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
