"""Spot as a compiler, as the worker uses it."""

from __future__ import annotations

from rulec.automata.alphabet import AND, joined, propositions_of
from rulec.automata.axiom_groups import possible_letters
from rulec.automata.compiler_jobs import AcceptanceError, Compiler, Job, Translated
from rulec.automata.spot_bridge.spot_automata import VERSION, explore, in_hoa
from rulec.automata.spot_bridge.spot_formulas import projected
from rulec.automata.spot_bridge.translation import translate
from rulec.logic.formula import Constant, Formula

_NO_SETS = "Too many acceptance sets"
"""The start of Spot's error for an automaton with more than the 32 sets that it was built for."""


def _translated(job: Job) -> Translated:
    propositions = propositions_of(job.formula)
    facts = [projected(group.known, propositions) for group in job.groups]
    axioms = [fact for fact in facts if fact != Constant(True)]
    try:
        translation = translate(job.formula, job.reads, job.semantics, axioms)
    except RuntimeError as problem:
        if str(problem).startswith(_NO_SETS):
            raise AcceptanceError from None
        raise
    return Translated(
        explore(translation, job.reads),
        possible_letters(job.reads, joined(AND, axioms)) if axioms else None,
        in_hoa(translation.automaton, job.name, job.remarks_on(translation.alive))
        if job.remarks
        else "",
        translation.is_checked,
        translation.compare,
    )


def _contradicts(known: Formula) -> bool:
    return projected(known, ()) == Constant(False)


COMPILER = Compiler(VERSION, _translated, _contradicts)
