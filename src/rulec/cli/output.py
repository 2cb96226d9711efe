"""What a verb opens and prints: rulebooks, errors, files, findings."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO, TYPE_CHECKING

import rulec
from rulec.cli.exit_status import ExitStatus
from rulec.diagnostics import Diagnostic, RulecError
from rulec.files import written_whole
from rulec.report.findings.diagnostics_text import print_diagnostics
from rulec.report.findings.finding_formats import render
from rulec.report.text.console import print_result
from rulec.report.text.terminal_text import wants_color
from rulec.settings import search_path

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook


def open_session(at: str = "") -> rulec.Session:
    """A session with the project's search path that prints warnings. Raises RulecError."""
    return rulec.Session(search_path(), at, print_diagnostics)


def read_machines(rulebook: str, at: str = "") -> CompiledRulebook:
    """Compile a rulebook for any step; print warnings. Raises RulecError."""
    # The tables of automata, 20 ms: not for --help.
    from rulec.api.rulebook_compilation import machines

    return machines(rulebook, search_path(), print_diagnostics, at)


@contextmanager
def errors_told(
    tell: Callable[[Sequence[Diagnostic]], object] = print_diagnostics,
) -> Iterator[None]:
    """Run a block and tell its errors instead of raising them."""
    try:
        yield
    except RulecError as error:
        tell(error.diagnostics)


@contextmanager
def output_stream(output: Path) -> Iterator[tuple[IO[bytes], str]]:
    """A stream and its name, for a file written whole or `-`.

    Raises RulecError R0702.
    """
    if str(output) == "-":
        yield sys.stdout.buffer, "standard output"
    else:
        with written_whole(output) as stream:
            yield stream, str(output)


def print_written(what: str, output: Path) -> None:
    """Say that a file has been written, unless it is standard output."""
    if str(output) != "-":
        print_result(f"wrote {what}")


def counted(number: int, noun: str) -> str:
    """A number of things, such as ``1 file`` and ``1,000 files``."""
    return f"{number:,} {noun if number == 1 else f'{noun}s'}"


def print_findings(
    findings: Sequence[Diagnostic],
    unread: Sequence[Diagnostic],
    *,
    nothing: str,
    output_format: str,
    fail_on: str,
) -> ExitStatus:
    """Print findings in sources, then why some could not be read; the exit status.

    ``nothing`` is what to say in full text if there are neither; ``fail_on`` is ``error`` or
    ``warning``.
    """
    text = render(findings, output_format, color=wants_color(sys.stdout), complete=not unread)
    if text:
        print_result(text)
    elif output_format == "full" and not unread:
        print_result(f"{nothing}, nothing found")
    print_diagnostics(unread)
    return ExitStatus.after(
        answered=not unread,
        failed=any(fail_on in ("warning", finding.severity) for finding in findings),
    )
