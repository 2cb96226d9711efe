"""The axioms that can tell anything about what is read: its cone of influence.

All others hold where everything that they speak of has its default, and share nothing with what is
read; so in any state their part can be as by default, and they decide nothing.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from rulec.automata.mealy_monitor import Read
from rulec.logic.formula import QuantityTerm
from rulec.vocabulary import Vocabulary
from rulec.witnesses.letter_functions import LetterFunction, Reads, counts_read
from rulec.witnesses.state_synthesis import Subject, default_digit


def relevant_axioms(
    axioms: Sequence[LetterFunction], read: Iterable[LetterFunction], vocabulary: Vocabulary
) -> list[LetterFunction]:
    """The axioms, in their order, that speak of what the functions read, or lead from it to more.

    Those that defaults break are among them, and those that count objects.
    """
    reached = {subject for function in read for subject in _subjects(function.reads)}
    waiting = {number: _subjects(axiom.reads) for number, axiom in enumerate(axioms)}
    taken: set[int] = set()
    while True:
        more = [
            number
            for number, group in waiting.items()
            if not group.isdisjoint(reached)
            or counts_read(axioms[number].reads)
            or not _holds_by_default(axioms[number], vocabulary)
        ]
        if not more:
            return [axiom for number, axiom in enumerate(axioms) if number in taken]
        for number in more:
            reached |= waiting.pop(number)
            taken.add(number)


def _subjects(reads: Reads) -> frozenset[Subject]:
    """What reads are about; what their counts read are functions of their own."""
    subjects: set[Subject] = set()
    for read in reads:
        if isinstance(read, Read):
            subjects.add((read.name, read.variables))
        else:
            terms = (term for _, term in read.terms)
            subjects |= {(t.name, t.arguments) for t in terms if isinstance(t, QuantityTerm)}
    return frozenset(subjects)


def hold_by_default(functions: Iterable[LetterFunction], vocabulary: Vocabulary) -> bool:
    """True if every function without counts is 1 where everything that it reads has its default."""
    return all(_holds_by_default(function, vocabulary) for function in functions)


def _holds_by_default(axiom: LetterFunction, vocabulary: Vocabulary) -> bool:
    digits = [default_digit(read, vocabulary) for read in axiom.reads]
    known = [digit for digit in digits if digit is not None]
    return len(known) == len(digits) and bool(axiom.value(known))
