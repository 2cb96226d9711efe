"""Destinations of a verb's answer, and the exit status of findings."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import IO

from rulec.cli.exit_status import ExitStatus
from rulec.diagnostics import Diagnostic
from rulec.files import written_whole
from rulec.report.findings.diagnostics_text import print_diagnostics
from rulec.report.findings.finding_formats import render
from rulec.report.text.console import print_result
from rulec.report.text.terminal_text import wants_color


@contextmanager
def output_stream(output: Path) -> Iterator[tuple[IO[bytes], str]]:
    """A stream and its name, for a file written whole or `-`.

    Raises RulecError R0702.
    """
    if is_standard_output(output):
        yield sys.stdout.buffer, "standard output"
    else:
        with written_whole(output) as stream:
            yield stream, str(output)


def is_standard_output(output: Path) -> bool:
    """Test for standard output, after which no file is reported."""
    return str(output) == "-"


def print_written(what: str, output: Path) -> None:
    """Say that a file has been written, unless it is standard output."""
    if not is_standard_output(output):
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
    """Print findings in sources, then reasons for unread ones.

    Args:
        findings: what is wrong or odd.
        unread: why files or rulebooks could not be read.
        nothing: what to say in full text if there are neither.
        output_format: one of FORMATS.
        fail_on: ``error`` or ``warning``: what makes the exit status 1.
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
