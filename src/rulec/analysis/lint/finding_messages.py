"""Messages about findings from the automata of rules."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic
from rulec.diagnostics.code import Code
from rulec.rulebook.rulebook_model import Rule
from rulec.witnesses.undecided import UndecidedError

CANNOT_BE_VIOLATED = Code("R0801")

CANNOT_BE_KEPT = Code("R0802")

ADDS_NOTHING = Code("R0803")

CONFLICTING_RULES = Code("R0804")

NEVER_TRIGGERED = Code("R0805")

WEAKER_THAN_BASE = Code("R0806")

CONTRADICTING_RULES = Code("R0808")

NOT_DECIDED = Code("R0807")


def undecided_diagnostic(rule: Rule, question: str, problem: UndecidedError) -> Diagnostic:
    """The warning (R0807) that a question about a rule was left open."""
    return NOT_DECIDED.at(
        rule.span,
        f"undecided for rule `{rule.name}` whether {question}: {problem}",
        help="split the rule: separate rules are analysed one by one",
        severity="warning",
    )
