"""Compiles the rules of several rulebooks, each distinct law once."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.compiler import build_all, lower
from rulec.logic.bounds import has_seconds, longest_divisor
from rulec.logic.free_names import names_in
from rulec.logic.one_point import plainly_counted
from rulec.monitoring.batch.by_states import verify_by_states
from rulec.monitoring.verdict import Violation
from rulec.rulebook.rulebook_model import Axiom, Rule, Rulebook
from rulec.trace import Trace
from rulec.vocabulary import Vocabulary


@dataclass(frozen=True, slots=True)
class AnalyzedRule:
    """A compiled rule with its rulebook and the axioms known there.

    Rules with the same ``law`` are textually equivalent and mean the same.
    """

    rulebook: CompiledRulebook
    axioms: tuple[Axiom, ...]
    rule: CompiledRule
    law: int

    def violations(self, trace: Trace, vocabulary: Vocabulary) -> tuple[Violation, ...]:
        """The violations of the rule by a trace in the words of a vocabulary."""
        alone = replace(self.rulebook, vocabulary=vocabulary, rules=(self.rule,))
        return verify_by_states(trace, alone).violations


@dataclass(slots=True)
class SharedCompiler:
    """Compiles rules of several rulebooks at their own steps, each law once."""

    _machines: dict[object, CompiledRule] = field(default_factory=dict)
    _laws: dict[object, int] = field(default_factory=dict)

    def compiled(self, book: Rulebook, written: Mapping[str, Rule]) -> dict[str, AnalyzedRule]:
        """Rules of a rulebook by name. Raises RulecError if one cannot be compiled."""
        chosen = {name: _shorter(rule, book.vocabulary) for name, rule in written.items()}
        keys = {name: _key(rule, book) for name, rule in chosen.items()}
        missing = {key: chosen[name] for name, key in keys.items() if key not in self._machines}
        lacking = replace(book, rules=tuple(missing.values()))
        header = build_all(lacking, lower(lacking))
        self._machines.update(zip(missing, header.rules, strict=True))
        return {
            name: AnalyzedRule(
                replace(header, rules=()),
                book.axioms,
                replace(
                    self._machines[key],
                    **{own: getattr(chosen[name], own) for own in _NOT_COMPILED},
                ),
                self._laws.setdefault((key, book.axioms), len(self._laws)),
            )
            for name, key in keys.items()
        }


def compile_shared(
    rulebooks: Sequence[Rulebook], rules: Sequence[Mapping[str, Rule]]
) -> list[dict[str, AnalyzedRule]]:
    """For each rulebook its chosen rules by name. Raises RulecError if one cannot be compiled."""
    compiler = SharedCompiler()
    return [
        compiler.compiled(book, written) for book, written in zip(rulebooks, rules, strict=True)
    ]


def _shorter(rule: Rule, vocabulary: Vocabulary) -> Rule:
    """The rule without counts within counts of what is the same as another object."""
    kinds = {variable.name: variable.type for variable in rule.variables}
    return replace(rule, formula=plainly_counted(rule.formula, kinds, vocabulary.is_subtype))


_NOT_COMPILED = (
    *("name", "strength", "cite", "says", "level", "weight"),
    *("source", "certainty", "book"),
)
"""The fields of a rule on which its monitor does not depend."""


def _key(rule: Rule, book: Rulebook) -> object:
    """Everything that a rule's monitor depends on."""
    return (
        rule.formula,
        rule.variables,
        rule.step_s if has_seconds(rule.formula) else None,
        tuple(book.vocabulary.declarations[name] for name in dict.fromkeys(names_in(rule.formula))),
        book.semantics,
        book.axioms,
    )


def at_one_step(rules: Iterable[Rule], step_s: Fraction | None) -> list[Rule]:
    """The rules for one step of the trace: the given one, else the longest that divides all."""
    listed = list(rules)
    steps = [rule.step_s for rule in listed if has_seconds(rule.formula)]
    if step_s is None and steps:
        step_s = longest_divisor(steps)
    return [rule if step_s is None else replace(rule, step_s=step_s) for rule in listed]
