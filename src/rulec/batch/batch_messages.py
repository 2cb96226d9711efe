"""Messages about work in several processes."""

from __future__ import annotations

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

PROCESS_LOST = Code(
    "R0708",
    title="a process was killed before it had judged its file",
    why="Files are judged in several processes, as set by `-j N`. One of them was killed, for "
    "instance because memory ran out; another process judged the file again and was killed, too. "
    "The other files are judged; for this one nothing more is known than was reported until then. "
    "Use fewer processes.",
    kind="circumstance",
)


def process_lost(file: str, signal_number: int | None, deed: str = "judged") -> RulecError:
    by = "" if signal_number is None else f" by signal {signal_number}"
    return PROCESS_LOST.error(
        SourceLocation(file),
        f"the process that {deed} the file was stopped{by}, and so was another one after it",
        help="use one process, with `-j 1`: perhaps there is too little memory",
    )
