"""Start of the program: signal handlers are set before the other imports."""

from __future__ import annotations

# Python loads these two at its start; `signal` and its imports take 2 ms.
import _signal  # type: ignore[import-not-found]
import os


def _interrupted(number: int, _: object) -> None:
    os._exit(128 + number)


if _signal.getsignal(_signal.SIGINT) is _signal.default_int_handler:
    # Ctrl-C during imports must not print a traceback.
    _signal.signal(_signal.SIGINT, _interrupted)

# Matrix products are small here, and worker processes occupy the processors: NumPy's threads for
# them would add 20 ms to each start, and later only wait for each other.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
# Arrow's own pools of memory reserve a gigabyte, whatever is read.
os.environ.setdefault("ARROW_DEFAULT_MEMORY_POOL", "system")

# ruff: noqa: E402 - what is above comes first
import atexit
import gc
import signal
import sys
from io import TextIOWrapper
from types import FrameType
from typing import TYPE_CHECKING, TextIO

from rulec.cli import lazy_imports as lazy
from rulec.cli.interruption import interrupt, is_interrupted
from rulec.version import __version__

if TYPE_CHECKING:
    from sys import UnraisableHookArgs


_leaving: list[int] = []
"""The signals that have ended the program."""


def run() -> int:
    """Run the command line as a process, and end the process with its exit status.

    The status is returned if a tool such as a profiler observes the process from within.
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
        return lazy.main.main()
    except BaseException as problem:
        # Some imported modules turn an interrupt into errors of their own.
        if isinstance(problem, KeyboardInterrupt) or is_interrupted():
            return 128 + signal.SIGINT
        raise
    finally:
        if signal.getsignal(signal.SIGINT) is interrupt:
            # The work is done, and Ctrl-C while Python shuts down must not print a traceback.
            signal.signal(signal.SIGINT, _interrupted)
        for stream in (sys.stdout, sys.stderr):
            _let_go_of(stream)
        if signal.getsignal(signal.SIGINT) is _interrupted:
            # At exit Python restores the default handler, so Ctrl-C would kill a finished program.
            signal.signal(signal.SIGINT, signal.SIG_IGN)


# Python 3.11 allocates frames in chunks of 16 kB, and frees each chunk once it is empty. If calls
# in a loop happen to begin a new chunk, each takes 10 µs more. This frame claims to need a
# megabyte, which is never touched, so that its chunk has room for the frames of all it calls.
run.__code__ = run.__code__.replace(co_stacksize=1 << 17)


def _end(status: int) -> None:
    """End the process like Python, but without freeing all objects: a tenth of a start."""
    if "threading" in sys.modules:
        # Waits for threads and their pending work.
        sys.modules["threading"]._shutdown()
    atexit._run_exitfuncs()
    for stream in (sys.stdout, sys.stderr):
        _let_go_of(stream)
    os._exit(status)


def _prepare() -> None:
    for number in (signal.SIGTERM, signal.SIGHUP):
        # Exit with cleanup of unfinished work, unless the signal is ignored, as under nohup.
        if signal.getsignal(number) is signal.SIG_DFL:
            signal.signal(number, _leave)
    # A closed standard stream is None. An answer that cannot be written is an error, as if stdout
    # were there and refused it.
    sys.stdin = sys.stdin or open(os.devnull)  # noqa: SIM115, PTH123 - open for good
    sys.stdout = sys.stdout or open(os.open(os.devnull, os.O_RDONLY), "w")  # noqa: SIM115, PTH123
    sys.stderr = sys.stderr or open(os.devnull, "w")  # noqa: SIM115, PTH123
    for stream in (sys.stdout, sys.stderr):
        # File names may have characters that the terminal's encoding lacks.
        if isinstance(stream, TextIOWrapper):
            stream.reconfigure(errors="backslashreplace")
    # Fewer garbage collections: traces are many objects without cycles, and the objects made at the
    # start are permanent.
    gc.set_threshold(400_000)
    if hasattr(sys, "set_int_max_str_digits"):
        # Exact counts are long: up to a few digits for each of the 10,000 layers of a graph.
        sys.set_int_max_str_digits(100_000)
    sys.unraisablehook = _unraisable
    if signal.getsignal(signal.SIGINT) is _interrupted:
        signal.signal(signal.SIGINT, interrupt)


def _unraisable(problem: UnraisableHookArgs) -> None:
    """Repeat a signal that came where nothing can be raised, such as in a finalizer."""
    if issubclass(problem.exc_type, KeyboardInterrupt):
        number = int(signal.SIGINT)
    elif _leaving and issubclass(problem.exc_type, SystemExit):
        number = _leaving[-1]
    else:
        # What is left when the program is ended may be unfinished.
        if not _leaving:
            sys.__unraisablehook__(problem)
        return
    # Delayed, since nothing can be raised here either; on a busy machine not for long enough.
    for delay_s in (0.01, 0.1, 1.0):
        try:
            lazy.Timer(delay_s, signal.pthread_kill, (lazy.get_ident(), number)).start()
        except (KeyboardInterrupt, SystemExit):
            continue
        return


def _printed_version() -> bool:
    """Print the version, without the imports of ``main``, and report success.

    Errors of writing are left to ``main``, which has messages for them.
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
    _leaving.append(number)
    raise SystemExit(128 + number)
