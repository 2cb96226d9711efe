"""The compiler without Spot, as the worker asks it."""

from __future__ import annotations

from rulec.automata.compiler_jobs import Compiler, Job, Translated
from rulec.automata.decision_diagrams.hoa_lines import in_hoa
from rulec.automata.decision_diagrams.rule_automaton import automaton_of, contradicts, over_letters


def _translated(job: Job) -> Translated:
    found = automaton_of(
        job.formula, job.reads, job.semantics, [group.known for group in job.groups]
    )
    automaton, possible = over_letters(found, job.reads)
    return Translated(
        automaton,
        possible,
        in_hoa(found, job.name, job.remarks_on(found.alive)),
    )


COMPILER = Compiler("", _translated, contradicts)
