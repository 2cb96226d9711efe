"""Messages about rules that are too long to be exported."""

from __future__ import annotations

from rulec.diagnostics import RulecError
from rulec.diagnostics.code import Code
from rulec.rulebook.rulebook_model import Rule

TOO_LONG_IN_LTL = Code(
    "R0754",
    title="a rule is too long in LTL",
    why="Other tools' formulas have no bounds, so each bound is written out state by state, and "
    "nested bounds multiply. A rule may have bounds of 10,000 steps and 2,000,000 characters of "
    "text. Its automaton is equivalent and small: use `rulec compile` without `--emit ltl`.",
    bad="rulec compile un-r79 --emit ltl --step 0.⟪0001|5⟫ -o build\n",
    kind="command",
)


def too_long(rule: Rule, why: str) -> RulecError:
    """The error (R0754) about a rule."""
    return TOO_LONG_IN_LTL.error(
        rule.span,
        f"rule `{rule.name}` is too long in LTL: {why}",
        help="use a larger step, or its automaton, which is small: leave out `--emit ltl`",
    )
