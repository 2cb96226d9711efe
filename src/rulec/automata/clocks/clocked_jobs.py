"""Jobs for a compiler that do not depend on bounds, and machines from their answers.

What a formula says of the past, and bounded duties, which are said as conditions on the past, are
left to clocks; a compiler translates the rest. So it is asked once for all steps of traces. What
clocks cannot tell, or only with too many states, is translated as a whole, with its bounds.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeAlias

from rulec.automata.clocks.clocked_machine import ClockedMachine
from rulec.automata.compiler_jobs import MOST_STEPS_AHEAD, Done, Failed, Job, SizeError
from rulec.logic.bounds import operations_of
from rulec.logic.formula import Formula
from rulec.logic.past_registers import Register, eliminate_past, without_bounds
from rulec.logic.pastification import pastified

MOST_CLOCKS = 8
"""The table that reads them has a letter for each set of clocks that hold."""

Answer: TypeAlias = Done | ClockedMachine | Failed | None
"""What a compiler answers; None if the job killed it."""

Ask: TypeAlias = Callable[[Sequence[Job]], Sequence[Answer]]


@dataclass(frozen=True, slots=True)
class _Question:
    """What a compiler is asked, and the registers with their bounds.

    If the machine gets too large, another question is only of use with ``or_else``.
    """

    job: Job
    registers: tuple[Register, ...] = ()
    or_else: bool = False

    def machine(self, answer: Answer) -> Done | Failed | None:
        """The machine for the registers' bounds."""
        if not isinstance(answer, ClockedMachine):
            return answer
        try:
            ends = self.job.semantics == "finite"
            return Done(answer.unrolled(self.registers, ends=ends), "")
        except SizeError:
            return Failed("size")


def machines(jobs: Sequence[Job], ask: Ask) -> list[Done | Failed | None]:
    """The machine of each job for its bounds, from as few questions as possible to a compiler."""
    found: list[Done | Failed | None] = [Failed("steps")] * len(jobs)
    ways = {
        number: _ways(job)
        for number, job in enumerate(jobs)
        if _farthest_step(job.formula) <= MOST_STEPS_AHEAD
    }
    waiting = {number: next(own) for number, own in ways.items()}
    while True:
        answers = ask([question.job for question in waiting.values()])
        left: dict[int, _Question] = {}
        for (number, question), answer in zip(waiting.items(), answers, strict=True):
            found[number] = machine = question.machine(answer)
            if machine == Failed("apart") or (machine == Failed("size") and question.or_else):
                left[number] = next(ways[number])
        if not left:
            return found
        waiting = left


def _ways(job: Job) -> Iterator[_Question]:
    """The questions to ask for a job's machine, one after the other until one is answered."""
    past = None if job.remarks else pastified(job.formula, job.semantics)
    if past is not None:
        yield from _apart(job, past, or_else=True)
    if not job.remarks:
        yield from _apart(job, job.formula)
    yield _Question(job)


def _apart(job: Job, formula: Formula, *, or_else: bool = False) -> Iterator[_Question]:
    parts = eliminate_past(formula)
    if not parts.memories and len(parts.registers) <= MOST_CLOCKS:
        unbounded = without_bounds(parts.registers)
        asked = replace(job, formula=parts.present, registers=unbounded)
        yield _Question(asked, parts.registers, or_else)


def _farthest_step(formula: Formula) -> Fraction:
    """The greatest step number in any bound of a formula in steps."""
    bounds = [operation.bound for operation in operations_of(formula)]
    ends = [bound.high or bound.low for bound in bounds if bound is not None]
    return max(ends, default=Fraction(0))
