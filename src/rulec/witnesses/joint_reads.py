"""Joint reads of letter functions: one read for each subject."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

from rulec.automata.mealy_monitor import NumberRead, Read, Threshold
from rulec.logic.formula import Term
from rulec.logic.printing import term_text
from rulec.vocabulary import Enumeration, Vocabulary
from rulec.witnesses.letter_functions import LetterFunction, Reads
from rulec.witnesses.state_synthesis import value_of


@dataclass(frozen=True, slots=True)
class JointDigits:
    """Maps a joint read to a function's read: ``digits[joint digit]`` is the function's digit."""

    joint: int
    digits: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class JointReads:
    """Joint reads, numbers first, and how each function's reads follow from them."""

    reads: Reads
    views: tuple[tuple[JointDigits, ...], ...]


def joint_reads(functions: Sequence[LetterFunction], vocabulary: Vocabulary) -> JointReads:
    """Merge the reads of letter functions.

    The joint read of a number distinguishes the thresholds of all, that of an enumeration the
    values that any of them distinguishes.
    """
    together: dict[object, list[Read | NumberRead]] = {}
    for function in functions:
        for read in function.reads:
            together.setdefault(subject_of(read), []).append(read)
    # Numbers come first, because sums depend on each other, see ``JointAlphabet``.
    subjects = sorted(together, key=lambda joint: not isinstance(together[joint][0], NumberRead))
    position = {subject: number for number, subject in enumerate(subjects)}
    reads = tuple(merged(together[subject], vocabulary) for subject in subjects)
    views = tuple(
        tuple(
            JointDigits(place, _projected_digits(read, reads[place], vocabulary))
            for read in function.reads
            for place in [position[subject_of(read)]]
        )
        for function in functions
    )
    return JointReads(reads, views)


def subject_of(read: Read | NumberRead) -> object:
    """The subject of a read; reads with the same subject share one joint read."""
    return normal(read)[0] if isinstance(read, NumberRead) else (read.name, read.variables)


def normal(read: NumberRead) -> tuple[tuple[tuple[Fraction, Term], ...], Fraction]:
    """The normal form of a read's sum, and the factor between the two.

    In normal form terms are sorted by their text, and the first coefficient is 1.
    """
    sums: dict[Term, Fraction] = {}
    for coefficient, term in read.terms:
        sums[term] = sums.get(term, Fraction(0)) + coefficient
    terms = sorted((term for term in sums if sums[term]), key=term_text)
    if not terms:
        return (), Fraction(1)
    factor = sums[terms[0]]
    return tuple((sums[term] / factor, term) for term in terms), factor


def merged(reads: Sequence[Read | NumberRead], vocabulary: Vocabulary) -> Read | NumberRead:
    """The joint read of reads with one subject."""
    first = reads[0]
    if isinstance(first, NumberRead):
        passed = {
            side for read in reads if isinstance(read, NumberRead) for side in _scaled(read)[0]
        }
        order = sorted(passed, key=lambda threshold: (threshold.limit, not threshold.inclusive))
        return NumberRead(normal(first)[0], tuple(order))
    declaration = vocabulary.declarations[first.name]
    if not isinstance(declaration, Enumeration):
        return first
    distinguished = {value for read in reads if isinstance(read, Read) for value in read.values}
    values = tuple(value for value in declaration.values if value in distinguished)
    return Read(first.name, first.variables, values, len(values) < len(declaration.values))


def _scaled(read: NumberRead) -> tuple[list[Threshold], bool]:
    """Thresholds scaled to the normal form, and whether the sum still passes them upward."""
    _, factor = normal(read)
    # A negative factor reverses the order, and turns an inclusive threshold into an exclusive one.
    upward = factor > 0
    thresholds = [
        Threshold(threshold.limit / factor, threshold.inclusive is upward)
        for threshold in read.thresholds
    ]
    return thresholds, upward


def _projected_digits(
    read: Read | NumberRead, joint: Read | NumberRead, vocabulary: Vocabulary
) -> tuple[int, ...]:
    joint_digits = range(joint.size)
    if isinstance(read, NumberRead):
        assert isinstance(joint, NumberRead)
        thresholds, upward = _scaled(read)
        places = [joint.thresholds.index(threshold) for threshold in thresholds]
        return tuple(sum((digit > place) is upward for place in places) for digit in joint_digits)
    assert isinstance(joint, Read)
    return tuple(read.digit(value_of(joint, digit, vocabulary)) for digit in joint_digits)
