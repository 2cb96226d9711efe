"""Work in several processes: the order of results, what is lost, and what is left behind."""

import os
import signal
import time
from functools import partial
from multiprocessing import resource_tracker, util

import pytest

from rulec.batch import worker_processes
from rulec.batch.batch_messages import process_lost
from rulec.batch.jobs import Jobs, LostTask, available_processors, chosen_jobs
from rulec.batch.worker_pool import in_order
from rulec.cache.keeping import is_keeping, keeping
from rulec.diagnostics import RulecError


def squares(most, number):
    """So many results for each number; the first number takes the longest."""
    if number == 0:
        time.sleep(0.3)
    for k in range(most):
        yield number * number + k


def none(_):
    return iter(())


def die(number):
    yield "begun"
    if number == 1:
        os.kill(os.getpid(), signal.SIGKILL)
    yield "done"


def die_once(marker, number):
    """The middle of three tasks is killed behind its second result, the first time."""
    yield "begun"
    yield "half"
    if number == 1 and not marker.exists():
        marker.touch()
        os.kill(os.getpid(), signal.SIGKILL)
    yield "done"


def process(_):
    yield os.getpid()


def longer(text, number):
    yield len(text) + number


def fail(number):
    yield "begun"
    if number == 1:
        raise ValueError("a mistake of the program's")


@pytest.mark.parametrize("jobs", [Jobs(1), Jobs(2), Jobs(2, alone_s=60.0)])
def test_results_are_in_the_order_of_the_tasks(jobs):
    told = []
    found = list(in_order(partial(squares, 3), range(5), jobs, told.append))
    assert found == [(n, n * n + k) for n in range(5) for k in range(3)]
    assert told == [1, 2, 3, 4, 5]


def test_more_results_than_may_wait(monkeypatch):
    monkeypatch.setattr(worker_processes, "MOST_WAITING", 2)
    found = list(in_order(partial(squares, 40), range(4), Jobs(3)))
    assert found == [(n, n * n + k) for n in range(4) for k in range(40)]


def test_tasks_without_results():
    assert list(in_order(none, range(3), Jobs(2))) == []
    assert list(in_order(none, [], Jobs(2))) == []


def test_small_work_starts_no_process():
    assert {pid for _, pid in in_order(process, range(3), Jobs(2, alone_s=60.0))} == {os.getpid()}
    assert {pid for _, pid in in_order(process, range(1), Jobs(2))} == {os.getpid()}
    assert os.getpid() not in {pid for _, pid in in_order(process, range(2), Jobs(2))}


def test_jobs_are_as_many_as_this_process_may_use(monkeypatch):
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: {0, 2, 5})
    assert available_processors() == 3
    assert chosen_jobs(0) == Jobs(3)
    assert chosen_jobs(7) == Jobs(7)
    assert chosen_jobs(None).processes == 3
    assert chosen_jobs(None).alone_s > 0


def test_a_task_whose_process_is_killed_is_done_again(tmp_path):
    lost = []
    work = partial(die_once, tmp_path / "marker")
    found = list(in_order(work, range(3), Jobs(2), lost=lambda *about: lost.append(about)))
    assert found == [(n, word) for n in range(3) for word in ("begun", "half", "done")]
    assert lost == [(1, signal.SIGKILL)]


def test_a_process_that_is_killed_twice_loses_its_task_alone():
    found = list(in_order(die, range(3), Jobs(2)))
    assert found == [
        (0, "begun"),
        (0, "done"),
        (1, "begun"),
        (1, LostTask(signal.SIGKILL)),
        (2, "begun"),
        (2, "done"),
    ]


def test_a_process_that_is_killed_before_it_reads_anything_is_replaced(monkeypatch):
    """However much it would have to read."""
    start, started = util.spawnv_passfds, []

    def killed_at_once(*arguments):
        started.append(start(*arguments))
        if len(started) == 1:
            os.kill(started[0], signal.SIGKILL)
        return started[-1]

    resource_tracker.ensure_running()  # which is started in the same way
    monkeypatch.setattr(util, "spawnv_passfds", killed_at_once)
    lost = []
    work = partial(longer, b" " * 1_000_000)
    found = list(in_order(work, range(3), Jobs(2), lost=lambda *about: lost.append(about)))
    assert found == [(n, 1_000_000 + n) for n in range(3)]
    assert lost == [(0, signal.SIGKILL)]
    assert len(started) == 3


def test_a_mistake_is_raised_where_it_belongs():
    found = []
    with pytest.raises(RulecError, match=r"ValueError a mistake of the program's.*R0790"):
        found += (one for one in in_order(fail, range(3), Jobs(2)))


def test_no_process_stays_behind_when_the_caller_leaves():
    pools = []

    class Noted(worker_processes.WorkerProcesses):
        def __init__(self, *arguments):
            super().__init__(*arguments)
            pools.append(self)

    results = in_order(partial(squares, 3), range(9), Jobs(2))
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(worker_processes, "WorkerProcesses", Noted)
        assert next(results) == (0, 0)
        results.close()
    (pool,) = pools
    assert [worker.process.is_alive() for worker in pool._workers] == [False, False]


def test_a_lost_process_is_said_of_its_file():
    """Memory that is used up cannot be tried; the code is R0708."""
    (found,) = process_lost("long.xml", signal.SIGKILL).diagnostics
    assert (found.code, found.place.file) == ("R0708", "long.xml")
    assert "by signal 9" in found.message


def _recalls(_):
    yield is_keeping()


@pytest.mark.parametrize("what", [True, False])
def test_what_is_recalled_here_is_recalled_there(what):
    with keeping(on=what):
        results = [result for _, result in in_order(_recalls, range(2), Jobs(2))]
    assert results == [what, what]
