"""What the rules of a group read of a state, each value and each read of it once."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rulec.monitoring.bindings import types_of
from rulec.monitoring.online.encoding.encoded_values import (
    MISSING,
    UNKNOWN_DIGIT,
    Breakpoints,
    digit_table,
)
from rulec.monitoring.online.prepared_rule import PossibleClasses, PreparedRule
from rulec.monitoring.uncertainty.state_letters.joint_values import values_at
from rulec.trace.remembered import Remembered
from rulec.vocabulary import Enumeration
from rulec.vocabulary.partial_values import UNKNOWN


class GroupReads:
    """The reads of ``rules`` whose variables have the same ``types``, in the same order.

    ``sources`` are what they read.
    """

    def __init__(self, rules: Sequence[PreparedRule], breakpoints: Breakpoints) -> None:
        self.rules = tuple(rules)
        self.types = types_of(rules[0].rule)
        self.sources = tuple(dict.fromkeys([own for rule in rules for own in rule.sources]))
        declarations = rules[0].vocabulary.declarations
        declared = [declarations.get(source.name or "") for source in self.sources]
        self._allowed = [
            (place, frozenset([*own.values, MISSING, UNKNOWN]))
            for place, own in enumerate(declared)
            if isinstance(own, Enumeration)
        ]
        self._tables: list[tuple[int, Remembered[Any, int]]] = []
        self._picks = []
        at: dict[object, int] = {source: place for place, source in enumerate(self.sources)}
        for rule in rules:
            places = []
            for read, source in rule.alone:
                key = source if source.name is None else (read.kind, source)
                if key not in at:
                    at[key] = len(at)
                    table = digit_table(read, breakpoints.get(source.name or ""))
                    self._tables.append((at[source], table))
                places.append(at[key])
            self._picks.append(values_at([*places, *[at[source] for source in rule.values]]))

    def classes(self, encoded: Sequence[Any]) -> list[PossibleClasses]:
        """The classes that each rule may read, for these encoded values of the ``sources``.

        Raises LookupError or TypeError if a value is missing or invalid, or if no such state is
        possible.
        """
        for place, allowed in self._allowed:
            if encoded[place] not in allowed:
                raise LookupError
        known = [UNKNOWN_DIGIT if value is UNKNOWN else value for value in encoded]
        known += [table[known[place]] for place, table in self._tables]
        return [
            rule.possible_classes(pick(known))
            for rule, pick in zip(self.rules, self._picks, strict=True)
        ]
