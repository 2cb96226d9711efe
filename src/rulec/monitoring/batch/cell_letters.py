"""Letters that a rule's machine reads in each cell."""

from __future__ import annotations

from rulec.diagnostics import RulecError
from rulec.monitoring.batch.rule_bindings import RuleBinding
from rulec.monitoring.letter_reader import LetterReader
from rulec.trace.trace_columns import TraceCells
from rulec.vocabulary import Vocabulary


class CellLetterReader:
    """Reader of the letters of bindings, cell by cell."""

    def __init__(self, traces: TraceCells, vocabulary: Vocabulary) -> None:
        self._n_cells = len(traces.states)
        # States in which the same objects are there are read together.
        parts: dict[tuple[tuple[str, str], ...], list[int]] = {}
        for cell in range(self._n_cells):
            there = traces.there[cell] if traces.there else traces.objects
            parts.setdefault(tuple(there.items()), []).append(cell)
        self._parts = [
            (
                cells,
                frozenset(name for name, _ in there),
                LetterReader(
                    [traces.states[cell] for cell in cells],
                    vocabulary,
                    str,
                    objects=dict(there),
                ),
            )
            for there, cells in parts.items()
        ]

    def letters(self, binding: RuleBinding) -> list[int]:
        """Letter class of each cell; -1 where there is none to read.

        Where an object of the binding is not there its machine does not run; any letter will do.
        """
        numbers = [0] * self._n_cells
        for cells, there, columns in self._parts:
            if there.issuperset(binding.objects.values()):
                for cell, letter in zip(cells, _word(binding, columns, len(cells)), strict=True):
                    numbers[cell] = letter
        return numbers


def _word(binding: RuleBinding, columns: LetterReader, n_states: int) -> list[int]:
    try:
        return list(columns.word(binding.rule, binding.objects, 0, n_states - 1))
    except RulecError:
        return [_letter(binding, columns, place) for place in range(n_states)]


def _letter(binding: RuleBinding, columns: LetterReader, place: int) -> int:
    try:
        return columns.word(binding.rule, binding.objects, place, place)[0]
    except RulecError:
        return -1
