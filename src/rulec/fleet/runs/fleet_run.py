"""Judge all drives of a fleet, or those still missing, into a folder."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import chain
from pathlib import Path
from typing import Literal

from rulec.batch.jobs import Jobs
from rulec.diagnostics import RulecError
from rulec.extraction.selection import RequestedDrives
from rulec.files.left_alone import LeftAlone
from rulec.fleet.carried_rulebook import CompiledRules, carried
from rulec.fleet.judged_by import JudgedBy, judged_by
from rulec.fleet.runs.drive_keys import memory_given_back
from rulec.fleet.runs.engines import (
    Engine,
    judged_locally,
    local_engine,
    ray_engine,
    spark_engine,
)
from rulec.fleet.runs.fleet_folder import FleetFolder
from rulec.fleet.runs.fleet_inputs import fleet_inputs
from rulec.fleet.runs.fleet_tally import FleetTally
from rulec.fleet.runs.unit_work import UnitWorker
from rulec.fleet.runs.work_units import WorkUnit, work_units
from rulec.recordings.recording_format import RecordingSource
from rulec.trace.formats.arrow.parquet import arrow
from rulec.trace.trace_model import Ending
from rulec.value_display import short_repr

EngineName = Literal["local", "ray", "spark"]

_ENGINES: Mapping[EngineName, Callable[[], Engine]] = {
    "local": local_engine,
    "ray": ray_engine,
    "spark": spark_engine,
}


@dataclass(frozen=True, slots=True)
class FleetSettings:
    """How drives are judged: ``source`` says how to read recordings; its path is replaced.

    ``ends`` is how traces end, if it overrides the traces. ``jobs`` sets the number of processes.
    """

    __repr__ = short_repr

    request: RequestedDrives = field(default_factory=RequestedDrives)
    source: RecordingSource = field(default_factory=lambda: RecordingSource(Path("-")))
    ends: Ending | None = None
    engine: EngineName = "local"
    jobs: Jobs = field(default_factory=lambda: Jobs(1))


@dataclass(frozen=True, slots=True)
class FleetRun:
    """The result of a run: the number of ``units``, and how many were done ``before``.

    ``by`` is what drives were judged by, ``findings`` the folder of the part files, ``tally`` their
    sums; ``problems`` are inputs that could not be read, ``left_alone`` other files in
    searched folders, ``leftovers`` files of no unit.
    """

    __repr__ = short_repr

    by: JudgedBy
    findings: Path
    units: int
    before: int
    tally: FleetTally
    problems: tuple[RulecError, ...] = ()
    leftovers: tuple[Path, ...] = ()
    left_alone: tuple[LeftAlone, ...] = ()

    @property
    def is_complete(self) -> bool:
        """Whether all inputs were judged, and at least one drive."""
        tally = self.tally
        unread = tally.unread or tally.lost or tally.faults or self.problems
        return bool(self.tally.judged) and not unread


def run_fleet(
    arguments: Sequence[str],
    rules: CompiledRules,
    folder: Path,
    settings: FleetSettings,
    tell: Callable[[int, int], object] | None = None,
) -> FleetRun:
    """Judge all drives of some files, and write findings and a manifest to a folder.

    A unit whose file exists is not judged again. ``tell`` is called with the numbers of finished
    and of all units. Raises RulecError R0702, R0706 without pyarrow, R0712 for a folder of another
    fleet or one that another run writes to, R0713 without the engine, and the inputs' problems if
    none of them is a recording or a table.
    """
    # Report what is missing before anything is written.
    arrow("the table of findings")
    engine = _ENGINES[settings.engine]()
    inputs = fleet_inputs(arguments)
    if not inputs.paths:
        raise RulecError(
            [diagnostic for problem in inputs.problems for diagnostic in problem.diagnostics]
        )
    carried_rules = carried(rules)
    by = judged_by(carried_rules.read(), settings.request, settings.ends or "")
    kept = FleetFolder(folder, by)
    with kept.alone():
        kept.open(inputs.paths, settings.source, settings.request.egos)
        problems = list(inputs.problems)
        units: list[WorkUnit] = []
        with memory_given_back():
            for unit in work_units(inputs.tables, inputs.recordings):
                if isinstance(unit, RulecError):
                    problems.append(unit)
                else:
                    units.append(unit)
        worker = UnitWorker(carried_rules, settings.request, settings.source, settings.ends, kept)
        before = {unit.digest for unit in units if kept.is_done(unit)}
        there = [unit for unit in units if unit.digest in before]
        rest = [unit for unit in units if unit.digest not in before]
        results = judged_locally(worker, there, Jobs(1))
        if rest:
            results = chain(results, engine(worker, rest, settings.jobs))
        tally = FleetTally()
        for done, own in enumerate(results, 1):
            tally.add(own)
            if tell is not None:
                tell(done, len(units))
        return FleetRun(
            by,
            kept.findings,
            units=len(units),
            before=len(before),
            tally=tally,
            problems=tuple(problems),
            leftovers=tuple(kept.leftovers(units)),
            left_alone=inputs.left_alone,
        )
