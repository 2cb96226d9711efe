"""Messages about traces that do not fit a vocabulary or a rulebook."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

UNDECLARED_NAME = Code("R0502")

UNFITTING_VALUE = Code("R0503")

MISSING_VALUE = Code("R0504")

VIOLATED_AXIOM = Code("R0508")

UNRESTORABLE_MONITOR = Code("R0510")

STEP_TOO_FAR_OFF = Code("R0724")


def missing_value(
    subject: tuple[str, tuple[str, ...]], where: str, rule: str, place: SourceLocation | None
) -> RulecError:
    """The error (R0504) about a state that lacks the value of a name for some objects."""
    name, items = subject
    of = f" of `{', '.join(map(str, items))}`" if items else ""  # a program may count its objects
    return MISSING_VALUE.error(
        place,
        f"{where} does not say the `{name}`{of}, which rule `{rule}` needs",
        help="say it in every state, `null` where it is not known, or declare a default for it",
    )
