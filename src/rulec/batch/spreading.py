"""Questions of an analysis answered in several processes."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from typing import Any

from rulec.analysis.lint.questions import Question, Spread
from rulec.batch.batch_messages import process_lost
from rulec.batch.jobs import Jobs, LostTask
from rulec.batch.worker_pool import in_order


def spreading(jobs: Jobs, rulebook: str, lost: Callable[[int | None], object]) -> Spread | None:
    """Answers questions about a rulebook in several processes; None if one process is enough.

    ``lost`` is called with the signal that killed a process. The iterator raises RulecError R0708
    if the same question kills a second process.
    """
    if jobs.processes <= 1:
        return None

    def spread(
        work: Callable[[Question], Iterator[Any]], questions: Sequence[Question]
    ) -> Iterator[tuple[Question, Any]]:
        def tell_lost(_: Question, signal_number: int | None) -> None:
            lost(signal_number)

        for question, answer in in_order(work, questions, jobs, lost=tell_lost):
            if isinstance(answer, LostTask):
                raise process_lost(rulebook, answer.signal_number, "analyzed")
            yield question, answer

    return spread
