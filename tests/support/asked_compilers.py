"""Compilers that are asked in this process."""

from rulec.automata.compiler_jobs import Compiler, Done, Failed, Job
from rulec.automata.worker.clocked_jobs import machines
from rulec.automata.worker.job_answers import answer_to


def machine_by(job: Job, compiler: Compiler) -> Done | Failed | None:
    """The machine of a job, by as many questions as it takes."""
    (found,) = machines([job], lambda jobs: [answer_to(each, compiler) for each in jobs])
    return found
