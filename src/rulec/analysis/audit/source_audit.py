"""The basis of each rule's verdicts on a source, before there are traces."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from typing import Any, Literal, TypeAlias

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.outcome_machine import OutcomeMachine
from rulec.logic.free_names import names_in
from rulec.monitoring.told_names import names_lacking, untold_names, untold_types
from rulec.monitoring.uncertainty.uncertain_machine import uncertain_machine
from rulec.value_display import Rows, short_repr

Basis: TypeAlias = Literal["evidence", "presumption", "nothing"]
"""The basis of verdicts on a rule: provided values, also presumed ones, or no verdicts at all."""


@dataclass(frozen=True, slots=True)
class RuleBasis:
    """The basis of verdicts on a rule.

    ``presumed`` are the names that it reads and that get their value by presumption, ``untold`` all
    others that it reads and the source does not provide, ``lacking`` those of them, and the types
    of its variables, without which it cannot be judged.
    """

    rule: str
    strength: Literal["hard", "soft"]
    basis: Basis
    presumed: tuple[str, ...] = ()
    untold: tuple[str, ...] = ()
    lacking: tuple[str, ...] = ()


@dataclass(frozen=True, slots=True)
class SourceAudit(Rows):
    """The basis of each rule of a rulebook if ``source`` provides the names ``told``."""

    __repr__ = short_repr

    rulebook: str
    source: str
    told: tuple[str, ...]
    rules: tuple[RuleBasis, ...]

    def count(self, basis: Basis) -> int:
        """The number of rules with this basis."""
        return Counter(rule.basis for rule in self.rules)[basis]

    def rows(self) -> list[dict[str, Any]]:
        """One row per rule."""
        return [asdict(rule) for rule in self.rules]


def audit_source(rulebook: CompiledRulebook, source: str, told: frozenset[str]) -> SourceAudit:
    """The basis of every rule on cut traces that contain only the provided values.

    Raises RulecError R0403 if Spot is needed for the machines of such traces and not installed.
    """
    compiler = rulebook.prefixes
    prefixes = {} if compiler is None else compiler(rulebook)
    return SourceAudit(
        rulebook.name,
        source,
        tuple(name for name in rulebook.vocabulary.declarations if name in told),
        tuple(_bases(rulebook, told, prefixes)),
    )


def _bases(
    rulebook: CompiledRulebook, told: frozenset[str], prefixes: Mapping[str, OutcomeMachine | None]
) -> Iterator[RuleBasis]:
    vocabulary = rulebook.vocabulary
    unknown, types = untold_names(vocabulary, told), untold_types(vocabulary, told)
    for rule in rulebook.rules:
        read = _names_read(rule, rulebook)
        presumed = tuple(
            name for name in read if name not in told and vocabulary.declarations[name].presumed
        )
        untold = tuple(name for name in read if name in unknown)
        lacking = uncertain_machine(rule, prefixes.get(rule.name)).untold(unknown)
        lacking = names_lacking(lacking, vocabulary, unknown)
        lacking += tuple([variable.type for variable in rule.variables if variable.type in types])
        basis: Basis = "nothing" if lacking else "presumption" if presumed else "evidence"
        yield RuleBasis(
            rule.name, rule.strength, basis, presumed=presumed, untold=untold, lacking=lacking
        )


def _names_read(rule: CompiledRule, rulebook: CompiledRulebook) -> tuple[str, ...]:
    names = frozenset(names_in(rule.formula))
    return tuple(name for name in rulebook.vocabulary.declarations if name in names)
