"""Machines that Spot has built, kept for the other tests of a run, which often ask for the same."""

import os
import pickle
from collections.abc import Callable, Sequence
from hashlib import sha256
from pathlib import Path

from rulec.automata import compiler
from rulec.automata.compiler_jobs import Done, Failed, Job
from rulec.automata.decision_diagrams import diagram_compiler
from rulec.automata.worker import compiler_choice
from rulec.automata.worker.machine_cache import MachineCache
from rulec.resource_limits import CompilerTime
from support.asked_compilers import machine_by

Answers = tuple[list[Done | Failed | None], str]

_SCRIPT, _WORKER, ASKED = compiler._WORKER, compiler._worker, compiler.answers_to


def remembering(folder: Path) -> Callable[[Sequence[Job]], Answers]:
    """``compiler.answers_to``, but for what this process or one beside it has asked before.

    They keep machines in ``folder``; the second compiler needs no process, in which it would have
    to be loaded each time, and Spot's waits for the next rulebook. What ships is taken as commands
    take it. Whatever fails is asked anew, and so is everything while a test has put another worker
    in the place of Spot's, or is about how it is confined.
    """

    def kept(job: Job, choice: str | None) -> Path:
        compiler_asked = choice or os.environ.get(compiler_choice.VARIABLE, "")
        return folder / sha256(compiler_asked.encode() + pickle.dumps(job)).hexdigest()

    def answers_to(
        jobs: Sequence[Job],
        *,
        more_will_come: bool = False,
        choice: str | None = None,
        time: CompilerTime | None = None,
    ) -> Answers:
        is_usual = compiler._WORKER is _SCRIPT and compiler._worker is _WORKER
        if not is_usual or compiler._REQUIRE_CONFINED in os.environ or not jobs:
            return ASKED(jobs, more_will_come=more_will_come, choice=choice, time=time)
        files = [kept(job, choice) for job in jobs]
        known = [file.read_bytes() if file.exists() else b"" for file in files]
        unknown = [job for job, found in zip(jobs, known, strict=True) if not found]
        if choice == compiler_choice.DIAGRAMS:
            shipped, _ = MachineCache(choice).recalled(unknown)
            pairs = zip(unknown, shipped, strict=True)
            asked = [found or machine_by(job, diagram_compiler.COMPILER) for job, found in pairs]
            spot = ""
        else:
            asked, spot = ASKED(unknown, more_will_come=True, time=time) if unknown else ([], "")
        for job, answer in zip(unknown, asked, strict=True):
            if isinstance(answer, Done):
                file = kept(job, choice)
                part = file.with_suffix(f".{os.getpid()}")
                part.write_bytes(pickle.dumps((answer, spot)))
                part.replace(file)
        rest = iter(asked)
        answers: list[Done | Failed | None] = []
        for found in known:
            if found:
                answer, spot = pickle.loads(found)
                answers.append(answer)
            else:
                answers.append(next(rest))
        return answers, spot

    return answers_to
