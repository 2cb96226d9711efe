"""Messages about rules that are too long to be exported."""

from __future__ import annotations

from rulec.diagnostics import RulecError
from rulec.diagnostics.code import Code
from rulec.rulebook.rulebook_model import Rule

TOO_LONG_IN_LTL = Code("R0754")


def too_long(rule: Rule, why: str) -> RulecError:
    """The error (R0754) about a rule."""
    return TOO_LONG_IN_LTL.error(
        rule.span,
        f"rule `{rule.name}` is too long in LTL: {why}",
        help="use a larger step, or its automaton, which is small: leave out `--emit ltl`",
    )
