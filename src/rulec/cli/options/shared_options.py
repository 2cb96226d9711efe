"""Arguments that several verbs share, with the same words everywhere."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from fractions import Fraction
from pathlib import Path
from typing import Any, TypeVar

import click

from rulec.cli.options.shell_completion import complete_rulebooks
from rulec.report.findings.finding_formats import FORMATS

Decorated = TypeVar("Decorated", bound=Callable[..., Any])

RULEBOOK_HELP = "A rulebook: its name, its source (.rules) or a compiled one (.json)."


_SECONDS = re.compile(r"[0-9]{1,9}(?:\.[0-9]{1,17}|/[0-9]{1,9})?")


def seconds(
    context: click.Context, parameter: click.Parameter, value: str | None
) -> Fraction | None:
    """A step, as an option gives it."""
    if value is None:
        return None
    try:
        step = Fraction(value) if _SECONDS.fullmatch(value) else Fraction(0)
    except ZeroDivisionError:
        step = Fraction(0)
    if not step:
        raise click.BadParameter("it has to be a number above 0, such as 0.5 or 1/3")
    return step


def rulebook_option(function: Decorated) -> Decorated:
    """``--rulebook R``, required."""
    option = click.option(
        "-r",
        "--rulebook",
        required=True,
        metavar="R",
        help=RULEBOOK_HELP,
        shell_complete=complete_rulebooks,
    )
    return option(function)


def _day(context: click.Context, parameter: click.Parameter, value: str) -> str:
    """A date in ISO form; empty if none is given."""
    if not value:
        return ""
    from rulec.syntax.literals import why_not_a_day

    wrong = why_not_a_day(value)
    if wrong:
        raise click.BadParameter(f"`{value}` is no date: {wrong}")
    return value


def only_sources(rulebooks: Iterable[str], done: str) -> None:
    """Compiled rulebooks do not say enough to be ``done``, such as ``"be audited"``.

    Raises:
        click.UsageError: one of these is compiled.
    """
    compiled = next((rulebook for rulebook in rulebooks if rulebook.endswith(".json")), None)
    if compiled is not None:
        raise click.UsageError(f"`{compiled}` is compiled and cannot {done}; give its source")


def output_option(function: Decorated) -> Decorated:
    """``--output FILE``, required."""
    option = click.option(
        "-o",
        "--output",
        required=True,
        metavar="FILE",
        type=click.Path(dir_okay=False, path_type=Path, allow_dash=True),
        help="The file to write; `-` is standard output.",
    )
    return option(function)


def at_option(function: Decorated) -> Decorated:
    """``--at DATE``: the day whose law it is."""
    option = click.option(
        "--at",
        default="",
        callback=_day,
        metavar="DATE",
        help="The day whose law it is: rules and parameters that were not in force then are left "
        "out.  [default: that of the rulebook's `law` line, else today]",
    )
    return option(function)


def findings_options(function: Decorated) -> Decorated:
    """``--output-format`` of findings, and ``--fail-on``: which of them make the exit status 1."""
    for decorate in (
        click.option(
            "--fail-on",
            type=click.Choice(["error", "warning"]),
            default="error",
            show_default=True,
            help="What makes the exit status 1.",
        ),
        click.option(
            "--output-format",
            type=click.Choice(FORMATS),
            default="full",
            show_default=True,
            help="Text with the lines in question, a line each, JSON, GitHub annotations, "
            "SARIF 2.1.0.",
        ),
    ):
        function = decorate(function)
    return function


def json_option(function: Decorated) -> Decorated:
    """``--json``: output for machines."""
    return click.option("--json", "json_output", is_flag=True, help="Print JSON.")(function)


def traces_format_option(function: Decorated) -> Decorated:
    """``--format``: that of files of traces."""
    return click.option(
        "--format",
        "form",
        type=click.Choice(["jsonl", "csv", "parquet"]),
        help="The format of the traces.  [default: what the file's name ends with, else jsonl]",
    )(function)


def net_option(function: Decorated) -> Decorated:
    """``--net FILE``: the roads of SUMO's floating-car data."""
    return click.option(
        "--net",
        type=click.Path(dir_okay=False, path_type=Path),
        metavar="FILE",
        help="For SUMO's floating-car data: the net.  [default: the one they name, or the only one "
        "ending in .net.xml beside them]",
    )(function)
