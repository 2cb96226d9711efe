"""Which rules can have an effect at all, by the values that their reads have anywhere."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field

from rulec.monitoring.batch.stacked.contradictions import LinkedFacts, linked
from rulec.monitoring.batch.stacked.stack_reader import StackReader
from rulec.monitoring.batch.stacked.stacked_rule import StackedRead, StackedRule

_MOST_KEPT = 1 << 10
"""How many combinations of all reads' digits are kept before all are discarded."""


@dataclass(frozen=True, slots=True, eq=False)
class SimpleRules:
    """The ``rules`` that can be judged on arrays, by number, and the linked ``facts`` about them.

    ``reads`` are the distinct reads, and ``places`` those of each rule's reads among them. The
    rules that may have an effect are cached by the digits that all reads have anywhere.
    """

    rules: Mapping[int, StackedRule]
    facts: Sequence[LinkedFacts]
    reads: Sequence[StackedRead]
    places: Mapping[int, Sequence[int]]
    _busy: dict[tuple[int, ...], frozenset[int]] = field(default_factory=dict, init=False)

    @staticmethod
    def of(rules: Mapping[int, StackedRule]) -> SimpleRules:
        """These rules with their reads."""
        facts = dict.fromkeys(fact for rule in rules.values() for fact in rule.facts)
        reads = {read.digits_key: read for rule in rules.values() for read in rule.reads}
        place_of = {key: place for place, key in enumerate(reads)}
        places = {
            number: tuple([place_of[read.digits_key] for read in rule.reads])
            for number, rule in rules.items()
        }
        return SimpleRules(rules, tuple(linked(tuple(facts))), tuple(reads.values()), places)

    def busy(self, reader: StackReader) -> frozenset[int]:
        """The numbers of the rules that may be violated or open. Raises UnencodableError."""
        digits = reader.digits_of(self.reads)
        busy = self._busy.get(digits)
        if busy is None:
            if len(self._busy) >= _MOST_KEPT:
                self._busy.clear()
            busy = self._busy[digits] = frozenset(
                number
                for number, rule in self.rules.items()
                if not rule.machine.idle.of_cube([digits[k] for k in self.places[number]])
            )
        return busy
