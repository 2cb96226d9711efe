"""Work in several processes, with results in the order of the tasks."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from time import monotonic

from rulec.batch.jobs import Jobs, LostTask, Result, Task


def nobody(*_: object) -> None:
    """Do nothing."""


def in_order(
    work: Callable[[Task], Iterator[Result]],
    tasks: Sequence[Task],
    jobs: Jobs,
    tell: Callable[[int], object] = nobody,
    lost: Callable[[Task, int | None], object] = nobody,
) -> Iterator[tuple[Task, Result | LostTask]]:
    """Each task with each of its results, in the order of the tasks.

    ``work`` is sent to other processes, so it has to be a module's function or a partial of one,
    and always give the same results. For one process or a single task it is called in this process.
    ``tell`` is called with the number of finished tasks. If a task's process is killed, ``lost`` is
    called with the task and the signal, and a new process repeats the task once.
    """
    begin = monotonic()
    here = 0
    for task in tasks:
        is_worth_it = jobs.processes > 1 and len(tasks) - here > 1
        if is_worth_it and monotonic() - begin >= jobs.alone_s:
            break
        for result in work(task):
            yield task, result
        here += 1
        tell(here)
    if here == len(tasks):
        return
    left = tasks[here:]
    # Processes, 15 ms: not if this one does all, as in a browser, which has no others.
    from rulec.batch.worker_processes import WorkerProcesses

    pool = WorkerProcesses(work, left, min(jobs.processes, len(left)), lost)
    try:
        for number, task in enumerate(left):
            for answer in pool.results(number):
                yield task, answer
            tell(here + number + 1)
    finally:
        pool.stop()
