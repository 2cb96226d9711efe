"""The rules of a rulebook, prepared once for all traces of a kind."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook, check_step
from rulec.automata.thresholds import exact_step
from rulec.logic.free_names import names_of
from rulec.monitoring.batch.columns.encoded_columns import UnencodableError
from rulec.monitoring.batch.joined.joined_traces import TraceKind
from rulec.monitoring.batch.stacked.contradictions import linked
from rulec.monitoring.batch.stacked.stack_reader import StackReader
from rulec.monitoring.batch.stacked.stacked_read import ReadKeys
from rulec.monitoring.batch.stacked.stacked_rule import StackedRule
from rulec.monitoring.state_validation import check_told
from rulec.monitoring.told_names import words_meant
from rulec.monitoring.uncertainty.judged_rules import judged_rules
from rulec.rulebook.rules.axiom_instances import counts

_MOST_KEPT = 1 << 10
"""How many combinations of all reads' digits are kept before all are discarded."""


class SimpleRules:
    """The ``rules`` that can be judged on arrays, by number, and the linked ``facts`` about them.

    The rules that may have an effect are cached by the digits that all reads have anywhere.
    """

    def __init__(self, ready: ReadyRules, untold: frozenset[str]) -> None:
        self.rules = {
            number: rule
            for number, rule in enumerate(ready.rules)
            if rule.is_simple and untold.isdisjoint(rule.names)
        }
        judged = [x for x in self.rules.values() if x.rule.name not in ready.judged.lacking]
        self.facts = tuple(linked([*dict.fromkeys(fact for rule in judged for fact in rule.facts)]))
        reads = {read.digits_key: read for rule in self.rules.values() for read in rule.reads}
        place_of = {key: place for place, key in enumerate(reads)}
        self._reads = tuple(reads.values())
        self._places = {
            number: tuple([place_of[read.digits_key] for read in rule.reads])
            for number, rule in self.rules.items()
        }
        self._busy: dict[tuple[int, ...], frozenset[int]] = {}

    def busy(self, reader: StackReader) -> frozenset[int]:
        """The numbers of the rules that may be violated or open. Raises UnencodableError."""
        digits = reader.digits_of(self._reads)
        busy = self._busy.get(digits)
        if busy is None:
            if len(self._busy) >= _MOST_KEPT:
                self._busy.clear()
            busy = self._busy[digits] = frozenset(
                number
                for number, rule in self.rules.items()
                if not rule.machine.idle.of_cube([digits[k] for k in self._places[number]])
            )
        return busy


class ReadyRules:
    """What is the same for all traces of one kind. Raises RulecError, UnencodableError.

    ``names`` are those of the ``rules`` that are simple, ``meant`` the words that their meanings
    give, ``defaults`` the default values looked up so far.
    """

    def __init__(self, kind: TraceKind, book: CompiledRulebook) -> None:
        for rule in book.rules:
            check_step(rule, exact_step(kind.step_s))
        check_told(kind.told, book.vocabulary)
        constants = book.vocabulary.constants
        for fact in book.axioms:
            if counts(fact.formula) or not set(constants).isdisjoint(names_of(fact.formula)):
                raise UnencodableError  # what it says of values is looked up state by state
        self.judged = judged_rules(book, kind.told, cut=kind.ends == "cut")
        keys: ReadKeys = {}
        self.rules: Sequence[StackedRule] = [
            StackedRule(rule, machine, book, self.judged.vocabulary, keys)
            for rule, machine in self.judged.machines
        ]
        self.names = frozenset().union(*[rule.names for rule in self.rules if rule.is_simple])
        self.meant = words_meant(self.judged.vocabulary, kind.told)
        self.defaults: dict[str, Any] = {}
        self._simple: dict[frozenset[str], SimpleRules] = {}

    def simple(self, untold: frozenset[str]) -> SimpleRules:
        """The rules that can be evaluated on arrays if some names are missing, usually all."""
        if untold not in self._simple:
            self._simple[untold] = SimpleRules(self, untold)
        return self._simple[untold]


def ready_rules(kind: TraceKind, rulebook: CompiledRulebook) -> ReadyRules:
    """The rules for traces of this kind.

    Raises RulecError or UnencodableError if no such traces can be judged together.
    """
    book = rulebook.fitted_to(kind.step_s)
    known: dict[TraceKind, ReadyRules] = book.prepared.setdefault(ReadyRules, {})
    if kind not in known:
        known[kind] = ReadyRules(kind, book)
    return known[kind]
