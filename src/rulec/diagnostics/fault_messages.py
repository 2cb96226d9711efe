"""Faults of rulec itself: an exception costs one part of an answer, and says what to report."""

from __future__ import annotations

import os
from collections import deque
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path

from rulec.diagnostics.code import Code
from rulec.diagnostics.diagnostic import (
    Diagnostic,
    RulecError,
    SourceLocation,
    as_answer,
    with_place,
)
from rulec.version import __version__

FAULT = Code("R0790")

SAYS = "a fault of rulec"
"""What every message of a fault says, also in tables of findings."""

NOT_FAULTS = (RulecError, OSError, MemoryError)
"""Exceptions that are answers, or mean that the system refuses something, or a limit is reached."""

_PACKAGE = f"{Path(__file__).parents[1]}{os.sep}"
_LONGEST = 160


def fault_of(problem: Exception, what: str = "", place: SourceLocation | None = None) -> RulecError:
    """The exception as an answer: ``what`` is lost by it. Raises those that are no faults."""
    if isinstance(problem, NOT_FAULTS):
        raise problem
    # Late import, only after a fault (50 ms).
    from traceback import extract_tb, format_exception

    # The innermost function of rulec that was running
    frames = [x for x in extract_tb(problem.__traceback__) if x.filename.startswith(_PACKAGE)]
    where = [f"{x.name}, {x.filename[len(_PACKAGE) :]}:{x.lineno}" for x in frames[-1:]]
    text = " ".join(f"{type(problem).__name__} {problem}".split())
    traced = format_exception(problem) if os.environ.get("RULEC_TRACEBACK") else []
    fault = FAULT.error(
        place,
        f"{what and f'{what}: '}{SAYS} {__version__} ({'; '.join([text[:_LONGEST], *where])})",
        help="please report this line, with the input",
        notes=tuple([line for part in traced for line in part.splitlines()]),
    )
    _FOUND.append(fault.diagnostics[0])
    return as_answer(fault)


_FOUND: deque[Diagnostic] = deque(maxlen=100)
"""The last faults that this process has found."""


def faults_found() -> Sequence[Diagnostic]:
    """The faults that this process has found since this was last asked."""
    found = list(dict.fromkeys(_FOUND))
    _FOUND.clear()
    return found


@contextmanager
def contained(what: str = "", place: SourceLocation | None = None) -> Iterator[None]:
    """Run a block; a fault is raised as R0790, and diagnostics without a place get this one."""
    try:
        yield
    except RulecError as error:
        if type(error) is not RulecError:
            raise  # one that ends more than this
        raise with_place(error, place) from error.__cause__
    except Exception as problem:
        raise fault_of(problem, what, place) from problem


def is_fault(error: RulecError) -> bool:
    """Whether an error is a fault of rulec."""
    return any(diagnostic.code == FAULT.code for diagnostic in error.diagnostics)
