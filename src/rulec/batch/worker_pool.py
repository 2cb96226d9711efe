"""Work in several processes, with results in the order of the tasks."""

from __future__ import annotations

import multiprocessing
import signal
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from multiprocessing import resource_tracker
from multiprocessing.connection import Connection, wait
from multiprocessing.process import BaseProcess
from time import monotonic
from typing import Generic, NoReturn, TypeVar

from rulec.batch.jobs import Jobs
from rulec.cache.keeping import Recalled, recalled, recalling

Task = TypeVar("Task")
Result = TypeVar("Result")

TASKS_AHEAD = 4
"""So many tasks for each process may be done before an earlier one is."""

MOST_WAITING = 256
"""A task whose results are not wanted yet pauses once so many of them wait."""

_STOP_S = 5.0


@dataclass(frozen=True, slots=True)
class LostTask:
    """A task whose process was killed, by a signal for one, before it was done, twice."""

    signal_number: int | None


@dataclass(frozen=True, slots=True)
class _Raised:
    """What a task raised, which is a mistake of the program's."""

    error: Exception


class _Done:
    """The end of a task's results."""


def ignore(*_: object) -> None:
    """Tell nobody."""


def in_order(
    work: Callable[[Task], Iterator[Result]],
    tasks: Sequence[Task],
    jobs: Jobs,
    tell: Callable[[int], object] = ignore,
    lost: Callable[[Task, int | None], object] = ignore,
) -> Iterator[tuple[Task, Result | LostTask]]:
    """Every task with each of its results, in the order of the tasks.

    ``work`` goes to other processes, so it has to be a function of a module, or a partial one, with
    the same results whenever it is called. Where one process has to do, or a single task is left,
    it is called here. ``tell`` is told how many tasks are done. A task whose process is killed is
    done again by a new one, once; ``lost`` is told of it, with the signal.
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
    pool = _Pool(work, left, min(jobs.processes, len(left)), lost)
    try:
        for number, task in enumerate(left):
            for answer in pool.results(number):
                if isinstance(answer, _Raised):
                    raise answer.error
                yield task, answer
            tell(here + number + 1)
    finally:
        pool.stop()


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """A block that Ctrl-C waits for, and whose processes never hear of it.

    It goes to all processes of a terminal, and is for the first one to end the others.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Worker(Generic[Task, Result]):
    """A process, and the number of the task that it works on."""

    def __init__(self, work: Callable[[Task], Iterator[Result]]) -> None:
        # A forked process would have locks of threads that are not in it.
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        given = work, theirs, recalled()
        self.process: BaseProcess = context.Process(target=_serve, args=given, daemon=True)
        self.process.start()
        theirs.close()
        self.number: int | None = None


class _Pool(Generic[Task, Result]):
    """Processes, and the results that are not yet wanted, by the number of their task."""

    def __init__(
        self,
        work: Callable[[Task], Iterator[Result]],
        tasks: Sequence[Task],
        jobs: int,
        lost: Callable[[Task, int | None], object],
    ) -> None:
        self._work = work
        self._tasks = tasks
        self._jobs = jobs
        self._lost = lost
        self._workers: list[_Worker[Task, Result]] = []
        self._next = 0
        self._again: deque[int] = deque()
        self._waiting: dict[int, deque[object]] = {}
        self._received: dict[int, int] = {}
        self._known: dict[int, int] = {}
        """Of tasks that are done again, how many of their results have come before."""
        # To start it lets interrupts through (Python 3.11): before they are kept from workers.
        resource_tracker.ensure_running()

    def results(self, number: int) -> Iterator[Result | LostTask | _Raised]:
        """The results of a task; those of later ones are kept meanwhile."""
        while True:
            self._hand_out(number)
            waiting = self._waiting[number]
            while waiting:
                result = waiting.popleft()
                if isinstance(result, _Done):
                    del self._waiting[number]
                    return
                yield result  # type: ignore[misc]
            self._receive(number)

    def stop(self) -> None:
        """End all processes, whatever they are doing."""
        with _without_interrupts():
            for worker in self._workers:
                worker.process.terminate()
                worker.connection.close()
            for worker in self._workers:
                worker.process.join(_STOP_S)
                if worker.process.exitcode is None:
                    worker.process.kill()
                    worker.process.join()

    def _hand_out(self, wanted: int) -> None:
        """Give tasks to processes that have none, first those that are done again."""
        last = min(len(self._tasks), wanted + self._jobs * TASKS_AHEAD)
        while self._again or self._next < last:
            worker = next((each for each in self._workers if each.number is None), None)
            if worker is None:
                if len(self._workers) == self._jobs:
                    return
                with _without_interrupts():
                    worker = _Worker(self._work)
                    self._workers.append(worker)
            if self._again:
                number = self._again.popleft()
            else:
                number = self._next
                self._waiting[number] = deque()
                self._next += 1
            worker.number = number
            self._received[number] = 0
            try:
                worker.connection.send(self._tasks[number])
            except OSError:
                self._lose(worker)

    def _receive(self, wanted: int) -> None:
        """Wait for results of some process, and take one from each that has some."""
        busy = {
            worker.connection: worker
            for worker in self._workers
            if worker.number is not None
            and (worker.number == wanted or len(self._waiting[worker.number]) < MOST_WAITING)
        }
        for connection in wait(list(busy)):
            worker = busy[connection]  # type: ignore[index]
            assert worker.number is not None, "it is busy"
            try:
                result = worker.connection.recv()
            except (EOFError, OSError):
                self._lose(worker)
                continue
            self._received[worker.number] += 1
            if self._received[worker.number] > self._known.get(worker.number, 0):
                self._waiting[worker.number].append(result)
            if isinstance(result, _Done):
                worker.number = None

    def _lose(self, worker: _Worker[Task, Result]) -> None:
        """Note that a process is gone; another one takes its place where there is work."""
        number = worker.number
        assert number is not None, "it was busy"
        worker.process.join(_STOP_S)
        code = worker.process.exitcode
        killed = -code if code is not None and code < 0 else None
        self._workers.remove(worker)
        worker.connection.close()
        if number in self._known:
            self._waiting[number] += (LostTask(killed), _Done())
            return
        self._known[number] = self._received[number]
        self._again.append(number)
        self._lost(self._tasks[number], killed)


def _serve(
    work: Callable[[Task], Iterator[Result]],
    connection: Connection,
    cached: Recalled,
) -> None:
    """Do tasks until none is given any more, with what the parent process has ``cached``."""
    # What a task has begun, such as processes of its own, is ended with it.
    signal.signal(signal.SIGTERM, _leave)
    with suppress(EOFError, OSError), recalling(cached):
        while True:
            task = connection.recv()
            try:
                for result in work(task):
                    connection.send(result)
            except OSError:
                raise
            except Exception as error:
                connection.send(_Raised(error))
            connection.send(_Done())


def _leave(number: int, _: object) -> NoReturn:
    raise SystemExit(128 + number)
