"""Stretches of states in which participants count for ego, with their names."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import count, pairwise
from typing import NamedTuple

import numpy as np
from numpy import intp
from numpy.typing import NDArray

from rulec.extraction.drive_context import DriveContext, once
from rulec.trace.cells import Cells
from rulec.trace.plain_arrays import distinct, in_order


class Presence(NamedTuple):
    """An object of a trace: a participant's row, first and last column of its presence."""

    name: str
    row: int
    first: int
    last: int


@dataclass(frozen=True, eq=False, slots=True)
class PresenceRuns:
    """Presences, drive by drive, and those of a row together.

    The drive, the row, the first and the last state of each, counted from where its drive begins.
    """

    drives: NDArray[intp]
    rows: NDArray[intp]
    first: NDArray[intp]
    last: NDArray[intp]


@once
def presence_runs(context: DriveContext) -> PresenceRuns:
    """For how long each participant counts in each drive, absences up to ``away_s`` bridged.

    Who is in sight only, too far away to count, is not present.
    """
    longest, spans = round(context.thresholds.away_s / context.recording.step_s), context.spans
    counting, s = Cells.at(context.relevant), context.extents.s
    rows, columns = counting.rows, counting.columns
    drives, away = spans.number[columns], columns[1:] - columns[:-1]
    parted = (rows[1:] > rows[:-1]) | (away > longest + 1) | (drives[1:] > drives[:-1])
    parted |= np.isnan(counting.of(s))[1:]
    gaps = np.flatnonzero(~parted & (away > 1))
    in_gaps = distinct(rows[gaps])
    unknown, own = np.cumsum(np.isnan(s[in_gaps]), axis=1), np.searchsorted(in_gaps, rows[gaps])
    parted[gaps] = unknown[own, columns[gaps]] < unknown[own, columns[gaps + 1]]
    some = np.ones(min(len(rows), 1), dtype=bool)
    begins, ends = (np.flatnonzero(np.append(*x)) for x in ((some, parted), (parted, some)))
    order = in_order(drives[begins])
    begins, ends = begins[order], ends[order]
    own = drives[begins]
    shift = spans.begins[own]
    return PresenceRuns(own, rows[begins], columns[begins] - shift, columns[ends] - shift)


@once
def presence_cells(context: DriveContext) -> Cells:
    """The cells of presences, one after the other: only there numbers are measured."""
    runs = presence_runs(context)
    shift = context.spans.begins[runs.drives]
    shape = context.relevant.shape
    return Cells.of_runs(shape, runs.rows, runs.first + shift, runs.last + shift)


def presences(context: DriveContext) -> list[list[Presence]]:
    """The contiguous presences of all participants in each drive.

    Absences up to ``away_s`` are bridged. Those in which one is not beside the road never are: its
    extents are not known then.
    """
    runs = presence_runs(context)
    of_row = runs.rows.tolist()
    own = list(map(context.ids.__getitem__, of_row)), of_row, runs.first.tolist()
    every = list(map(Presence._make, zip(*own, runs.last.tolist(), strict=True)))
    ends = np.searchsorted(runs.drives, np.arange(context.spans.n_drives + 1)).tolist()
    found = [every[begin:end] for begin, end in pairwise(ends)]
    again = (runs.drives[1:] == runs.drives[:-1]) & (runs.rows[1:] == runs.rows[:-1])
    for drive in distinct(runs.drives[1:][again]).tolist():
        found[drive] = _renamed(found[drive], _ids_in(context, drive))
    return found


def _renamed(presences: Sequence[Presence], ids: frozenset[str]) -> list[Presence]:
    """The presences of a drive, with names of their own for who comes again."""
    found: list[Presence] = []
    for one in presences:
        if found and found[-1].row == one.row:
            taken = ids.union(other.name for other in found)
            name = next(free for k in count(2) if (free := f"{one.name}_{k}") not in taken)
            one = one._replace(name=name)
        found.append(one)
    return found


def _ids_in(context: DriveContext, drive: int) -> frozenset[str]:
    """The names of the participants that a drive is about."""
    columns = context.spans.slices[drive]
    rows = (context.relevant | context.in_sight)[:, columns].any(axis=1)
    bodies = context.tracks.participants
    return frozenset(bodies[row].id for row in np.flatnonzero(rows).tolist())
