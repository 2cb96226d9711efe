"""A cheaper trajectory for a path, by a search over the sides on which ego passes obstacles.

The sides of an obstacle are alternatives, of which a linear program takes one at each time. The
search branches where a solution overlaps an obstacle: ego stays on one side of it, or changes from
beside it to behind or in front of it, or back. What costs least is branched first.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Iterator, Sequence
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

MOST_PROGRAMS = 200
"""The most linear programs solved for a path."""

_SPLITS = (0.0, 1 / 3, 2 / 3, 1.0)
"""Parts of the time of an overlap in which ego can change its side, after which it does."""


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
    count = len(times)
    possible = [others.possible_sides(name, k, path) for k in times]
    plans: list[list[Side]] = [[side] * count for side in (*ALONG, *ACROSS)]
    for along, across in product(ALONG, ACROSS):
        for before, after in ((along, across), (across, along)):
            splits = _splits(possible, before, after)
            plans += [[before] * first + [after] * (count - first) for first in splits]
    for plan in plans:
        if all(side in own for side, own in zip(plan, possible, strict=True)):
            yield [others.cut(name, side, k) for side, k in zip(plan, times, strict=True)]


def _splits(possible: Sequence[Collection[Side]], before: Side, after: Side) -> list[int]:
    """After how many of some times ego changes its side, spread over those when it can."""
    count = len(possible)
    latest = next((k for k, own in enumerate(possible) if before not in own), count)
    missing = [k for k, own in enumerate(possible) if after not in own]
    earliest = missing[-1] + 1 if missing else 0
    low, high = max(earliest, 1), min(latest, count - 1)
    if low > high:
        return []
    return sorted({round(low + part * (high - low)) for part in _SPLITS})
