"""Letters of states in which unknown values have to do with each other, one by one."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.thresholds import exact
from rulec.logic.free_names import names_in
from rulec.logic.kleene import Unknown
from rulec.monitoring.letter_reader import present_in
from rulec.monitoring.uncertainty.state_letters.completions import (
    Subject,
    joint_digits,
    subjects_of_read,
)
from rulec.monitoring.uncertainty.state_letters.entanglement import NothingKnown
from rulec.monitoring.uncertainty.uncertain_machine import UncertainMachine
from rulec.trace import Value
from rulec.trace.trace_columns import Array, TraceColumns
from rulec.vocabulary import Enumeration, Signal, Vocabulary
from rulec.vocabulary.partial_values import UNKNOWN, UNKNOWN_TYPES, Interval, PartialValue

MOST_KNOWN = 1 << 14
"""States whose letters are kept before all are forgotten."""


class ColumnState:
    """One state of many in columns, as a ``StateView`` of it would be."""

    def __init__(
        self,
        columns: TraceColumns,
        vocabulary: Vocabulary,
        place: int,
        supposed: Mapping[Subject, Value],
    ) -> None:
        self._columns = columns
        self._supposed = supposed
        self._place = place
        self.vocabulary = vocabulary
        step = int(np.searchsorted(columns.layout.starts, place, side="right")) - 1
        self.objects: Mapping[str, str] = present_in(step, columns.objects, columns.present)

    def given(self, name: str, items: tuple[str, ...]) -> PartialValue | None:
        """The value, be it partial, or what is supposed of it, or the declared default."""
        given: Any = self._given(name, items)
        is_unknown = type(given) in UNKNOWN_TYPES
        value: PartialValue | None = (
            self._supposed.get((name, items), given) if is_unknown else given
        )
        return value

    def _given(self, name: str, items: tuple[str, ...]) -> PartialValue | None:
        key, declaration = (name, items), self.vocabulary.declarations[name]
        column = self._columns.values.get(key)
        if column is None:
            return declaration.default
        unknown, upper = self._columns.unknown.get(key), self._columns.upper.get(key)
        if unknown is not None and unknown[self._place]:
            return UNKNOWN
        value: Any = column[self._place].item()
        if isinstance(declaration, Enumeration):
            return str(declaration.values[value])
        if isinstance(declaration, Signal):
            return bool(value)
        if upper is not None and upper[self._place] != value:
            return Interval(value, upper[self._place].item())
        return float(value)

    def value(self, name: str, items: tuple[str, ...]) -> Value | Unknown:
        """The value if it is known."""
        given: Any = self.given(name, items)
        if given is None or type(given) in UNKNOWN_TYPES:
            return Unknown(name, items)
        known: Value = given
        return known

    def number(self, name: str, items: tuple[str, ...]) -> Fraction | Unknown:
        """The quantity's value: exact."""
        value = self.value(name, items)
        assert not isinstance(value, str), "it is a quantity"
        return value if isinstance(value, Unknown) else exact(value)


class CorrelatedLetters:
    """A reader of the letter classes that one rule may read where unknown values correlate."""

    def __init__(
        self,
        rule: CompiledRule,
        columns: TraceColumns,
        rulebook: CompiledRulebook,
        vocabulary: Vocabulary,
        machine: UncertainMachine,
    ) -> None:
        self._rule = rule
        self._columns = columns
        self._axioms = rulebook.axioms
        self._vocabulary = vocabulary
        self._classes = machine.classes
        self._known = machine.correlated
        self._in_axioms = {name for axiom in self._axioms for name in names_in(axiom.formula)}
        self._everybody = NothingKnown(columns.objects, vocabulary)

    def of(
        self,
        objects: Mapping[str, str],
        places: NDArray[np.intp],
        supposed: Mapping[Subject, Value],
    ) -> Sequence[int]:
        """The classes, as bits, in the states at these places.

        Of what is unknown some has the values that are ``supposed``.
        """
        columns = self._columns
        reads = self._rule.machine.reads
        read = {x for one in reads for x in subjects_of_read(one, objects, self._everybody)}
        parts: Sequence[Mapping[Subject, Array]] = (columns.values, columns.unknown, columns.upper)
        told = [
            (number, subject)
            for number, part in enumerate(parts)
            for subject in part
            if subject in read or subject[0] in self._in_axioms
        ]
        given = [parts[number][subject][places].astype(np.float64) for number, subject in told]
        values = np.stack([np.zeros(len(places)), *given], axis=1)
        declarations = self._vocabulary.declarations
        names = sorted({name for name, _ in read} | self._in_axioms)
        defaults = [declarations[name].default for name in names]
        about = tuple(objects.values()), *told, *supposed.items(), *defaults, *self._axioms
        # What does not change from state to state is looked up once.
        known = self._known.setdefault(about, {})
        found = []
        for place, row in zip(places.tolist(), values, strict=True):
            view = ColumnState(self._columns, self._vocabulary, place, supposed)
            key = tuple(view.objects.items()), row.tobytes()
            if key not in known:
                if len(known) >= MOST_KNOWN:
                    known.clear()
                joint = joint_digits(self._rule.machine.reads, objects, view, self._axioms)
                letters = [tuple([1 << digit for digit in one]) for one in sorted(joint.digits)]
                known[key] = self._classes.of(tuple(letters))
            found.append(known[key])
        return found
