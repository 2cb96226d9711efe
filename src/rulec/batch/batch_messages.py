"""Messages about work in several processes."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

PROCESS_LOST = Code(
    "R0708",
    title="a process was stopped before it had judged its file",
    why="With `-j N` files are judged in several processes. One of them was killed, as a system "
    "does whose memory is used up. The other files are judged; of this one nothing more is known "
    "than what was said until then. Judge it alone, or use fewer processes.",
    kind="circumstance",
)


def process_lost(file: str, signal_number: int | None) -> RulecError:
    by = "" if signal_number is None else f" by signal {signal_number}"
    return PROCESS_LOST.error(
        SourceLocation(file),
        f"the process that judged the file was stopped{by}",
        help="judge it alone, or use fewer processes: perhaps there is too little memory",
    )
