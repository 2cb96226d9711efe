"""Cache of the answers of a compiler's process, with the whole job as the key.

The key is the job, with formula, facts and remarks, and the compiler; so an unchanged rule is not
compiled again, whatever the command and rulebook. Only machines are kept, all of them proved, and
refusals that the job alone decides: neither time, nor memory, nor an error of the compiler.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

import msgspec

from rulec.automata.compiler_jobs import Done, Failed, FailedWhy, Job
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.automata.worker import compiler_choice
from rulec.cache.kept_bytes import KeptBytes

MOST_MACHINES = 6000
"""The greatest number kept; the longest unused go first. A large rulebook has 200 for one step."""


_DECIDED = ("letters", "steps", "size", "sets", "reach")


class KeptMachine(msgspec.Struct, array_like=True):
    """A job's machine without its reads, its automaton as text, and Spot's version."""

    spot: str
    letters: tuple[int, ...]
    successors: tuple[tuple[int, ...], ...]
    outputs: tuple[tuple[bool, ...], ...]
    rejecting_sink: int | None
    accepting_sink: int | None
    hoa: str


class KeptRefusal(msgspec.Struct, array_like=True):
    """Why a job has no machine, and Spot's version."""

    spot: str
    why: FailedWhy


class MachineCache:
    """The known answers to jobs of one compiler."""

    def __init__(self, choice: str) -> None:
        self._kept = KeptBytes("machine", MOST_MACHINES)
        self._compiler = f"{choice} {_installed()}" if self._kept.can_be else None

    def recalled(self, jobs: Sequence[Job]) -> tuple[list[Done | Failed | None], str | None]:
        """The answer to each job, and Spot's version; each None if unknown."""
        answers: list[Done | Failed | None] = []
        spot = None
        for job in jobs:
            kept = self._recalled(job)
            spot = spot if kept is None else kept.spot
            answer = Failed(kept.why) if isinstance(kept, KeptRefusal) else None
            answers.append(_done(job, kept) if isinstance(kept, KeptMachine) else answer)
        return answers, spot

    def _recalled(self, job: Job) -> KeptMachine | KeptRefusal | None:
        data = None if self._compiler is None else self._kept.recall(self._key(job))
        if data is not None:
            with suppress(ValueError):  # the base class of msgspec's errors
                return msgspec.msgpack.decode(data, type=KeptMachine)
            with suppress(ValueError):
                refusal = msgspec.msgpack.decode(data, type=KeptRefusal)
                return refusal if refusal.why in _DECIDED else None
        return None

    def keep(self, jobs: Sequence[Job], answers: Sequence[Done | Failed | None], spot: str) -> None:
        """Keep the machines among the answers to some jobs, and the refusals."""
        if self._compiler is None:
            return
        contents = {}
        for job, answer in zip(jobs, answers, strict=True):
            if isinstance(answer, Done) and answer.machine.reads == job.reads:
                contents[self._key(job)] = msgspec.msgpack.encode(_kept(answer, spot))
            elif isinstance(answer, Failed) and answer.why in _DECIDED:
                contents[self._key(job)] = msgspec.msgpack.encode(KeptRefusal(spot, answer.why))
        self._kept.keep(contents)

    def _key(self, job: Job) -> str:
        # The repr of a job shows everything except places in files.
        return self._kept.key(str(self._compiler), repr(job))


def _installed() -> str:
    """Identifies the installed Spot; another release has another path, time or size."""
    spec = find_spec(compiler_choice.SPOT)
    if spec is None or spec.origin is None:
        return ""
    try:
        status = Path(spec.origin).stat()
    except OSError:
        return spec.origin
    return f"{spec.origin} {status.st_mtime_ns} {status.st_size}"


def _kept(answer: Done, spot: str) -> KeptMachine:
    machine = answer.machine
    tables = machine.letters, machine.successors, machine.outputs
    return KeptMachine(spot, *tables, machine.rejecting_sink, machine.accepting_sink, answer.hoa)


def _done(job: Job, kept: KeptMachine) -> Done:
    machine = MealyMonitor(
        job.reads,
        kept.letters,
        kept.successors,
        kept.outputs,
        rejecting_sink=kept.rejecting_sink,
        accepting_sink=kept.accepting_sink,
    )
    return Done(machine, kept.hoa)
