"""Messages about code that cannot be generated."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

NO_MONITOR_IN_C = Code(
    "R0750",
    title="a monitor in C is not possible",
    why="A monitor in C has a fixed size and tables with entries of 16 bits: a rule may have at "
    "most 16,383 states and 6 variables, and all rules together 65,535 choices of objects, for as "
    "many objects as `--objects` allows. It has one step: for a rulebook compiled for several "
    "steps one must be chosen. A rulebook without rules has nothing to monitor. Types must be "
    "those of the vocabulary.",
    bad="rulec compile esterle2019 --emit c --objects lorry=2 -o build\n",
    good="rulec compile esterle2019 --emit c --objects vehicle=2 -o build\n",
    kind="command",
)


def too_large(excess: str, way_out: str = "") -> RulecError:
    """The error (R0750) about a part that is too large or missing."""
    return NO_MONITOR_IN_C.error(
        None,
        f"a monitor in C is not possible: {excess}",
        help=way_out or "split the rule, or leave it out",
    )


NO_MONITOR_COMPILER = Code(
    "R0751",
    title="there is no compiler for the monitor",
    why="Proving a monitor needs a compiler for C: the one named by the environment variable "
    "`CC`, or `cc`. rulec does not include one. Writing a monitor needs none.",
    kind="circumstance",
)

MONITOR_COMPILER_FAILED = Code(
    "R0752",
    title="compiling the monitor has failed",
    why="The monitor is C99 and must compile without a warning. The message shows the command and "
    "the compiler's output. If the compiler does not support C99, name another one in the "
    "environment variable `CC`; otherwise please report the rulebook.",
    kind="circumstance",
)


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


MONITOR_DIFFERS = Code(
    "R0753",
    title="a monitor in C does not match its tables",
    why="With `compile --emit c --prove`, rulec compiles the monitor and compares it with the "
    "tables and the monitor in Python. If they differ, there is a bug in rulec or in the C "
    "compiler; the rulebook is not at fault, and nothing is written. Please report the rulebook "
    "and the compiler.",
    kind="circumstance",
)


def differs(differences: Sequence[str]) -> RulecError:
    """The error (R0753) about the differences found."""
    return MONITOR_DIFFERS.error(
        None,
        f"the monitor in C differs from its tables: {'; '.join(differences[:3])}",
        help="try another compiler (`CC`), and report this",
    )


OTHERS_FILE = Code(
    "R0755",
    title="a monitor would replace a build file that is not its own",
    why="A monitor comes with files whose names are the same for every program: a Makefile and "
    "CMakeLists.txt, Cargo.toml, build.rs and src/lib.rs, or package.xml. Such a file is replaced "
    "only if rulec has generated it for the same monitor.",
    bad="mkdir build\necho all: > build/Makefile\nrulec compile esterle2019 --emit c -o build\n",
    good="rulec compile esterle2019 --emit c -o build\n",
    kind="command",
)


def others_file(file: Path) -> RulecError:
    """The error about a build file that belongs to something else."""
    return OTHERS_FILE.error(
        SourceLocation(str(file)),
        "the file is there already, and was not generated for this monitor",
        help="write the monitor to a folder of its own, or delete the file",
    )
