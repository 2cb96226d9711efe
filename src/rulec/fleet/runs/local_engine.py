"""Units of work judged in this process, or in several of this machine."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rulec.batch.jobs import Jobs
from rulec.batch.worker_pool import LostTask, in_order
from rulec.fleet.runs.fleet_engine import Engine
from rulec.fleet.runs.fleet_tally import FleetTally
from rulec.fleet.runs.unit_work import UnitWorker
from rulec.fleet.runs.work_units import WorkUnit


def local_engine() -> Engine:
    """The engine that there always is."""
    return judged_locally


def judged_locally(
    worker: UnitWorker, units: Sequence[WorkUnit], jobs: Jobs
) -> Iterator[FleetTally]:
    """What each unit comes to; one whose process is killed twice is only named."""
    for unit, result in in_order(_Work(worker), units, jobs):
        yield FleetTally(lost=[unit.path]) if isinstance(result, LostTask) else result


class _Work:
    """What a process does with a unit."""

    def __init__(self, worker: UnitWorker) -> None:
        self._worker = worker

    def __call__(self, unit: WorkUnit) -> Iterator[FleetTally]:
        yield self._worker.judged(unit)
