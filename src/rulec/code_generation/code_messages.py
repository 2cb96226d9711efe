"""Messages about code that cannot be generated."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

NO_MONITOR_IN_C = Code("R0750")


def too_large(excess: str, way_out: str = "") -> RulecError:
    """The error (R0750) about a part that is too large or missing."""
    return NO_MONITOR_IN_C.error(
        None,
        f"a monitor in C is not possible: {excess}",
        help=way_out or "split the rule, or leave it out",
    )


NO_MONITOR_COMPILER = Code("R0751")

MONITOR_COMPILER_FAILED = Code("R0752")


def no_compiler(command: str) -> RulecError:
    """The error (R0751) about a missing C compiler."""
    return NO_MONITOR_COMPILER.error(
        None,
        f"there is no C compiler: `{command}` is not found",
        help="install one, or name it in the environment variable `CC`",
    )


def unreadable_command(command: str, problem: str) -> RulecError:
    """The error (R0751) about a ``CC`` that is not a command."""
    return NO_MONITOR_COMPILER.error(
        None,
        f"the environment variable `CC` is not a command: `{command}` ({problem})",
        help="name a compiler in it as in a shell, such as `gcc -O1`, or unset it",
    )


def compiler_failed(command: str, output: str, status: int | None = None) -> RulecError:
    """The error (R0752) about a failed compiler, with its output or its status."""
    # A message is a single line.
    first = "; ".join(line.strip() for line in output.strip().splitlines()[:5] if line.strip())
    if not first:
        ended = "ended" if status is None else f"ended with status {status}"
        first = f"it {ended if status is None or status >= 0 else f'was ended by signal {-status}'}"
        first += " without any output"
    return MONITOR_COMPILER_FAILED.error(
        None, f"`{command}` has failed: {first}", help="name another compiler in `CC`"
    )


MONITOR_DIFFERS = Code("R0753")


def differs(differences: Sequence[str]) -> RulecError:
    """The error (R0753) about the differences found."""
    return MONITOR_DIFFERS.error(
        None,
        f"the monitor in C differs from its tables: {'; '.join(differences[:3])}",
        help="try another compiler (`CC`), and report this",
    )


OTHERS_FILE = Code("R0755")


def others_file(file: Path) -> RulecError:
    """The error about a build file that belongs to something else."""
    return OTHERS_FILE.error(
        SourceLocation(str(file)),
        "the file is there already, and was not generated for this monitor",
        help="write the monitor to a folder of its own, or delete the file",
    )
