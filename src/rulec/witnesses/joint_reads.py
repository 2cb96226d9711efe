"""Joint reads of letter functions, one per subject."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from rulec.automata.mealy_monitor import NumberRead, Read, Threshold
from rulec.logic.formula import Term
from rulec.logic.printing import term_text
from rulec.vocabulary import Enumeration, Vocabulary
from rulec.witnesses.letter_functions import LetterFunction

Terms = tuple[tuple[Fraction, Term], ...]


@dataclass(frozen=True, slots=True)
class JointDigits:
    """View of a joint read: ``digits[joint digit]`` is a function's own digit."""

    joint: int
    digits: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class JointReads:
    """Joint reads, numbers first, and the views of each function's reads."""

    reads: tuple[Read | NumberRead, ...]
    views: tuple[tuple[JointDigits, ...], ...]

    def own_digits(self, index: int, joint_digits: Sequence[int]) -> tuple[int, ...]:
        """The digits of one function's reads, given those of the joint ones."""
        return tuple(view.digits[joint_digits[view.joint]] for view in self.views[index])


def joint_reads(functions: Sequence[LetterFunction], vocabulary: Vocabulary) -> JointReads:
    """Merge what letter functions read.

    A number is told apart by all their thresholds, an enumeration by all the values that any of
    them tells apart.
    """
    together: dict[object, list[Read | NumberRead]] = {}
    for function in functions:
        for read in function.reads:
            together.setdefault(_subject(read), []).append(read)
    # What depends on several numbers at once is settled first, see ``JointAlphabet``.
    subjects = sorted(together, key=lambda joint: not isinstance(together[joint][0], NumberRead))
    position = {subject: number for number, subject in enumerate(subjects)}
    reads = tuple(_merged(together[subject], vocabulary) for subject in subjects)
    views = tuple(
        tuple(
            JointDigits(
                position[_subject(read)], _seen(read, reads[position[_subject(read)]], vocabulary)
            )
            for read in function.reads
        )
        for function in functions
    )
    return JointReads(reads, views)


def _subject(read: Read | NumberRead) -> object:
    if isinstance(read, NumberRead):
        return normal(read)[0]
    return read.name, read.variables


def normal(read: NumberRead) -> tuple[Terms, Fraction]:
    """Normal form of a read's sum, and the factor between the two.

    In normal form terms are sorted by their text, and the first coefficient is 1.
    """
    sums: dict[Term, Fraction] = {}
    for coefficient, term in read.terms:
        sums[term] = sums.get(term, Fraction(0)) + coefficient
    left = sorted((term_text(term), term) for term in sums if sums[term])
    if not left:
        return (), Fraction(1)
    factor = sums[left[0][1]]
    return tuple((sums[term] / factor, term) for _, term in left), factor


def _merged(reads: Sequence[Read | NumberRead], vocabulary: Vocabulary) -> Read | NumberRead:
    first = reads[0]
    if isinstance(first, NumberRead):
        passed = {
            side for read in reads if isinstance(read, NumberRead) for side, _ in _sides(read)
        }
        order = sorted(passed, key=lambda threshold: (threshold.limit, not threshold.inclusive))
        return NumberRead(normal(first)[0], tuple(order))
    declaration = vocabulary.declarations[first.name]
    if not isinstance(declaration, Enumeration):
        return first
    distinguished = {value for read in reads if isinstance(read, Read) for value in read.values}
    values = tuple(value for value in declaration.values if value in distinguished)
    return Read(first.name, first.variables, values, len(values) < len(declaration.values))


def _sides(read: NumberRead) -> Iterable[tuple[Threshold, bool]]:
    """Thresholds scaled to the normal form, each with its upward direction."""
    _, factor = normal(read)
    for threshold in read.thresholds:
        limit = threshold.limit / factor
        # The larger a sum, the smaller its negative: one passes where the other stays below.
        upward = factor > 0
        yield Threshold(limit, threshold.inclusive if upward else not threshold.inclusive), upward


def _seen(
    read: Read | NumberRead, joint: Read | NumberRead, vocabulary: Vocabulary
) -> tuple[int, ...]:
    if isinstance(read, NumberRead):
        assert isinstance(joint, NumberRead)
        places = [(joint.thresholds.index(side), upward) for side, upward in _sides(read)]
        return tuple(
            sum((digit > place) is upward for place, upward in places)
            for digit in range(joint.size)
        )
    assert isinstance(joint, Read)
    if not joint.values:
        return 0, 1
    declaration = vocabulary.declarations[read.name]
    assert isinstance(declaration, Enumeration)
    rest = next((value for value in declaration.values if value not in joint.values), "")
    values = (*joint.values, rest) if joint.others else joint.values
    return tuple(read.digit(value) for value in values)
