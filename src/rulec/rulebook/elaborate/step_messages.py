"""What is said about bounds in seconds that do not fit the step of a trace."""

from __future__ import annotations

from rulec.diagnostics import Diagnostic
from rulec.logic.bounds import NotAMultipleError
from rulec.logic.printing import time_in_words
from rulec.rulebook.elaborate.rule_messages import NOT_A_MULTIPLE
from rulec.rulebook.model import Rule


def no_multiple(rule: Rule, error: NotAMultipleError) -> Diagnostic:
    """R0407: a bound of the rule falls between two states."""
    below = error.offending // error.step_s * error.step_s
    nearest = [time_in_words(each, "s") for each in (below, below + error.step_s) if each]
    return NOT_A_MULTIPLE.at(
        error.span or rule.span,
        f"`{time_in_words(error.offending, 's')}` is not a multiple of the step, "
        f"{time_in_words(error.step_s, 's')}",
        help=f"the nearest multiples are {' and '.join(nearest)}"
        if len(nearest) > 1
        else f"the nearest multiple is {nearest[0]}",
        notes=(f"rule `{rule.name}` would have to know what happens between two states",),
    )
