"""The files of a fleet: tables of many drives, and recordings of one file each."""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from rulec.diagnostics import RulecError
from rulec.files.file_messages import LINK_OUT
from rulec.files.left_alone import LeftAlone
from rulec.files.read_files import is_folder, opened
from rulec.files.work_trees import leads_out, refuse_no_file, tree_of
from rulec.fleet.fleet_messages import no_fleet_input
from rulec.fleet.table_kind import RECORDING
from rulec.recordings.encodings.csv_head import PARQUET
from rulec.recordings.recording_files import is_recording
from rulec.recordings.recording_inputs import STANDARD_INPUT, input_files
from rulec.trace.formats.arrow.parquet_columns import parquet_names
from rulec.trace.formats.table_reader import STEP, TRACE


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
