"""A cheaper trajectory for a path, by a search over the sides on which ego passes obstacles.

The sides of an obstacle are alternatives, of which a linear program takes one at each time. The
search branches where a solution overlaps an obstacle: ego stays on one side of it, or changes from
beside it to behind or in front of it, or back. What costs least is branched first.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from heapq import heappop, heappush
from itertools import count, product

from rulec.partition.motion.linear_program import LinearProgram, Solution
from rulec.partition.motion.others_beside import (
    ACROSS,
    ALONG,
    Cut,
    CutRows,
    Cuts,
    OthersBeside,
    Side,
)

MOST_PROGRAMS = 120
"""The most linear programs solved for a path."""

_SPLITS = (1 / 3, 2 / 3)
"""Parts of the time of an overlap after which ego changes its side."""


def least_by_sides(
    program: LinearProgram,
    others: OthersBeside,
    path: Sequence[int],
    further: Callable[[Solution], Sequence[Cut]],
    below: float,
) -> Solution | None:
    """A solution of lower cost than ``below`` that overlaps no obstacle; None if none is found.

    ``further`` gives the rows that a solution violates apart from obstacles, once it overlaps none.
    """
    rows, numbers, n_solved = CutRows(program), count(), 0
    waiting: list[tuple[float, int, Cuts, Solution]] = []

    def put(cuts: Cuts) -> None:
        nonlocal n_solved
        n_solved += 1
        rows.switch(cuts)
        solution = program.solved()
        if solution is not None and solution.cost < below:
            heappush(waiting, (solution.cost, next(numbers), cuts, solution))

    put({})
    while waiting and n_solved < MOST_PROGRAMS:
        _, _, cuts, solution = heappop(waiting)
        hit = next(others.hits(solution), None)
        if hit is None:
            more = {cut.name: cut for cut in further(solution) if cut.name not in cuts}
            if not more:
                return solution
            put({**cuts, **more})
            continue
        for sides in _plans(others, path, *hit):
            put({**cuts, **{cut.name: cut for cut in sides}})
    return None


def _plans(
    others: OthersBeside, path: Sequence[int], name: str | int, times: Sequence[int]
) -> Iterator[list[Cut]]:
    """The ways to keep beside an obstacle at these numbers of times, as rows."""
    plans: list[list[Side]] = [[side] * len(times) for side in (*ALONG, *ACROSS)]
    if len(times) > 1:
        for split, along, across in product(_SPLITS, ALONG, ACROSS):
            first = max(1, round(split * len(times)))
            for before, after in ((along, across), (across, along)):
                plans.append([before] * first + [after] * (len(times) - first))
    possible = [others.possible_sides(name, k, path) for k in times]
    for plan in plans:
        if all(side in own for side, own in zip(plan, possible, strict=True)):
            yield [others.cut(name, side, k) for side, k in zip(plan, times, strict=True)]
