"""What the engine says of one rule, for one binding, on many traces."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from rulec.runtime.batch.joint import joined
from rulec.runtime.batch.running import first_lost, run
from rulec.runtime.batch.tasks import Task
from rulec.trace.columns import Array, Layout


@dataclass(frozen=True, slots=True, eq=False)
class Walk:
    """The column of cells that tasks are judged on, and what the cells mean to each of them.

    ``letters[k][cell]`` is the class of the letter that the k-th task's machine reads there.
    """

    layout: Layout
    cells: Array
    tasks: Sequence[Task]
    letters: Sequence[Sequence[int]]


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """A task's verdicts: ``accepted`` has one for each trace, in the layout's order."""

    task: Task
    accepted: NDArray[np.bool_]
    _layout: Layout
    _cells: Array
    _letters: Sequence[int]

    @property
    def violated(self) -> NDArray[np.intp]:
        """The traces that violate the rule."""
        return np.flatnonzero(~self.accepted)

    def lost_at(self) -> NDArray[np.int64]:
        """For each of ``violated`` the first state after which nothing can save the rule, or -1.

        -1 if only the end of the trace, or of the objects' stretch, decides.
        """
        chosen, layout = self.violated, self._layout
        first, last = self.task.stretch
        ends = layout.lengths[chosen] if last is None else np.full(len(chosen), last + 1)
        steps = range(first, int(ends[0]) if len(ends) else first)
        walks = (
            self._cells[layout.starts[step] + chosen[: _longer(ends, step)]] for step in steps
        )
        lost = first_lost(self.task.rule.machine, self._letters, walks, ends - first)
        return np.where(lost < 0, lost, lost + first)


def _longer(ends: NDArray[np.int64], step: int) -> int:
    """How many of these, which descend, are above a step."""
    return int(np.searchsorted(-ends, -step))


def judged(walk: Walk) -> Iterator[Judged]:
    """The verdicts on a walk's tasks, in their order. All have the same stretch."""
    if not walk.tasks:
        return
    first, last = walk.tasks[0].stretch
    machines = [
        (task.rule.machine, letters)
        for task, letters in zip(walk.tasks, walk.letters, strict=True)
    ]
    for joint in joined(machines):
        verdicts = run(joint, walk.cells, walk.layout, first, last)
        for bit, member in enumerate(joint.members):
            accepted = (verdicts & np.uint8(1 << bit)) != 0
            task, letters = walk.tasks[member], walk.letters[member]
            yield Judged(task, accepted, walk.layout, walk.cells, letters)
