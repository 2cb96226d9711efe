"""Start of the program, with signals prepared before the other imports."""

from __future__ import annotations

# Python has these two when it begins; `signal` and what it imports take 2 ms.
import _signal  # type: ignore[import-not-found]
import os


def _interrupted(number: int, _: object) -> None:
    os._exit(128 + number)


if _signal.getsignal(_signal.SIGINT) is _signal.default_int_handler:
    # Wherever Ctrl-C comes while modules are imported: no traceback.
    _signal.signal(_signal.SIGINT, _interrupted)

# Products of matrices are small here, and processes take the processors: threads of numpy's library
# for them would take 20 ms of each start, and wait for each other ever after.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

# ruff: noqa: E402 - what is above comes first
import atexit
import gc
import signal
import sys
from io import TextIOWrapper
from types import FrameType
from typing import TYPE_CHECKING, TextIO

from rulec.cli.interruption import interrupt, is_interrupted
from rulec.version import __version__

if TYPE_CHECKING:
    from sys import UnraisableHookArgs


def run() -> int:
    """Run the command line as a process, and end the process with its exit status.

    The status is returned where somebody watches the process from within, such as a profiler.
    """
    status = _run()
    if not (sys.getprofile() or sys.gettrace() or sys.flags.interactive or sys.flags.dev_mode):
        _end(status)
    return status


def _run() -> int:
    try:
        _prepare()
        if sys.argv[1:] == ["--version"] and _printed_version():
            return 0
        # click and the diagnostics, 30 ms: not for `rulec --version`, and after signals are set.
        from rulec.cli.dataclass_methods import write_when_called

        write_when_called()  # before any module that has dataclasses
        from rulec.cli.main import main

        return main()
    except BaseException as problem:
        # Of modules that are imported, some make errors of their own of an interrupt.
        if isinstance(problem, KeyboardInterrupt) or is_interrupted():
            return 128 + signal.SIGINT
        raise
    finally:
        if signal.getsignal(signal.SIGINT) is interrupt:
            # All is done, and whatever Python does at its end is not for tracebacks either.
            signal.signal(signal.SIGINT, _interrupted)
        for stream in (sys.stdout, sys.stderr):
            _let_go_of(stream)
        if signal.getsignal(signal.SIGINT) is _interrupted:
            # When Python ends it gives signals back to the system, which would kill what is done.
            signal.signal(signal.SIGINT, signal.SIG_IGN)


# Python 3.11 keeps frames in pieces of 16 kB, and gives each back to the system once it is empty.
# Where a loop's calls happen to begin a new piece, each of them takes 10 µs more. Beside a frame
# that says it needs a megabyte, which nobody touches, there is room for those of all it calls.
run.__code__ = run.__code__.replace(co_stacksize=1 << 17)


def _end(status: int) -> None:
    """End the process as Python does, but without taking all objects apart, a tenth of a start."""
    if "threading" in sys.modules:
        # Waits for threads, and for what they have been given to do.
        sys.modules["threading"]._shutdown()
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        _let_go_of(stream)
    os._exit(status)


def _prepare() -> None:
    for number in (signal.SIGTERM, signal.SIGHUP):
        # Unless it is ignored, as under nohup: end so that what is half done is cleaned up.
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, _leave)
    # A closed standard stream is None.
    sys.stdin = sys.stdin or open(os.devnull)  # noqa: SIM115, PTH123 - open for good
    sys.stdout = sys.stdout or open(os.devnull, "w")  # noqa: SIM115, PTH123
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: SIM115, PTH123
    for stream in (sys.stdout, sys.stderr):
        # A file's name may hold what the terminal's encoding does not.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    # Traces are many objects without cycles, which need not be looked through so often; nor need
    # what a start makes, which stays.
    gc.set_threshold(400_000)
    if hasattr(sys, "set_int_max_str_digits"):
        # Exact counts are long: at most a few digits for each of the 10,000 layers of a graph.
        sys.set_int_max_str_digits(100_000)
    sys.unraisablehook = _unraisable
    if signal.getsignal(signal.SIGINT) is _interrupted:
        signal.signal(signal.SIGINT, interrupt)


def _unraisable(problem: UnraisableHookArgs) -> None:
    """Interrupt again what was interrupted where nothing can be raised, such as in a finalizer."""
    if not issubclass(problem.exc_type, KeyboardInterrupt):
        sys.__unraisablehook__(problem)
        return
    # 3 ms: only if that happens.
    from threading import Timer, get_ident

    # Not at once, since this is such a place, too.
    Timer(0.01, signal.pthread_kill, (get_ident(), signal.SIGINT)).start()


def _printed_version() -> bool:
    """Print the version, without the imports of ``main``, and report success.

    What cannot be written is left to ``main``, which knows what to say of that.
    """
    try:
        sys.stdout.write(f"rulec {__version__}\n")
        sys.stdout.flush()
    except OSError:
        return False
    return True


def _let_go_of(stream: TextIO) -> None:
    """Flush a stream, or redirect it lest Python retry at exit."""
    try:
        stream.flush()
    except OSError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())


def _leave(number: int, _: FrameType | None) -> None:
    raise SystemExit(128 + number)
