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

from rulec.automata.clocks.clocked_machine import ClockedMachine, TimedMachine
from rulec.automata.compiler_jobs import Done, Failed, Job
from rulec.automata.tables import MOST_STEPS_AHEAD, SizeError
from rulec.logic.bounds import has_seconds, operations_of
from rulec.logic.formula import Bound, Formula
from rulec.logic.past_registers import Clock, with_clocks
from rulec.logic.pastification import pastified
from rulec.logic.printing import formula_text

MOST_CLOCKS = 8
"""The table that reads them has a letter for each set of clocks that hold."""

Answer: TypeAlias = Done | ClockedMachine | Failed | None
"""What a compiler answers; None if the job killed it."""

Ask: TypeAlias = Callable[[Sequence[Job]], Sequence[Answer]]


@dataclass(frozen=True, slots=True)
class _Question:
    """What a compiler is asked, and the clocks with their bounds, for steps of so many seconds.

    If the machine gets too large, another question is only of use with ``or_else``.
    """

    job: Job
    clocks: tuple[Clock, ...] = ()
    step_s: Fraction | None = None
    or_else: bool = False

    def machine(self, answer: Answer) -> Done | Failed | None:
        """The machine for the clocks' bounds."""
        if not isinstance(answer, ClockedMachine):
            return answer
        bounds = tuple([clock.bound for clock in self.clocks])
        timed = TimedMachine(answer, bounds, ends=self.job.semantics == "finite")
        try:
            return Done(timed.at(self.step_s), "", timed)
        except SizeError:
            return Failed("size")


def machines(jobs: Sequence[Job], ask: Ask) -> list[Done | Failed | None]:
    """The machine of each job for its bounds, from as few questions as possible to a compiler."""
    found: list[Done | Failed | None] = [Failed("steps")] * len(jobs)
    ways = {
        number: _ways(job)
        for number, job in enumerate(jobs)
        if _farthest_step(job) <= MOST_STEPS_AHEAD
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


def texts_with_clocks(jobs: Sequence[Job], ask: Ask) -> list[str]:
    """The automaton of each job in HOA with clocks in its header; empty if it has none.

    Each ``Rulec-Clock`` names a proposition of the automaton, its operands, and its bound with the
    unit. By its capital letter, who does not know this header cannot read the automaton.
    """
    questions = [next(_timed_ways(job), None) for job in jobs]
    asked = [question.job for question in questions if question is not None]
    answers = iter(ask(asked))
    return ["" if own is None else _with_header(own, next(answers)) for own in questions]


def _with_header(question: _Question, answer: Answer) -> str:
    if not isinstance(answer, ClockedMachine):
        return ""
    head, body = answer.hoa.split("--BODY--", 1)
    clocks = [
        f'Rulec-Clock: "{clock.atom}" "{formula_text(clock.left)}" "{formula_text(clock.right)}" '
        f"{_bound_text(clock.bound)}\n"
        for clock in question.clocks
    ]
    return "".join([head, *clocks, "--BODY--", body])


def _bound_text(bound: Bound) -> str:
    high = "" if bound.high is None else str(bound.high)
    marks = [*["early"] * bound.early, *["later"] * bool(bound.least)]
    return " ".join([f'"{bound.low}" "{high}" {bound.unit}', *marks])


def _ways(job: Job) -> Iterator[_Question]:
    """The questions to ask for a job's machine, one after the other until one is answered."""
    if not job.remarks:
        yield from _timed_ways(job)
    yield _Question(replace(job, formula=job.in_steps, step_s=None))


def _timed_ways(job: Job) -> Iterator[_Question]:
    """Those of them that leave bounds to clocks."""
    past = pastified(job.formula, job.semantics)
    if past is not None:
        yield from _apart(job, past, or_else=True)
    yield from _apart(job, job.formula)


def _apart(job: Job, formula: Formula, *, or_else: bool = False) -> Iterator[_Question]:
    apart = with_clocks(formula)
    if apart is None or has_seconds(apart[0]) or len(apart[1]) > MOST_CLOCKS:
        return
    present, clocks = apart
    unbounded = tuple([clock.unbounded() for clock in clocks])
    # What a formula no longer mentions may still be what facts are about.
    named = job.propositions
    asked = replace(job, formula=present, clocks=unbounded, named=named, step_s=None)
    yield _Question(asked, clocks, job.step_s, or_else)


def _farthest_step(job: Job) -> Fraction:
    """The greatest step number in any bound of a job's formula."""
    bounds = [operation.bound for operation in operations_of(job.in_steps)]
    ends = [bound.high or bound.low for bound in bounds if bound is not None]
    return max(ends, default=Fraction(0))
