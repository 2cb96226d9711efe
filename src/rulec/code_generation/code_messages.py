"""Messages about code that cannot be generated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from rulec.diagnostics import RulecError, SourceLocation
from rulec.diagnostics.code import Code

NO_MONITOR_IN_C = Code(
    "R0750",
    title="there can be no monitor in C",
    why="A monitor in C has a size that is known when it is compiled, and tables whose entries "
    "have 16 bits: a rule has at most 16,383 states and 6 variables, and all rules together 65,535 "
    "choices of objects, with as many objects as `--objects` allows. It is for one step: of a "
    "rulebook that was compiled for several one has to be chosen. And a rulebook without rules has "
    "nothing to watch. Types are those of the vocabulary.",
    bad="rulec compile esterle2019 --emit c --objects lorry=2 -o build\n",
    good="rulec compile esterle2019 --emit c --objects vehicle=2 -o build\n",
    kind="command",
)


def too_large(excess: str, way_out: str = "") -> RulecError:
    """The error (R0750) about what is too large, or not there."""
    return NO_MONITOR_IN_C.error(
        None,
        f"there can be no monitor in C: {excess}",
        help=way_out or "split the rule, or leave it out",
    )


def no_engine_in_c(error: RulecError, place: SourceLocation | None) -> RulecError:
    """The same of a trace that was to be judged in C."""
    way_out = "judge it with `--engine python`"
    return RulecError(
        [replace(diagnostic, place=place, help=way_out) for diagnostic in error.diagnostics]
    )


NO_MONITOR_COMPILER = Code(
    "R0751",
    title="there is no compiler for a monitor",
    why="Monitors are proved, and judge as the engine `c`, after the user's own compiler has "
    "compiled them: in C the one that the environment variable `CC` names, or `cc`, in Rust "
    "`rustc`. rulec brings none along, and takes no other engine instead. To write a monitor takes "
    "none.",
    kind="circumstance",
)

MONITOR_COMPILER_FAILED = Code(
    "R0752",
    title="the compiler of a monitor has failed",
    why="What rulec writes is C99, or Rust of the edition 2021, and has to compile without a "
    "warning. The message has the command and what the compiler said. If it is no compiler for "
    "C99, name another one in the environment variable `CC`; if `rustc` is older than 1.56, get a "
    "newer one; else please report the rulebook.",
    kind="circumstance",
)


def no_compiler(command: str) -> RulecError:
    """The error (R0751) about a C compiler that is not there."""
    return NO_MONITOR_COMPILER.error(
        None,
        f"there is no C compiler: `{command}` is not found",
        help="install one, or name it in the environment variable `CC`",
    )


def unreadable_command(command: str, problem: str) -> RulecError:
    """The error (R0751) about a ``CC`` that is no command."""
    return NO_MONITOR_COMPILER.error(
        None,
        f"the environment variable `CC` is no command: `{command}` ({problem})",
        help="name a compiler in it as in a shell, such as `gcc -m32`, or unset it",
    )


def no_rust_compiler() -> RulecError:
    """The error (R0751) about ``rustc``, which is not there."""
    return NO_MONITOR_COMPILER.error(
        None,
        "there is no Rust compiler: `rustc` is not found",
        help="install Rust, or put its folder on the `PATH`; without `--prove` the monitor is "
        "written all the same",
    )


def compiler_failed(command: str, output: str, status: int | None = None) -> RulecError:
    """The error (R0752) about a compiler that has failed, with what it said, or its status."""
    # A message has one line.
    first = "; ".join(line.strip() for line in output.strip().splitlines()[:5] if line.strip())
    if not first:
        ended = "ended" if status is None else f"ended with status {status}"
        first = f"it {ended if status is None or status >= 0 else f'was ended by signal {-status}'}"
        first += " and said nothing"
    is_rust = command.startswith("rustc")
    another = "name another compiler in `CC`"
    if is_rust and "rustup" in output:
        another = "rustup has no such compiler here: `rustup default stable` installs one"
    elif is_rust:
        another = "update Rust by `rustup update`"
    return MONITOR_COMPILER_FAILED.error(None, f"`{command}` has failed: {first}", help=another)


MONITOR_DIFFERS = Code(
    "R0753",
    title="a monitor in C is not what its tables say",
    why="With `compile --emit c --prove`, rulec compiles what it is about to write and holds it "
    "against the tables and the monitor in Python. If they differ there is a mistake in rulec or "
    "in the C compiler, none in the rulebook, and nothing is written. Please report the rulebook "
    "and the compiler.",
    kind="circumstance",
)


def differs(differences: Sequence[str]) -> RulecError:
    """The error (R0753) about what differs."""
    return MONITOR_DIFFERS.error(
        None,
        f"the monitor in C is not what its tables say: {'; '.join(differences[:3])}",
        help="try another compiler (`CC`), and report this",
    )
