"""Stretches of states in which participants count for ego, and their names."""

from __future__ import annotations

from collections.abc import Sequence
from collections.abc import Set as AbstractSet
from dataclasses import dataclass
from itertools import count
from typing import Any

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.computed_once import once
from rulec.extraction.drive_context import DriveContext
from rulec.trace.cells import Cells


@dataclass(frozen=True, eq=False, slots=True)
class PresenceRuns:
    """Presences ordered by drive, those of a row together.

    For each: its drive, its row, and its first and last state, counted from the start of its drive.
    """

    drives: NDArray[intp]
    rows: NDArray[intp]
    first: NDArray[intp]
    last: NDArray[intp]


@once
def presence_runs(context: DriveContext) -> PresenceRuns:
    """When each participant counts in each drive, with absences up to ``away_s`` bridged.

    Participants that are in sight but too far away to count are not present.
    """
    longest, spans = context.steps_in(context.thresholds.away_s), context.spans
    counting, s = Cells.at(context.relevant), context.extents.s
    rows, columns = counting.rows, counting.columns
    drives, away = spans.number[columns], columns[1:] - columns[:-1]
    parted = (rows[1:] > rows[:-1]) | (away > longest + 1) | (drives[1:] > drives[:-1])
    parted |= np.isnan(counting.of(s))[1:]
    gaps = (~parted & (away > 1)).nonzero()[0]
    in_gaps = np.unique(rows[gaps])
    unknown, own = np.isnan(s[in_gaps]).cumsum(axis=1), in_gaps.searchsorted(rows[gaps])
    parted[gaps] = unknown[own, columns[gaps]] < unknown[own, columns[gaps + 1]]
    some = np.ones(min(len(rows), 1), dtype=bool)
    begins, ends = (np.concatenate(x).nonzero()[0] for x in ((some, parted), (parted, some)))
    order = drives[begins].argsort(kind="stable")
    begins, ends = begins[order], ends[order]
    own = drives[begins]
    shift = spans.begins[own]
    return PresenceRuns(own, rows[begins], columns[begins] - shift, columns[ends] - shift)


@once
def presence_cells(context: DriveContext) -> Cells:
    """The cells of all presences, one after the other; numbers are measured only there."""
    runs = presence_runs(context)
    shift = context.spans.begins[runs.drives]
    shape = context.relevant.shape
    return Cells.of_runs(shape, runs.rows, runs.first + shift, runs.last + shift)


@once
def _presence_numbers(context: DriveContext) -> NDArray[intp]:
    """For each cell of the arrays its number among the presence cells, or their count."""
    cells = presence_cells(context)
    return cells.laid(np.arange(len(cells)), len(cells)).ravel()


def in_presences(
    context: DriveContext, cells: Cells, values: NDArray[Any], elsewhere: float
) -> NDArray[Any]:
    """Values of ``cells`` spread over the presence cells; ``elsewhere`` in those without one."""
    found = np.full(len(presence_cells(context)) + 1, elsewhere)
    found[_presence_numbers(context).take(cells.places)] = values
    return found[:-1]


def presence_names(context: DriveContext) -> list[str]:
    """The object names of the presence runs in their drives.

    A participant that returns after being away, or not beside the road, gets a new name, which is
    no participant's id.
    """
    runs = presence_runs(context)
    names = list(map(context.ids.__getitem__, runs.rows.tolist()))
    again = (runs.drives[1:] == runs.drives[:-1]) & (runs.rows[1:] == runs.rows[:-1])
    if not again.any():
        return names
    ids = context.recording.ids
    for drive in np.unique(runs.drives[1:][again]).tolist():
        begin, end = runs.drives.searchsorted((drive, drive + 1)).tolist()
        comes_again = again[begin : end - 1].tolist()
        names[begin:end] = _renamed(names[begin:end], comes_again, ids)
    return names


def _renamed(names: Sequence[str], comes_again: Sequence[bool], ids: frozenset[str]) -> list[str]:
    """The names in a drive; ``comes_again`` marks those after the first that repeat the last.

    They get new ones, which are not among ``ids``.
    """
    found = list(names[:1])
    for name, again in zip(names[1:], comes_again, strict=True):
        if again:
            taken = ids.union(found)
            name = next(free for k in count(2) if (free := f"{name}_{k}") not in taken)
        found.append(name)
    return found


def participant_called(name: str, ids: AbstractSet[str]) -> str:
    """The id of the participant that an object's name stands for; ``ids`` are the recording's."""
    return name if name in ids else name.rpartition("_")[0]
