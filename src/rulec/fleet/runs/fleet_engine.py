"""Interface of engines, which judge units of work in other processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import TypeAlias

from rulec.batch.jobs import Jobs
from rulec.fleet.runs.fleet_tally import FleetTally
from rulec.fleet.runs.unit_work import UnitWorker
from rulec.fleet.runs.work_units import WorkUnit

Engine: TypeAlias = Callable[[UnitWorker, Sequence[WorkUnit], Jobs], Iterator[FleetTally]]
"""Gives the tally of each unit, in any order; a unit whose worker fails is judged again."""
