"""Messages about compiled rulebooks."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

AUTOMATON_TOO_LARGE = Code("R0401")

DAMAGED_BUNDLE = Code("R0404")

CHANGED_BUNDLE = Code("R0410")

NO_DIGEST = Code("R0411")

NOT_SIGNED = Code("R0412")

NO_KEY = Code("R0413")

NO_CRYPTOGRAPHY = Code("R0414")

OTHER_STEP = Code("R0507")

OTHER_DAY = Code("R0419")


def other_day(file: str, compiled: str, wanted: str) -> RulecError:
    """A file compiled for the law of one day, where that of another one is wanted."""
    return OTHER_DAY.error(
        SourceLocation(file),
        f"this rulebook was compiled for the law of {compiled}, not of {wanted}",
        help=f"compile its source with `--at {wanted}`, or leave out `--at`",
    )
