"""Judge all drives of a fleet, or those still missing, into a folder.

Engines judge the units of work: in processes of this machine, with Ray Data, or Spark.
"""

from __future__ import annotations

import logging
import os
import pickle
import shutil
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial
from itertools import chain
from pathlib import Path
from typing import Any, Literal, TypeAlias

from rulec.batch.jobs import Jobs, LostTask
from rulec.batch.worker_pool import in_order
from rulec.diagnostics import RulecError
from rulec.extraction.selection import RequestedDrives
from rulec.files.file_messages import LINK_OUT
from rulec.files.left_alone import LeftAlone
from rulec.files.read_files import is_folder, opened
from rulec.files.work_trees import leads_out, refuse_no_file, tree_of
from rulec.fleet.drive_rows import JudgedBy, judged_by
from rulec.fleet.fleet_judge import CompiledRules, carried
from rulec.fleet.fleet_messages import engine_missing, java_missing, no_fleet_input
from rulec.fleet.runs.fleet_folder import FleetFolder, FleetTally
from rulec.fleet.runs.unit_work import UnitWorker
from rulec.fleet.runs.work_units import WorkUnit, memory_given_back, work_units
from rulec.fleet.table_recordings import RECORDING
from rulec.recordings.encodings.csv_head import PARQUET
from rulec.recordings.recording_files import is_recording
from rulec.recordings.recording_format import RecordingSource
from rulec.recordings.recording_inputs import STANDARD_INPUT, input_files
from rulec.trace.formats.arrow.parquet import arrow, parquet_names
from rulec.trace.formats.table_reader import STEP, TRACE
from rulec.trace.trace_model import Ending
from rulec.value_display import short_repr

Engine: TypeAlias = Callable[[UnitWorker, Sequence[WorkUnit], Jobs], Iterator[FleetTally]]
"""Gives the tally of each unit, in any order; a unit whose worker fails is judged again."""

_BLOCKS = 16
"""Number of Ray's tasks per process: fewer leave some processes idle, more add overhead."""


def judged_locally(
    worker: UnitWorker, units: Sequence[WorkUnit], jobs: Jobs
) -> Iterator[FleetTally]:
    """The tally of each unit; a unit whose process is killed twice is only listed as lost."""
    for unit, result in in_order(partial(_judged, worker), units, jobs):
        yield FleetTally(lost=[unit.path]) if isinstance(result, LostTask) else result


def _judged(worker: UnitWorker, unit: WorkUnit) -> Iterator[FleetTally]:
    yield worker.judged(unit)


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


EngineName = Literal["local", "ray", "spark"]

_ENGINES: Mapping[EngineName, Callable[[], Engine]] = {
    "local": lambda: judged_locally,
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


@dataclass(frozen=True, slots=True)
class FleetInputs:
    """Tables and recordings, each once and in order, and why other files are neither."""

    tables: tuple[str, ...]
    recordings: tuple[str, ...]
    problems: tuple[RulecError, ...] = ()
    left_alone: tuple[LeftAlone, ...] = ()

    @property
    def paths(self) -> tuple[str, ...]:
        """All of them."""
        return (*self.tables, *self.recordings)


def fleet_inputs(arguments: Sequence[str]) -> FleetInputs:
    """The files given by paths, patterns and folders.

    A folder stands for the recordings and the tables of drives in and below it.
    """
    tables: dict[str, None] = {}
    recordings: dict[str, None] = {}
    problems: list[RulecError] = []
    left_alone: dict[str, LeftAlone] = {}
    for argument in arguments:
        below = list(_tables_below(argument))
        tables |= dict.fromkeys(below)
        files = input_files([argument])
        # A folder that contains only tables need not contain recordings.
        problems += (
            problem for problem in files.problems if not below or not _is_about(argument, problem)
        )
        others = [file for searched in files.searched for file in searched.left_alone]
        left_alone |= {file.path: file for file in others if file.path not in below}
        for path in files.paths:
            try:
                # Each file is read by any free process, perhaps on another machine.
                refuse_no_file(Path(path))
            except RulecError as error:
                problems.append(error)
                continue
            if path.lower().endswith(PARQUET) and _is_table(path):
                tables[path] = None
            elif path != STANDARD_INPUT and is_recording(path):
                recordings[path] = None
            else:
                problems.append(_why_not(path))
    return FleetInputs(
        _distinct_files(tables),
        _distinct_files(recordings),
        tuple(problems),
        tuple(left_alone.values()),
    )


def _distinct_files(paths: Iterable[str]) -> tuple[str, ...]:
    """Each file once, however often it is given, by the first of its paths."""
    first: dict[str, str] = {}
    for path in paths:
        first.setdefault(os.path.realpath(path), path)
    return tuple(first.values())


def _tables_below(argument: str) -> Iterator[str]:
    folder = Path(argument)
    if not is_folder(folder) or (argument != STANDARD_INPUT and is_recording(argument)):
        return
    tree = tree_of(folder)
    for path in sorted(x for x in folder.rglob("*") if x.name.lower().endswith(PARQUET)):
        hidden = any(part.startswith(".") for part in path.relative_to(folder).parts)
        if path.is_file() and not hidden and not leads_out(path, tree) and _is_table(str(path)):
            yield str(path)


def _is_about(argument: str, problem: RulecError) -> bool:
    """Whether a problem is about a folder itself, not about a file or link in it."""
    places = [diagnostic.place for diagnostic in problem.diagnostics]
    codes = {diagnostic.code for diagnostic in problem.diagnostics}
    return LINK_OUT.code not in codes and all(
        place is not None and Path(place.file) == Path(argument) for place in places
    )


def _why_not(path: str) -> RulecError:
    try:
        with opened(Path(path)):
            return no_fleet_input(path)
    except RulecError as error:
        return error


def _is_table(path: str) -> bool:
    """Whether a file is a table of traces, or of tracks with a column for their recording."""
    try:
        names = {*parquet_names(Path(path), lambda why, **_: no_fleet_input(path, why))}
    except RulecError:
        return False
    return {TRACE, STEP} <= names or (RECORDING in names and is_recording(path))
