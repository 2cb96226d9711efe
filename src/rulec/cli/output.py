"""Opening of inputs and printing of results, shared by verbs."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import partial
from glob import has_magic
from pathlib import Path
from typing import IO, TYPE_CHECKING, cast

import click

import rulec
from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.output_options import Output
from rulec.diagnostics import Diagnostic, RulecError
from rulec.diagnostics.fault_messages import fault_of
from rulec.files.left_alone import LeftAlone, in_words
from rulec.files.written_files import written_whole
from rulec.report.findings.diagnostics_text import (
    message_width,
    print_diagnostics,
    render_diagnostics,
)
from rulec.report.findings.finding_formats import as_annotations, as_lines
from rulec.report.text.console import (
    PAGE_WIDTH,
    page_width,
    print_line,
    print_remark,
    print_result,
)
from rulec.report.text.outgoing import OutgoingLines, outgoing
from rulec.report.text.terminal_text import wants_color
from rulec.rulebook.files.search_path import available_rulebooks
from rulec.settings import exclusion, search_path

if TYPE_CHECKING:
    from rulec.report.pictures.drawing.styles import Theme

_REPORTS = ("html", "junit", "sarif", "svg")
"""Formats for people and for display in other programs."""

_DATA = ("csv", "jsonl")
"""Formats that are read again: files keep names unchanged, a log shows them escaped."""


def open_session(at: str = "") -> rulec.Session:
    """A session with the project's search path that prints warnings. Raises RulecError."""
    return rulec.Session(search_path(), at, print_diagnostics)


def read_machines(rulebook: str, at: str = "") -> lazy.CompiledRulebook:
    """Compile a rulebook for any step; print warnings. Raises RulecError."""
    return lazy.machines(rulebook, search_path(), print_diagnostics, at)


@contextmanager
def errors_told(
    tell: Callable[[Sequence[Diagnostic]], object] = print_diagnostics,
) -> Iterator[None]:
    """Run a block, and pass its errors to ``tell`` instead of raising them."""
    try:
        yield
    except RulecError as error:
        tell(error.diagnostics)
    except (click.ClickException, click.exceptions.Exit, click.Abort):
        raise
    except Exception as problem:
        tell(fault_of(problem).diagnostics)


@contextmanager
def output_stream(to: Output) -> Iterator[tuple[IO[bytes], str]]:
    """A stream and its name, for a file written whole or standard output.

    Raises RulecError R0702.
    """
    if to.is_file:
        with written_whole(Path(to.path)) as stream, _gate(stream, to) as gate:
            yield gate, to.path
    else:
        with _gate(sys.stdout.buffer, to) as gate:
            yield gate, "standard output"


@contextmanager
def _gate(stream: IO[bytes], to: Output) -> Iterator[IO[bytes]]:
    """A stream that blocks control sequences for terminals and commands for runners."""
    if to.form in _REPORTS or (to.form in _DATA and not to.is_file):
        lines = OutgoingLines(stream, to.form)
        yield cast("IO[bytes]", lines)
        lines.finish()
    else:
        yield stream


def print_written(content: str, to: Output) -> None:
    """Say that a file has been written, unless it is standard output."""
    if to.is_file:
        print_line(f"wrote {content}")


def put_picture(drawing: lazy.Drawing, to: Output, theme: Theme = "auto") -> None:
    """Write a picture in the format of the output. Raises RulecError R0702, R0707."""
    data = lazy.picture_formats.as_bytes(drawing, to.form, to.path, theme)
    with output_stream(to) as (stream, _):
        stream.write(data)
    print_written(to.path, to)


def put_answer(text: str, to: Output) -> None:
    """Write the answer to standard output, or to a file. Raises RulecError R0702."""
    with answer_lines(to) as write:
        if text:
            write(text)
    print_written(to.path, to)


@contextmanager
def answer_lines(to: Output) -> Iterator[Callable[[str], None]]:
    """A function that takes lines: printed at once, or written to a file as a whole.

    Raises RulecError R0702.
    """
    if not to.is_file:
        yield partial(print_result, form=to.form)
        return
    with written_whole(Path(to.path)) as stream:
        yield line_writer(stream, to.form)


def line_writer(stream: IO[bytes], form: str) -> Callable[[str], None]:
    """A function that writes lines to a file, without colours."""

    def write(text: str) -> None:
        shown = outgoing(click.unstyle(text), form)
        stream.write(f"{shown}\n".encode("utf-8", "backslashreplace"))

    return write


def width_of(to: Output) -> int:
    """The width of a text in characters; on a terminal that of its window."""
    return PAGE_WIDTH if to.is_file else page_width()


def print_lost(deed: str, subject: str, signal_number: int | None) -> None:
    """Report a stopped process by its ``deed``, such as "judged", and that it is redone."""
    by = "" if signal_number is None else f" by signal {signal_number}"
    print_remark(
        f"rulec: the process that {deed} {subject} was stopped{by}; another one repeats the work"
    )


def print_left_alone(left_alone: Sequence[LeftAlone], *, verbose: bool) -> None:
    """Print what was skipped: each item, or the number of each kind."""
    if verbose:
        for file in left_alone:
            print_remark(f"left alone: {file.path}: {file.why}")
    elif left_alone:
        print_remark(f"left alone: {in_words(left_alone)}")


def sources_of_rulebooks(references: Sequence[str], lack: str) -> tuple[str, ...]:
    """Rulebooks as from ``rulebooks_named``, refusing compiled ones.

    ``lack`` is the reason, such as ``"cannot be audited"``. Raises click.UsageError.
    """
    for reference in references:
        if reference.endswith(".json"):
            raise click.UsageError(f"`{reference}` is compiled and {lack}; give its source")
    return rulebooks_named(references)


def rulebooks_named(references: Sequence[str]) -> tuple[str, ...]:
    """Rulebooks by name or path, with folders and patterns replaced by their rulebooks.

    Raises RulecError R0733 for a folder without any.
    """
    if not any(has_magic(reference) or os.path.isdir(reference) for reference in references):  # noqa: PTH112
        return tuple(references)
    names, on_the_way = lazy.named_rulebooks(references, search_path(), exclusion())
    if on_the_way.refused:
        raise RulecError(on_the_way.refused)
    print_left_alone(on_the_way.left_alone, verbose=False)
    return tuple(names)


def books_and_rule(arguments: Sequence[str], verb: str) -> tuple[tuple[str, ...], str | None]:
    """The rulebooks and the rule in a verb's arguments; the last argument may be a rule."""
    *before, last = arguments
    if before and has_magic(last) and "/" not in last and not any(Path().glob(last)):
        raise click.UsageError(
            f"`{last}` is no rulebook; for rules that match it write `--rule '{last}'`"
        )
    if _is_rulebook(last):
        return rulebooks_named(arguments), None
    if before:
        return rulebooks_named(before), last
    if books := lazy.rulebooks_with_rule(last, search_path()):
        raise click.UsageError(
            f"`{last}` is a rule; give its rulebook, too: `rulec {verb} {books[0]} {last}`"
        )
    return rulebooks_named(arguments), None


def _is_rulebook(argument: str) -> bool:
    is_path = "/" in argument or argument.endswith((".rules", ".json")) or has_magic(argument)
    return is_path or argument in available_rulebooks(search_path())


def told_apart(references: Sequence[str]) -> dict[str, str]:
    """Rulebooks by their files' names without extensions.

    Raises:
        click.UsageError: two of them have the same name.
    """
    named: dict[str, str] = {}
    for reference in references:
        other = named.setdefault(Path(reference).stem, reference)
        if other != reference:
            raise click.UsageError(
                f"`{other}` and `{reference}` would be written to the same files; "
                "give each a separate call with a separate folder"
            )
    return named


def findings_in(
    form: str,
    diagnostics: Sequence[Diagnostic],
    *,
    color: bool,
    complete: bool,
    width: int = 0,
) -> str:
    """Diagnostics in a format of findings about rulebooks.

    ``complete``: all inputs could be read; ``width`` is that of a terminal, 0 elsewhere.
    """
    match form:
        case "concise":
            return as_lines(diagnostics)
        case "json":
            return lazy.diagnostics_as_json(diagnostics)
        case "github":
            return as_annotations(diagnostics)
        case "sarif":
            return lazy.as_sarif(diagnostics, complete=complete)
        case _:
            return render_diagnostics(diagnostics, color, width=width).rstrip("\n")


def print_findings(
    findings: Sequence[Diagnostic],
    unread: Sequence[Diagnostic],
    *,
    nothing: str,
    to: Output,
    fail_on: str,
) -> ExitStatus:
    """Print findings in sources, then the errors of sources not read; returns the exit status.

    ``nothing`` is the text if there are neither; ``fail_on`` is ``error`` or ``warning``.
    """
    text = findings_in(
        to.form,
        findings,
        color=wants_color(sys.stdout),
        complete=not unread,
        width=0 if to.is_file else message_width(sys.stdout),
    )
    if not text and to.form == "full" and not unread:
        text = nothing
    put_answer(text, to)
    print_diagnostics(unread)
    return ExitStatus.after(
        answered=not unread,
        failed=any(fail_on in ("warning", finding.severity) for finding in findings),
    )
