"""The memory and the processor time of a call of the program, enforced by the operating system.

Programs that import rulec are left alone: they would end with it.
"""

from __future__ import annotations

import errno
import os
import signal
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import Final

try:
    import resource
except ImportError:
    _IN_BROWSER = True
else:
    _IN_BROWSER = False

from rulec.diagnostics import RulecError
from rulec.resource_limits import MEMORY, SECONDS, is_set
from rulec.resources import variable_set

HELD_A_BYTE: Final = 50
"""How many bytes may be held, beside the limit, for each byte of input after decompression."""

_GROWS = "RULEC_MEMORY_GROWS"
"""The environment variable that is set, for worker processes too, if the limit grows with input."""

_LOOK_S = 0.2

_allowed: dict[str, int] = {}
_exceeded: list[RulecError] = []


class TimeSpentError(BaseException):
    """The processor time of the whole call is spent: nothing may contain this."""

    def __init__(self, error: RulecError) -> None:
        self.error = error


@contextmanager
def enforced() -> Iterator[None]:
    """Enforce the limits in force while the block runs, here and in processes started meanwhile."""
    if _IN_BROWSER:
        yield
        return
    if is_set(MEMORY):
        # What it lacks when it is loaded ends the process, with the status of a violation
        import numpy  # noqa: F401
    before = resource.getrlimit(resource.RLIMIT_DATA)
    handler, seconds = signal.getsignal(signal.SIGALRM), SECONDS.value()
    is_timed = is_set(SECONDS)
    _exceeded[:] = [MEMORY.exceeded(None)]
    _allowed.clear()
    try:
        if (held := _held()) is not None:
            _allow(held + MEMORY.value())
        if is_timed:
            end_s, error = _used_s() + seconds, SECONDS.exceeded(None)
            signal.signal(signal.SIGALRM, lambda *_: _end_after(end_s, error))
            signal.setitimer(signal.ITIMER_REAL, _LOOK_S, _LOOK_S)
        with variable_set(_GROWS, "" if is_set(MEMORY) else "1"):
            yield
    finally:
        if is_timed:
            signal.setitimer(signal.ITIMER_REAL, 0)
            signal.signal(signal.SIGALRM, handler)
        resource.setrlimit(resource.RLIMIT_DATA, before)


def allow_for(file: str, n_bytes: int) -> None:
    """Allow the memory for so many bytes of a file, after decompression."""
    more = n_bytes - _allowed.get(file, 0)
    if more > 0 and os.environ.get(_GROWS):
        _allowed[file] = n_bytes
        soft, _ = resource.getrlimit(resource.RLIMIT_DATA)
        if soft != resource.RLIM_INFINITY:
            _allow(soft + HELD_A_BYTE * more)


def limit_error(problem: BaseException) -> RulecError | None:
    """The error for what an exhausted limit raised; None for anything else."""
    if isinstance(problem, TimeSpentError):
        return problem.error
    # Some libraries say nothing, or something else, when they lack memory
    is_memory = (
        isinstance(problem, MemoryError | SystemError)
        or (isinstance(problem, OSError) and problem.errno == errno.ENOMEM)
        or (isinstance(problem, ImportError) and "failed to map" in str(problem))
    )
    return _exceeded[0] if is_memory and _exceeded else None


def _allow(n_bytes: int) -> None:
    _, hard = resource.getrlimit(resource.RLIMIT_DATA)
    soft = n_bytes if hard == resource.RLIM_INFINITY else min(n_bytes, hard)
    resource.setrlimit(resource.RLIMIT_DATA, (soft, hard))


def _held() -> int | None:
    """The bytes that count for the limit; None where the system does not say, nor enforce it."""
    with suppress(OSError):
        pages = Path("/proc/self/statm").read_text(encoding="ascii").split()[5]
        return int(pages) * os.sysconf("SC_PAGE_SIZE")
    return None


def _end_after(end_s: float, error: RulecError) -> None:
    if _used_s() > end_s:
        raise TimeSpentError(error)


def _used_s() -> float:
    """The processor time (s) of this process and its children, of those that run now as well."""
    ended = os.times()
    ticks = sum(map(_ticks_of, _running(os.getpid())))
    return sum(ended[:4]) + ticks / os.sysconf("SC_CLK_TCK")


def _running(process: int) -> Iterator[int]:
    """The children of a process, and theirs."""
    with suppress(OSError):
        for file in Path(f"/proc/{process}/task").glob("*/children"):
            for child in map(int, file.read_text(encoding="ascii").split()):
                yield child
                yield from _running(child)


def _ticks_of(process: int) -> int:
    with suppress(OSError):
        # What follows the name, which may contain anything
        text = Path(f"/proc/{process}/stat").read_text(encoding="utf-8", errors="replace")
        return sum(map(int, text.rpartition(")")[2].split()[11:15]))
    return 0
