"""One command after another, in this process: what each came to, how long it took."""

import contextlib
import io
import os
import re
import resource
import shutil
import signal
import sys
import tempfile
import time
import warnings
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from random import Random

from rulec.cli.main import main
from rulec.diagnostics.fault_messages import FAULT
from support.fuzz.targets import STANDARD_INPUT, TARGETS, Workplace

STATUSES = {0, 1, 2}
LONGEST_S = 10
LONGEST_S_OF_ALL_PAIRS = 120
"""``diff --all`` of all books compares 11,000 pairs of rules; a terminal shows how far it is."""
LONGEST_WAIT_S = 600
REFUSALS = ("R0401", "R0718")
"""Who asks for more than a limit is told which; it may take longer until that is known."""
MOST_MIB = 2 << 10
COMMANDS = re.compile(r"^::(?!error |warning |notice )", re.MULTILINE)
"""What a runner of workflows would obey, but for annotations."""
WARNINGS = re.compile(r"^.*:\d+: \w*Warning: .*$", re.MULTILINE)
"""What Python says itself, of places in its modules."""
CONTROLS = re.compile(r"[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\u2066-\u2069]")


class HangError(BaseException):
    """A command took too long: no ``except Exception`` holds it up."""


@dataclass
class FuzzTrial:
    """What came of some inputs of a target: failures by seed, the longest time and its seed."""

    target: str
    inputs: int = 0
    statuses: dict[int, int] = field(default_factory=dict)
    failures: dict[int, str] = field(default_factory=dict)
    longest_s: float = 0.0
    longest: int | None = None
    peak_mib: int = 0


def tried(target, folder, seeds, seconds=None):
    """A trial of a target; after so many seconds it ends early, what it begins with apart."""
    trial = FuzzTrial(target)
    shutil.copytree(_filled().name, folder, dirs_exist_ok=True)
    place = Workplace(folder)
    before = _peak_mib(begin=True)
    started = time.monotonic()
    for seed in seeds:
        if seconds is not None and time.monotonic() >= started + seconds:
            break
        _try_one(trial, place, seed)
    trial.peak_mib = _peak_mib() - before
    assert trial.peak_mib < MOST_MIB, f"{target}: {trial.peak_mib} MiB"
    return trial


def _peak_mib(*, begin=False):
    """The most memory that this process has had since a beginning, which other tests preceded."""
    if begin:
        with contextlib.suppress(OSError):  # then the peak before is subtracted instead
            Path("/proc/self/clear_refs").write_text("5")
    status = Path("/proc/self/status").read_text()
    return int(re.search(r"^VmHWM:\s+(\d+) kB$", status, re.MULTILINE)[1]) >> 10


def _workers_s():
    """The processor time (s) of the processes that this one has started, where Linux tells it."""
    ended = resource.getrusage(resource.RUSAGE_CHILDREN)
    taken, waiting = ended.ru_utime + ended.ru_stime, [os.getpid()]
    for pid in waiting:
        # A process may end while it is looked at.
        with contextlib.suppress(OSError):
            begun = [x.read_text() for x in Path(f"/proc/{pid}/task").glob("*/children")]
            waiting += [int(child) for text in begun for child in text.split()]
            if pid != os.getpid():
                fields = Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()
                taken += sum(map(int, fields[11:15])) / os.sysconf("SC_CLK_TCK")
    return taken


@cache
def _filled():
    """A folder with sound files: they are made once for all targets."""
    folder = tempfile.TemporaryDirectory()
    with _quiet():
        Workplace(Path(folder.name)).fill()
    return folder


def _try_one(trial, place, seed):
    words = TARGETS[trial.target](place, Random(seed))
    started, workers_s = time.monotonic(), _workers_s()
    status, problem = None, ""
    file = place.folder / STANDARD_INPUT
    typed = file.read_bytes() if file.exists() else b'{"b": ["v"]}\n'
    with _quiet(typed) as streams, _in(place.folder), warnings.catch_warnings():
        # Else each place is warned of once in a process, and the first command would say it all.
        for kind in (RuntimeWarning, UserWarning):
            warnings.simplefilter("always", kind)
        # Others may have the machine: it is processor time that counts, and an end of all waiting.
        signal.signal(signal.SIGPROF, _hang)
        signal.signal(signal.SIGALRM, _wait)
        signal.setitimer(
            signal.ITIMER_PROF, LONGEST_S_OF_ALL_PAIRS if "--all" in str(words) else LONGEST_S
        )
        signal.alarm(LONGEST_WAIT_S)
        try:
            status = int(words() if callable(words) else main(words))
        except HangError as error:
            problem = str(error)
        except BaseException as error:
            problem = f"{type(error).__name__}: {error}"
        finally:
            signal.setitimer(signal.ITIMER_PROF, 0)
            signal.alarm(0)
    said = "".join(stream.getvalue() for stream in streams)
    workers_s = _workers_s() - workers_s
    if not problem and workers_s > LONGEST_S and "--all" not in str(words):
        refused = any(f"[{code}]" in said for code in REFUSALS)
        problem = "" if refused else f"workers took {workers_s:.0f} s of processor time"
    trial.inputs += 1
    took_s = time.monotonic() - started
    if took_s > trial.longest_s:
        trial.longest_s, trial.longest = took_s, seed
    if status is not None:
        trial.statuses[status] = trial.statuses.get(status, 0) + 1
    if not problem and status not in STATUSES:
        problem = f"status {status}: {said[-300:]}"
    if not problem and f"[{FAULT.code}]" in streams[1].getvalue():
        problem = f"a fault of rulec: {said[-300:]}"
    if not problem and "Traceback" in said:
        problem = f"a traceback: {said[-300:]}"
    if not problem and (found := WARNINGS.search(streams[1].getvalue())):
        problem = f"a warning of Python: {found[0]}"
    # Files of rulec's own are quoted as they are, on standard output alone
    if not problem and (found := COMMANDS.search(said) or CONTROLS.search(streams[1].getvalue())):
        problem = f"{found[0]!r} goes out: {said[max(0, found.start() - 100) :][:200]!r}"
    if problem:
        trial.failures[seed] = f"{words}: {problem}"[:1000]


@contextlib.contextmanager
def _in(folder):
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def _hang(*_):
    message = "still at it after the processor time that it may take"
    raise HangError(message)


def _wait(*_):
    message = f"no answer after {LONGEST_WAIT_S} s"
    raise HangError(message)


class _Text(io.TextIOWrapper):
    """Standard output that is kept."""

    def __init__(self):
        super().__init__(io.BytesIO(), encoding="utf-8", errors="surrogateescape", newline="")
        # What is sent past Python goes nowhere.
        self._file = open(os.devnull, "wb")  # noqa: SIM115, PTH123

    def fileno(self):
        """A file of its own."""
        return self._file.fileno()

    def end(self):
        """Close the file; what was written stays."""
        self._file.close()

    def getvalue(self):
        """What was written."""
        self.flush()
        return self.buffer.getvalue().decode("utf-8", "replace")


@contextlib.contextmanager
def _quiet(typed=b""):
    before = sys.stdout, sys.stderr, sys.stdin
    streams = _Text(), _Text()
    sys.stdout, sys.stderr = streams
    sys.stdin = io.TextIOWrapper(io.BytesIO(typed), encoding="utf-8")
    try:
        yield streams
    finally:
        sys.stdout, sys.stderr, sys.stdin = before
        for stream in streams:
            stream.end()


def summary(trial):
    """One line on a trial, and one for each failure."""
    came = ", ".join(f"{count} of status {key}" for key, count in sorted(trial.statuses.items()))
    head = (
        f"{trial.target}: {trial.inputs:,} inputs, {came}; "
        f"longest {trial.longest_s:.2f} s ({trial.longest}), at most {trial.peak_mib:,} MiB"
    )
    return "\n".join([head, *(f"  {seed}: {said}" for seed, said in trial.failures.items())])
