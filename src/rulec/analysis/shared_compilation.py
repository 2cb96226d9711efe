"""Compiles the rules of several rulebooks, each distinct law once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.compiler import build_all, lower
from rulec.logic.bounds import has_seconds, longest_divisor
from rulec.logic.free_names import names_in
from rulec.logic.one_point import plainly_counted
from rulec.monitoring.verdict import Violation
from rulec.monitoring.verify import verify
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
        return verify(trace, alone).violations


def compile_shared(
    rulebooks: Sequence[Rulebook],
    rules: Sequence[Mapping[str, Rule]],
    tell: Callable[[float], object] = lambda _: None,
) -> list[dict[str, AnalyzedRule]]:
    """For each rulebook its chosen rules by name, at their own steps; each law is compiled once.

    ``tell`` is called with the number of rulebooks compiled so far. Raises RulecError if a rule
    cannot be compiled.
    """
    machines: dict[object, CompiledRule] = {}
    laws: dict[object, int] = {}
    compiled_rules = []
    for number, (book, written) in enumerate(zip(rulebooks, rules, strict=True), 1):
        chosen = {name: _shorter(rule, book.vocabulary) for name, rule in written.items()}
        keys = {name: _key(rule, book) for name, rule in chosen.items()}
        missing = {key: chosen[name] for name, key in keys.items() if key not in machines}
        lacking = replace(book, rules=tuple(missing.values()))
        header = build_all(lacking, lower(lacking))
        machines.update(zip(missing, header.rules, strict=True))
        tell(number)
        compiled_rules.append(
            {
                name: AnalyzedRule(
                    replace(header, rules=()),
                    book.axioms,
                    replace(
                        machines[key],
                        **{field: getattr(chosen[name], field) for field in _NOT_COMPILED},
                    ),
                    laws.setdefault((key, book.axioms), len(laws)),
                )
                for name, key in keys.items()
            }
        )
    return compiled_rules


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
