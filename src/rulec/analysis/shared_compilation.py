"""Compile the rules of several rulebooks, each law once."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import gcd, lcm

from rulec.automata.bundle.compiled_rulebook import CompiledRule, CompiledRulebook
from rulec.automata.compiler import compile_rulebook
from rulec.logic.bounds import has_seconds
from rulec.logic.free_names import names_in
from rulec.rulebook.rulebook_model import Axiom, Rule, Rulebook


@dataclass(frozen=True, slots=True)
class AnalyzedRule:
    """A compiled rule with its rulebook and the axioms known there.

    Those with the same ``law`` have rules that mean the same by their very words.
    """

    rulebook: CompiledRulebook
    axioms: tuple[Axiom, ...]
    rule: CompiledRule
    law: int


CompilationKey = tuple[object, ...]


class SharedCompiler:
    """Compiles rules, each law once."""

    def __init__(self, tell: Callable[[float], object] = lambda _: None) -> None:
        self._tell = tell
        self._machines: dict[CompilationKey, CompiledRule] = {}
        self._laws: dict[CompilationKey, int] = {}
        self._headers: dict[int, CompiledRulebook] = {}

    def compile(
        self, rulebooks: Sequence[Rulebook], rules: Sequence[Mapping[str, Rule]]
    ) -> list[dict[str, AnalyzedRule]]:
        """For each rulebook its chosen rules by name, at the named steps.

        Raises RulecError if one cannot be compiled.
        """
        compiled_rules = []
        for number, (book, chosen) in enumerate(zip(rulebooks, rules, strict=True)):
            keys = {name: _key(rule, book) for name, rule in chosen.items()}
            missing = {key: chosen[name] for name, key in keys.items() if key not in self._machines}
            header = compile_rulebook(replace(book, rules=tuple(missing.values())))
            self._machines.update(zip(missing, header.rules, strict=True))
            self._tell(number + 1)
            compiled_rules.append(
                {
                    name: AnalyzedRule(
                        replace(header, rules=()),
                        book.axioms,
                        _named(self._machines[key], chosen[name]),
                        self._laws.setdefault((key, book.axioms), len(self._laws)),
                    )
                    for name, key in keys.items()
                }
            )
        return compiled_rules


def _key(rule: Rule, book: Rulebook) -> CompilationKey:
    """All that a rule's monitor depends on."""
    read = dict.fromkeys(names_in(rule.formula))
    return (
        rule.formula,
        rule.variables,
        rule.step_s if has_seconds(rule.formula) else None,
        tuple(book.vocabulary.declarations[name] for name in read),
        book.semantics,
        book.axioms,
    )


def _named(compiled: CompiledRule, rule: Rule) -> CompiledRule:
    return replace(
        compiled,
        name=rule.name,
        strength=rule.strength,
        cite=rule.cite,
        says=rule.says,
        level=rule.level,
        weight=rule.weight,
        source=rule.source,
        certainty=rule.certainty,
        book=rule.book,
    )


def at_one_step(rules: Iterable[Rule], step_s: Fraction | None) -> list[Rule]:
    """The rules compiled for one step of the trace.

    The step is the given one, else one that divides those of all.
    """
    listed = list(rules)
    steps = [rule.step_s for rule in listed if has_seconds(rule.formula)]
    if step_s is None and steps:
        whole = lcm(*(step.denominator for step in steps))
        step_s = Fraction(gcd(*(int(step * whole) for step in steps)), whole)
    return [rule if step_s is None else replace(rule, step_s=step_s) for rule in listed]
