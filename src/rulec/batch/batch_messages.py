"""Messages about work in several processes."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

PROCESS_LOST = Code("R0708")


def process_lost(file: str, signal_number: int | None, deed: str = "judged") -> RulecError:
    by = "" if signal_number is None else f" by signal {signal_number}"
    return PROCESS_LOST.error(
        SourceLocation(file),
        f"the process that {deed} the file was stopped{by}, and so was another one after it",
        help="use one process, with `-j 1`: perhaps there is too little memory",
    )
