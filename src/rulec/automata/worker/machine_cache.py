"""Cache of the answers of a compiler's process, with the whole job as the key.

The key is the job, with formula, facts and remarks, and the compiler; so an unchanged rule is not
compiled again, whatever the command and rulebook. Only machines are kept, all of them proved, and
refusals that the job alone decides: neither time, nor memory, nor an error of the compiler.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

from rulec.automata.bundle.stored_rulebook import MACHINE_KINDS
from rulec.automata.clocks.clocked_machine import ClockedMachine
from rulec.automata.compiler_jobs import Done, Failed, Job
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.worker import compiler_choice
from rulec.automata.worker.clocked_jobs import Answer
from rulec.cache.kept_bytes import KeptBytes
from rulec.cache.stored_objects import KeptObjects, ObjectCodec, kinds_of_fields

MOST_MACHINES = 6000
"""The greatest number kept; the longest unused go first. A large rulebook has 200 for one step."""

_DECIDED = ("letters", "size", "sets", "reach", "apart")


@dataclass(frozen=True, slots=True)
class KeptJob:
    """The answer to a job, and Spot's version."""

    spot: str
    answer: Done | ClockedMachine | Failed


_MACHINES = KeptObjects(
    KeptBytes("machine", MOST_MACHINES),
    ObjectCodec({**MACHINE_KINDS, **kinds_of_fields((KeptJob, Done, Failed))}),
)


class MachineCache:
    """The known answers to jobs of one compiler."""

    def __init__(self, choice: str) -> None:
        self._compiler = f"{choice} {_installed()}" if _MACHINES.files.can_be else None

    def recalled(self, jobs: Sequence[Job]) -> tuple[list[Answer], str | None]:
        """The answer to each job, and Spot's version; each None if unknown."""
        known = [self._recalled(job) for job in jobs]
        spots = [kept.spot for kept in known if kept is not None]
        answers: list[Answer] = [None if kept is None else kept.answer for kept in known]
        return answers, spots[-1] if spots else None

    def _recalled(self, job: Job) -> KeptJob | None:
        if self._compiler is None:
            return None
        kept = _MACHINES.recall(self._key(job))
        return kept if isinstance(kept, KeptJob) else None

    def keep(self, jobs: Sequence[Job], answers: Sequence[Answer], spot: str) -> None:
        """Keep the machines among the answers to some jobs, and the refusals."""
        if self._compiler is None:
            return
        contents: dict[str, object] = {}
        for job, answer in zip(jobs, answers, strict=True):
            if isinstance(answer, Done | ClockedMachine) and _reads(answer) == job.reads:
                contents[self._key(job)] = KeptJob(spot, answer)
            elif isinstance(answer, Failed) and answer.why in _DECIDED:
                contents[self._key(job)] = KeptJob(spot, Failed(answer.why))
        _MACHINES.keep(contents)

    def _key(self, job: Job) -> str:
        # The repr of a job shows everything except places in files.
        return _MACHINES.files.key(str(self._compiler), repr(job))


def _reads(answer: Done | ClockedMachine) -> tuple[Read | NumberRead, ...]:
    return answer.machine.reads if isinstance(answer, Done) else answer.reads


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
