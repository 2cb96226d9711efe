"""Antecedents: the conditions under which a rule requires anything.

A rule whose antecedent never holds is vacuous (Beer, Ben-David, Eisner, Rodeh, "Efficient detection
of vacuity in temporal model checking", 2001).
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

from rulec.logic import formula as ltl
from rulec.rulebook.rulebook_model import Rule

AntecedentKind = Literal["implies", "phase", "when", "unless"]

_IN_WORDS: Mapping[AntecedentKind, str] = {
    "implies": "what comes before `implies`",
    "phase": "the first phase",
    "when": "the condition `when`",
    "unless": "the exception",
}


@dataclass(frozen=True, slots=True)
class Antecedent:
    """A condition without which a part of a rule is vacuous."""

    kind: AntecedentKind
    formula: ltl.Formula

    @property
    def in_words(self) -> str:
        """Its role in the rule."""
        return _IN_WORDS[self.kind]


def antecedents(rule: Rule) -> Iterator[Antecedent]:
    """The antecedents of a rule, except what an option has switched off."""
    for antecedent in _all(rule):
        if not has_constant(antecedent.formula):
            yield antecedent


def has_constant(formula: ltl.Formula) -> bool:
    """Whether some part has a fixed value, like an option."""
    return any(isinstance(part, ltl.Constant) for part in ltl.parts_in(formula))


def _all(rule: Rule) -> Iterator[Antecedent]:
    if rule.condition is not None:
        yield Antecedent("when", rule.condition)
    for exemption in rule.exemptions:
        yield Antecedent("unless", exemption.formula)
    yield from _of(rule.required or rule.formula)


def _of(formula: ltl.Formula) -> Iterator[Antecedent]:
    for part in ltl.chain_of(ltl.BinaryOperator.AND, formula):
        match part:
            case ltl.Unary(ltl.UnaryOperator.ALWAYS, operand):
                yield from _implied(operand)
            case ltl.Unary(ltl.UnaryOperator.NEVER, operand):
                yield from _first_phases(operand)


def _implied(formula: ltl.Formula) -> Iterator[Antecedent]:
    for part in ltl.chain_of(ltl.BinaryOperator.AND, formula):
        match part:
            case ltl.Binary(ltl.BinaryOperator.IMPLIES, left, _):
                yield Antecedent("implies", left)
            case ltl.Unary(ltl.UnaryOperator.NOT, operand):
                yield from _first_phases(operand)


def _first_phases(formula: ltl.Formula) -> Iterator[Antecedent]:
    for part in ltl.chain_of(ltl.BinaryOperator.OR, formula):
        if isinstance(part, ltl.Binary) and part.operator is ltl.BinaryOperator.THEN:
            yield Antecedent("phase", part.left)


def occurrence(rule: Rule, trigger: Antecedent, name: str) -> Rule:
    """The rule that this trigger holds at some time."""
    formula = ltl.Unary(ltl.UnaryOperator.EVENTUALLY, trigger.formula)
    return Rule(name, rule.strength, rule.variables, formula, span=rule.span, step_s=rule.step_s)
