"""The compiler without Spot, as the worker uses it."""

from __future__ import annotations

from rulec.automata.compiler_jobs import Compiler, Job, Translated
from rulec.automata.decision_diagrams.hoa_lines import in_hoa
from rulec.automata.decision_diagrams.rule_automaton import automaton_of, contradicts, over_letters


def _translated(job: Job) -> Translated:
    rule_automaton = automaton_of(
        job.formula, job.reads, job.semantics, [group.known for group in job.groups]
    )
    automaton, possible = over_letters(rule_automaton, job.reads)
    return Translated(
        automaton,
        possible,
        in_hoa(rule_automaton, job.name, job.comments(rule_automaton.alive)),
    )


COMPILER = Compiler("", _translated, contradicts)
