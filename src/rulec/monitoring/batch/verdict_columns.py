"""Verdicts on many traces: a column for each rule and binding."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import partial

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRule
from rulec.monitoring.batch.machines.joint_machine import join_machines
from rulec.monitoring.batch.machines.table_run import first_lost, first_lost_of_one, run, run_alone
from rulec.trace.trace_columns import Array, Layout
from rulec.value_display import short_repr


@dataclass(frozen=True, slots=True, eq=False)
class RuleBinding:
    """A rule bound to ``objects`` from step ``first`` to ``last`` (inclusive).

    ``last`` is None for each trace's own end. Bindings are compared by identity, since they are
    keys.
    """

    rule: CompiledRule
    objects: Mapping[str, str]
    first: int
    last: int | None

    @property
    def stretch(self) -> tuple[int, int | None]:
        """The first and the last step."""
        return self.first, self.last


@dataclass(frozen=True, slots=True, eq=False)
class JointCells:
    """A column of cells, and the letters of some bindings in them.

    ``letters[k][cell]`` is the letter class that the k-th binding's machine reads there; it is
    negative if there is none, because a value is missing or the values are impossible.
    """

    layout: Layout
    cells: Array
    bindings: Sequence[RuleBinding]
    letters: Sequence[Sequence[int]]


@dataclass(frozen=True, slots=True, eq=False, kw_only=True)
class VerdictColumns:
    """Verdicts for a binding; ``accepted`` follows the layout's order of traces.

    ``unread`` are traces without a verdict, since a value is missing or impossible on the
    binding's stretch; what is said of them is meaningless.
    """

    __repr__ = short_repr

    task: RuleBinding
    accepted: NDArray[np.bool_]
    unread: NDArray[np.intp]
    _lost_at: Callable[[NDArray[np.intp]], NDArray[np.int64]] = field(compare=False, repr=False)

    @property
    def violated(self) -> NDArray[np.intp]:
        """The traces that violate the rule."""
        return np.flatnonzero(~self.accepted)

    def lost_at(self) -> NDArray[np.int64]:
        """The first state that loses the rule for each of ``violated``, or -1.

        It is -1 if only the end of the trace, or of the objects' stretch, decides.
        """
        return self._lost_at(self.violated)


def verdict_columns(cells: JointCells) -> Iterator[VerdictColumns]:
    """Verdicts for some bindings with a common stretch, in their order."""
    if not cells.bindings:
        return
    first, last = cells.bindings[0].stretch
    unread, letters_read = zip(*[_read(cells, letters) for letters in cells.letters], strict=True)
    machines = [binding.rule.machine for binding in cells.bindings]
    for joint in join_machines(list(zip(machines, letters_read, strict=True))):
        verdicts = run(joint, cells.cells, cells.layout, first, last)
        for bit, member in enumerate(joint.members):
            yield VerdictColumns(
                task=cells.bindings[member],
                accepted=(verdicts & np.uint8(1 << bit)) != 0,
                unread=unread[member],
                _lost_at=partial(_lost_at, cells, cells.bindings[member], letters_read[member]),
            )


def _lost_at(
    joint: JointCells, binding: RuleBinding, own: Sequence[int], chosen: NDArray[np.intp]
) -> NDArray[np.int64]:
    """As ``VerdictColumns.lost_at`` for these traces; ``own`` are the letters of the cells."""
    layout, cells = joint.layout, joint.cells
    first, last = binding.stretch
    ends = layout.lengths[chosen] if last is None else np.full(len(chosen), last + 1)
    machine = binding.rule.machine
    if len(ends) and run_alone(len(ends), int(ends[0]) - first, len(machine.successors)):
        letters = np.array(own)
        words = (cells[layout.places(trace, first, last)] for trace in chosen.tolist())
        lost = np.array([first_lost_of_one(machine, letters.take(word)) for word in words])
    else:
        # The ends are in descending order: those after a step come first.
        by_step = (
            cells[layout.starts[step] + chosen[: np.searchsorted(-ends, -step)]]
            for step in range(first, int(ends[0]) if len(ends) else first)
        )
        lost = first_lost(machine, own, by_step, ends - first)
    return np.where(lost < 0, lost, lost + first)


def _read(cells: JointCells, letters: Sequence[int]) -> tuple[NDArray[np.intp], tuple[int, ...]]:
    """The unread traces, and the letters, with 0 for cells without one, which occur only there."""
    if min(letters, default=0) >= 0:
        return np.empty(0, dtype=np.intp), tuple(letters)
    (first, last), layout = cells.bindings[0].stretch, cells.layout
    start = layout.starts[first]
    end = layout.starts[-1 if last is None else last + 1]
    missing = np.array(letters) < 0
    places = np.flatnonzero(missing.take(cells.cells[start:end])) + start
    unread = np.unique(layout.traces_at(places))
    return unread, tuple([max(letter, 0) for letter in letters])
