"""Cache of what a compiler's process has answered, by the whole of what it was asked.

The key is the job, formula, facts and remarks included, and the compiler; so a rule of which
nothing has changed is not compiled again, by whatever command and in whatever rulebook. Only
machines are kept, all of which have been proved. Those of shipped rulebooks ship with them.
"""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import suppress
from importlib.util import find_spec
from pathlib import Path

import msgspec

from rulec.automata.compiler_jobs import Done, Failed, Job
from rulec.automata.mealy_monitor import MealyMonitor
from rulec.automata.worker import compiler_choice
from rulec.cache.keeping import knows_shipped
from rulec.cache.kept_bytes import KeptBytes
from rulec.cache.shipped_bytes import ShippedBytes, shipped, shipped_key

MOST_MACHINES = 6000
"""So many are kept; those longest unused go first. A large rulebook has 200 for a step."""


SHIPPED = "machine"
MAKERS = (
    *("automata/spot_bridge", "automata/decision_diagrams"),
    *(f"logic/{name}.py" for name in ("formula", "fold", "bounds", "past_registers", "semantics")),
    *(f"automata/worker/{name}.py" for name in ("job_answers", "machine_cache")),
    *(f"automata/{name}.py" for name in ("alphabet", "compiler_jobs")),
    *(f"automata/{name}.py" for name in ("guards", "mealy_monitor", "tables", "thresholds")),
)
"""The kind of what ships, and the code that it comes from."""


class KeptMachine(msgspec.Struct, array_like=True):
    """A machine and its automaton, as text; of a job, which has its reads; and Spot's version."""

    spot: str
    letters: tuple[int, ...]
    successors: tuple[tuple[int, ...], ...]
    outputs: tuple[tuple[bool, ...], ...]
    rejecting_sink: int | None
    accepting_sink: int | None
    hoa: str


class MachineCache:
    """The machines of jobs that a compiler is given, as far as they are known."""

    def __init__(self, choice: str) -> None:
        self._kept = KeptBytes("machine", MOST_MACHINES)
        self._compiler = f"{choice} {_installed()}" if self._kept.can_be else None
        # Who chooses a compiler gets what it makes, and who has no Spot what the other one makes.
        is_usual = not compiler_choice.choice() and (choice or find_spec(compiler_choice.SPOT))
        self._shipped = (
            shipped(SHIPPED, MAKERS) if knows_shipped() and is_usual else ShippedBytes({})
        )
        self._choice = choice

    def recalled(self, jobs: Sequence[Job]) -> tuple[list[Done | None], str | None]:
        """The answer to each job, None where it is not known; and Spot's version, None likewise."""
        answers: list[Done | None] = []
        spot = None
        for job in jobs:
            kept = self._recalled(job)
            answers.append(None if kept is None else _done(job, kept))
            spot = spot if kept is None else kept.spot
        return answers, spot

    def _recalled(self, job: Job) -> KeptMachine | None:
        data = self._shipped.recall(machine_key(self._choice, job))
        if data is None and self._compiler is not None:
            data = self._kept.recall(self._key(job))
        if data is not None:
            with suppress(ValueError):  # what msgspec says is one
                return msgspec.msgpack.decode(data, type=KeptMachine)
        return None

    def keep(self, jobs: Sequence[Job], answers: Sequence[Done | Failed | None], spot: str) -> None:
        """Keep the machines among the answers to some jobs."""
        if self._compiler is None:
            return
        contents = {}
        for job, answer in zip(jobs, answers, strict=True):
            if isinstance(answer, Done) and answer.machine.reads == job.reads:
                contents[self._key(job)] = as_bytes(answer, spot)
        self._kept.keep(contents)

    def _key(self, job: Job) -> str:
        # What is shown of a job is all of it but for places in files.
        return self._kept.key(str(self._compiler), repr(job))


def machine_key(choice: str, job: Job) -> bytes:
    """Under which the answer to a job ships; an empty choice is the usual one, Spot."""
    return shipped_key(choice or compiler_choice.SPOT, repr(job))


def as_bytes(answer: Done, spot: str, *, with_text: bool = True) -> bytes:
    """A machine as it is kept, with the version of Spot that made it, and its automaton as text."""
    kept = _kept(answer, spot)
    return msgspec.msgpack.encode(kept if with_text else msgspec.structs.replace(kept, hoa=""))


def _installed() -> str:
    """Which Spot there is; another release is another file, or of another time."""
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
