"""``rulec diff``: how two rulebooks differ."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rulec.cli.arguments import at_option, complete_rulebooks, seconds
from rulec.cli.exit_status import ExitStatus
from rulec.report.differences import FORMATS

if TYPE_CHECKING:
    from rulec.analysis.difference import Difference


@click.command()
@click.argument("rulebooks", nargs=-1, metavar="FIRST SECOND", shell_complete=complete_rulebooks)
@click.option(
    "--rule",
    "patterns",
    multiple=True,
    metavar="PATTERN",
    help="Only rules like PATTERN; `*` and `?` are wild. May be given several times.",
)
@click.option(
    "--step",
    "step_s",
    callback=seconds,
    metavar="S",
    help="The step of the traces that rules with bounds in seconds are compared on, in s.  "
    "[default: one that divides the steps of their examples]",
)
@click.option(
    "--output-format",
    type=click.Choice(FORMATS),
    default="text",
    show_default=True,
    help="Text, Markdown, JSON, a page, or a table with a line for each rule.",
)
@click.option(
    "-o", "--output", type=click.Path(dir_okay=False), metavar="FILE", help="Write to FILE."
)
@click.option(
    "--witness",
    type=click.Path(dir_okay=False),
    metavar="FILE",
    help="Write the traces that one forbids and the other allows to FILE, as JSON Lines.",
)
@at_option
def command(
    rulebooks: tuple[str, ...],
    patterns: tuple[str, ...],
    step_s: Fraction | None,
    output_format: str,
    output: str | None,
    witness: str | None,
    at: str,
) -> int:
    """Say which rules of FIRST are stricter or laxer than those of SECOND, or neither.

    Both are names of rulebooks or paths of sources. For every difference there is a shortest trace
    that one of them forbids and the other one allows.

    Exit status: 0 no difference, 1 there are some, 2 a question could not be answered.
    """
    from rulec.report.console import print_diagnostics, print_result, progress
    from rulec.report.differences import render
    from rulec.settings import search_path
    from rulec.workflow import compare_rulebooks

    if len(rulebooks) != 2:
        raise click.UsageError("name the two rulebooks that are to be compared")
    first, second = rulebooks
    with progress("comparing", None) as tell:
        found = compare_rulebooks(
            first, second, search_path(), at, patterns, step_s, print_diagnostics, tell
        )
    if witness is not None:
        _write_witnesses(found, witness)
    text = render(found, output_format)
    if output is None:
        print_result(text)
    else:
        _write(text, output)
    if not found.is_complete:
        return ExitStatus.NOT_ANSWERED
    return ExitStatus.OK if found.is_none else ExitStatus.FOUND


def _write(text: str, output: str) -> None:
    from rulec.files import written_whole
    from rulec.report.console import print_aside

    with written_whole(Path(output)) as stream:
        stream.write(f"{click.unstyle(text)}\n".encode())
    print_aside(f"wrote {output}")


def _write_witnesses(found: Difference, file: str) -> None:
    from rulec.files import written_whole
    from rulec.report.console import print_aside
    from rulec.trace.json_lines import write_traces

    with written_whole(Path(file)) as stream:
        number = write_traces(found.witnesses, stream)
    print_aside(f"wrote {number:,} {'trace' if number == 1 else 'traces'} to {file}")
