"""Processes that do tasks, whose results wait for those of earlier tasks."""

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
from multiprocessing.reduction import ForkingPickler
from typing import Generic, NoReturn

from rulec.batch.jobs import LostTask, Result, Task
from rulec.cache.keeping import is_keeping, keeping
from rulec.diagnostics import RulecError
from rulec.diagnostics.fault_messages import fault_of

TASKS_AHEAD = 4
"""The number of tasks per process that may be finished ahead of an earlier one."""

MOST_WAITING = 256
"""A task pauses when this many of its results wait for earlier tasks."""

_STOP_S = 5.0


@dataclass(frozen=True, slots=True)
class _Raised:
    """The exception raised by a task; one that is a fault of rulec has become R0790."""

    error: RulecError


class _Done:
    """Marks the end of a task's results."""


@contextmanager
def _without_interrupts() -> Iterator[None]:
    """A block that delays Ctrl-C, and whose child processes never receive it.

    A terminal sends it to all of its processes; this one is to receive it and end the others.
    """
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


class _Worker(Generic[Task, Result]):
    """A process, and the number of the task it works on."""

    def __init__(self) -> None:
        # A forked process would inherit locks held by threads that it does not have.
        context = multiprocessing.get_context("spawn")
        self.connection, theirs = context.Pipe()
        # Long arguments would be written for ever if the process is killed before it reads them.
        self.process: BaseProcess = context.Process(target=_serve, args=(theirs,), daemon=True)
        self.process.start()
        theirs.close()
        self.number: int | None = None

    def begin(self, work: memoryview) -> None:
        """Send the pickled work. That the process is gone shows when it is given a task."""
        with suppress(OSError):
            self.connection.send_bytes(work)


class WorkerProcesses(Generic[Task, Result]):
    """Processes, and the results that wait for earlier tasks, by the number of their task."""

    def __init__(
        self,
        work: Callable[[Task], Iterator[Result]],
        tasks: Sequence[Task],
        jobs: int,
        lost: Callable[[Task, int | None], object],
    ) -> None:
        self._work = ForkingPickler.dumps((work, is_keeping()))
        self._tasks = tasks
        self._jobs = jobs
        self._lost = lost
        self._workers: list[_Worker[Task, Result]] = []
        self._next = 0
        self._again: deque[int] = deque()
        self._waiting: dict[int, deque[object]] = {}
        self._received: dict[int, int] = {}
        self._known: dict[int, int] = {}
        """Number of a repeated task -> how many results its first process sent."""
        # Starting it unblocks interrupts (Python 3.11): done before they are blocked for workers.
        resource_tracker.ensure_running()

    def results(self, number: int) -> Iterator[Result | LostTask]:
        """The results of a task; meanwhile those of later tasks are stored.

        Raises RulecError if the task does, R0790 for a fault of rulec.
        """
        while True:
            self._hand_out(number)
            waiting = self._waiting[number]
            while waiting:
                result = waiting.popleft()
                if isinstance(result, _Done):
                    del self._waiting[number]
                    return
                if isinstance(result, _Raised):
                    raise result.error
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
        """Give tasks to idle processes, repeated tasks first."""
        last = min(len(self._tasks), wanted + self._jobs * TASKS_AHEAD)
        while self._again or self._next < last:
            worker = next((each for each in self._workers if each.number is None), None)
            if worker is None:
                if len(self._workers) == self._jobs:
                    return
                worker = self._started()
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

    def _started(self) -> _Worker[Task, Result]:
        """Start all processes that are missing, and return one of them."""
        new: list[_Worker[Task, Result]] = []
        with _without_interrupts():
            for _ in range(self._jobs - len(self._workers)):
                new.append(_Worker())
                self._workers.append(new[-1])
        for worker in new:
            worker.begin(self._work)
        return new[0]

    def _receive(self, wanted: int) -> None:
        """Wait for results of any process, and take one from each process that has some."""
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
        """Record that a process is gone; its task is repeated once, then reported as lost."""
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


def _serve(connection: Connection) -> None:
    """Receive the work, and the parent process's cache; do tasks until the connection closes."""
    # Ending by an exception also cleans up what a task has started, such as its own processes.
    signal.signal(signal.SIGTERM, _leave)
    work: Callable[[object], Iterator[object]]
    cached: bool
    with suppress(EOFError, OSError):
        work, cached = connection.recv()
        with keeping(on=cached):
            _do_tasks(connection, work)


def _do_tasks(connection: Connection, work: Callable[[object], Iterator[object]]) -> NoReturn:
    while True:
        task = connection.recv()
        try:
            for result in work(task):
                connection.send(result)
        except OSError:
            raise
        except Exception as error:
            connection.send(_Raised(error if isinstance(error, RulecError) else fault_of(error)))
        connection.send(_Done())


def _leave(number: int, _: object) -> NoReturn:
    raise SystemExit(128 + number)
