"""Other libraries, each in an environment of its own, as processes that work when told to."""

from __future__ import annotations

import json
import subprocess
import sys
from collections.abc import Iterator, Mapping
from contextlib import ExitStack, contextmanager
from pathlib import Path
from typing import Any

from timing import Timed

PINNED = {
    "rtamt": "0.4.10",
    "flloat": "0.3.0",
    "reelay": "25.0.0",
    "commonroad-io": "2026.1",
}
"""Versions. flloat brings a module that overwrites lark's, rtamt an old antlr: hence the walls."""

PROGRAMS = Path(__file__).with_name("peers")
ENVIRONMENTS = Path(sys.prefix) / "peers"


class NoPeerError(Exception):
    """A library cannot be had here; says why."""


class Peer:
    """A program under ``peers/``, at work on one job."""

    def __init__(self, process: subprocess.Popen[str]) -> None:
        self._process = process

    def round(self) -> tuple[float, Any]:
        """Do the work once: nanoseconds of processor time, and the answer."""
        assert self._process.stdin is not None
        assert self._process.stdout is not None
        self._process.stdin.write("\n")
        self._process.stdin.flush()
        line = self._process.stdout.readline()
        if not line:
            raise RuntimeError(f"{self._process.args} ended with status {self._process.wait()}")
        taken, answer = json.loads(line)
        return taken, answer

    def timed(self, units: float) -> Timed:
        """Nanoseconds for each of so many units of its work."""
        return lambda: self.round()[0] / units


@contextmanager
def peers(job: Any, programs: Mapping[str, str]) -> Iterator[tuple[dict[str, Peer], list[str]]]:
    """The libraries' programs at work on a job, and why those that are missing are missing."""
    there, notes = {}, []
    with ExitStack() as stack:
        for library, program in programs.items():
            try:
                python = environment(library)
            except NoPeerError as problem:
                notes.append(f"{named(library)} could not be installed: {problem}")
                continue
            process = subprocess.Popen(
                [python, PROGRAMS / f"{program}.py"],
                stdin=subprocess.PIPE,
                stdout=subprocess.PIPE,
                text=True,
            )
            stack.enter_context(process)
            stack.callback(process.kill)
            assert process.stdin is not None
            process.stdin.write(json.dumps(job) + "\n")
            there[named(library)] = Peer(process)
        yield there, notes


def named(library: str) -> str:
    """A library with its version."""
    return f"{library} {PINNED[library]}"


def environment(library: str) -> Path:
    """The Python of the library's environment, which is made if it is not there.

    It goes where rulec's own environment is, and with it. Raises NoPeerError.
    """
    folder = ENVIRONMENTS / f"{library}-{PINNED[library]}"
    python = folder / "bin" / "python"
    complete = folder / "complete"
    if not complete.exists():
        print(f"making an environment for {named(library)} ...", file=sys.stderr)
        _run([sys.executable, "-m", "venv", "--clear", folder])
        _run([python, "-m", "pip", "install", "--quiet", f"{library}=={PINNED[library]}"])
        complete.touch()
    return python


def _run(command: list[Any]) -> None:
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        said = (done.stderr or done.stdout).strip().splitlines()
        raise NoPeerError(said[-1] if said else f"status {done.returncode}")
