"""Spot as a compiler, as the worker uses it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from rulec.automata.alphabet import AND, count_letters, joined, letters_with, propositions_of
from rulec.automata.axiom_groups import possible_letters
from rulec.automata.compiler_jobs import AcceptanceError, Compiler, Job, Translated
from rulec.automata.mealy_monitor import NumberRead, Read
from rulec.automata.spot_bridge.spot_automata import VERSION, explore, in_hoa
from rulec.automata.spot_bridge.spot_formulas import projected
from rulec.automata.spot_bridge.translation import Translation, translate
from rulec.logic.formula import Atom, Comparison, Constant, Formula, Proposition
from rulec.logic.semantics import Semantics

_NO_SETS = "Too many acceptance sets"
"""The start of Spot's error for an automaton with more than the 32 sets that it was built for."""


def _translated(job: Job) -> Translated:
    axioms = _facts(job, job.propositions)
    translation = _translation(job.formula, job.semantics, job.reads, axioms)
    letters = letters_with(job.reads, translation.names)
    return Translated(
        explore(translation, letters, count_letters(job.reads)),
        _letters_where(axioms, job),
        _text(translation, job),
        translation.is_checked,
        translation.compare,
    )


def _rest(
    job: Job, rest: Formula, letters: Mapping[Proposition, int], n_letters: int
) -> Translated:
    propositions = propositions_of(rest)
    mentioned = [_mentioned(read, propositions) for read in job.reads]
    reads = [read for read in mentioned if read is not None]
    translation = _translation(rest, job.semantics, reads, _facts(job, propositions))
    automaton = explore(translation, letters, n_letters)
    text = _text(translation, job)
    return Translated(automaton, None, text, translation.is_checked, translation.compare)


def _text(translation: Translation, job: Job) -> str:
    if not job.remarks:
        return ""
    return in_hoa(translation.automaton, job.name, job.comments(translation.alive))


def _mentioned(
    read: Read | NumberRead, propositions: Sequence[Proposition]
) -> Read | NumberRead | None:
    """The part of a read that these propositions are about."""
    if isinstance(read, NumberRead):
        about = (each.terms == read.terms for each in propositions if isinstance(each, Comparison))
        return read if any(about) else None
    values = [x for x in read.values if Atom(read.name, read.variables, x) in propositions]
    if not values:
        return None  # nothing is known of signals
    return Read(read.name, read.variables, tuple(values), read.others or values != [*read.values])


def _translation(
    formula: Formula,
    semantics: Semantics,
    reads: Sequence[Read | NumberRead],
    axioms: Sequence[Formula],
) -> Translation:
    try:
        return translate(formula, reads, semantics, axioms)
    except RuntimeError as problem:
        if str(problem).startswith(_NO_SETS):
            raise AcceptanceError from None
        raise


def _facts(job: Job, propositions: Sequence[Proposition]) -> list[Formula]:
    """What the facts say about some propositions."""
    facts = [projected(group.known, propositions) for group in job.groups]
    return [fact for fact in facts if fact != Constant(True)]


def _possible(job: Job) -> int | None:
    return _letters_where(_facts(job, job.propositions), job)


def _letters_where(axioms: Sequence[Formula], job: Job) -> int | None:
    return possible_letters(job.reads, joined(AND, axioms)) if axioms else None


def _contradicts(known: Formula) -> bool:
    return projected(known, ()) == Constant(False)


COMPILER = Compiler(VERSION, _translated, _contradicts, _rest, _possible)
