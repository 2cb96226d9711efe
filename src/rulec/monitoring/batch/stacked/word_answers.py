"""The answers of a rule's machine for words of letter sets, of which each is run once."""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from rulec.monitoring.uncertainty.state_letters.letter_set_arrays import LetterSets
from rulec.monitoring.uncertainty.uncertain_machine import Answer, UncertainMachine
from rulec.trace.plain_arrays import ODD

MOST_BYTES = 1 << 22
"""How many bytes of words with known answers are kept before all are discarded."""

FEW_WORDS = 1 << 5
"""Fewer words are evaluated one by one, without searching for equal ones."""


class WordAnswers:
    """The answers of a machine, kept by the words that have been met.

    Words are given by the numbers of letter sets, end to end, and by the ``bounds`` between them.
    """

    def __init__(self, machine: UncertainMachine, letters: LetterSets) -> None:
        self._machine = machine
        self._letters = letters
        self._by_runs: dict[bytes, Answer | None] = {}
        self._by_letters: dict[bytes, Answer | None] = {}
        self._bytes = 0

    def of(self, letters: NDArray[np.intp], bounds: NDArray[np.intp]) -> list[Answer | None]:
        """The answer for each word; None if axioms exclude a letter of it."""
        if len(bounds) <= FEW_WORDS:
            words = [letters[begin:end] for begin, end in pairwise(bounds.tolist())]
            return [self._of_one(word) for word in words]
        first_alike = _first_alike(letters, bounds).tolist()
        rows, ends = _runs(letters, bounds)
        # One text of all words, since cutting arrays into thousands of words takes longer
        text, width = rows.tobytes(), rows.itemsize * rows.shape[1]
        answers = {}
        for place in dict.fromkeys(first_alike):
            begin, end = ends[place], ends[place + 1]
            answers[place] = self._of_runs(text[width * begin : width * end], rows[begin:end])
        return [answers[first] for first in first_alike]

    def _of_one(self, word: NDArray[np.intp]) -> Answer | None:
        key = word.tobytes()
        if key in self._by_letters:
            return self._by_letters[key]
        rows, _ = _runs(word, np.array([0, len(word)], dtype=np.intp))
        answer = self._of_runs(rows.tobytes(), rows)
        if len(key) <= MOST_BYTES >> 10:
            self._make_room(len(key))
            self._by_letters[key] = answer
        return answer

    def _of_runs(self, key: bytes, rows: NDArray[np.intp]) -> Answer | None:
        """The answer for a word, given as rows of a letter set's number and its repetitions."""
        if key not in self._by_runs:
            self._make_room(len(key))
            sets, runs = self._letters.sets, rows.tolist()
            word = [(sets[number], length) for number, length in runs]
            answer = None
            if all(classes for classes, _ in word):
                answer = Answer(*self._machine.monitor.run_stretches(iter(word)))
            self._by_runs[key] = answer
        return self._by_runs[key]

    def _make_room(self, n_bytes: int) -> None:
        self._bytes += n_bytes
        if self._bytes > MOST_BYTES:
            self._by_runs.clear()
            self._by_letters.clear()
            self._bytes = n_bytes


def _runs(
    letters: NDArray[np.intp], bounds: NDArray[np.intp]
) -> tuple[NDArray[np.intp], list[int]]:
    """The letters as rows of letter and repetitions, and the bounds of words in these."""
    is_new = np.ones(len(letters), dtype=bool)
    np.not_equal(letters[1:], letters[:-1], out=is_new[1:])
    is_new[bounds[:-1]] = True
    starts = is_new.nonzero()[0]
    rows = np.empty((len(starts), 2), dtype=np.intp)
    rows[:, 0] = letters[starts]
    rows[:-1, 1] = starts[1:] - starts[:-1]
    rows[-1:, 1] = len(letters) - starts[-1:]
    return rows, starts.searchsorted(bounds).tolist()


def _first_alike(letters: NDArray[np.intp], bounds: NDArray[np.intp]) -> NDArray[np.intp]:
    """For each word the position of the first equal word.

    Words are distinguished by weighted sums of their letters, then compared.
    """
    begins, lengths = bounds[:-1], bounds[1:] - bounds[:-1]
    states = np.arange(bounds[-1]) - begins.repeat(lengths)
    # Odd pseudo-random weights: the powers of one number
    weights = np.cumprod(np.full(int(lengths.max(initial=0)) + 1, ODD), dtype=np.uint64)
    own = np.add.reduceat((letters + 1).astype(np.uint64) * weights[states], begins)
    sums = weights[lengths] * ODD + own
    _, firsts, groups = np.unique(sums, return_index=True, return_inverse=True)
    like: NDArray[np.intp] = firsts[groups]
    if (lengths == lengths[like]).all():
        at = begins[like].repeat(lengths) + states
        if (letters == letters[at]).all():
            return like
    return np.arange(len(begins))
