"""``rulec diff``: how two rulebooks differ."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.shared_options import at_option, only_sources, seconds
from rulec.cli.options.shell_completion import complete_rulebooks
from rulec.report.rulebooks.diff_formats import FORMATS

if TYPE_CHECKING:
    from rulec.analysis.diff.rulebook_comparison import RulebookDiff
    from rulec.diagnostics import RulecError
    from rulec.rulebook.model import Rulebook


@click.command()
@click.argument("rulebooks", nargs=-1, metavar="RULEBOOK...", shell_complete=complete_rulebooks)
@click.option(
    "--all",
    "every",
    is_flag=True,
    help="Compare every two of the rulebooks named, or of all that there are.",
)
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
    "--witnesses",
    "most",
    type=click.IntRange(1, 100),
    default=3,
    show_default=True,
    metavar="N",
    help="Show up to N traces for every difference, each for a reason of its own.",
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
    every: bool,
    patterns: tuple[str, ...],
    step_s: Fraction | None,
    most: int,
    output_format: str,
    output: str | None,
    witness: str | None,
    at: str,
) -> int:
    """Say which rules of a first RULEBOOK are stricter or laxer than those of a second, or neither.

    Both are names or paths of sources. For every difference there are short traces that one of
    them forbids and the other one allows. With --all there is an overview of many rulebooks.

    Exit status: 0 no difference, 1 there are some, 2 a question could not be answered.
    """
    from rulec.report.rulebooks.diff_formats import render
    from rulec.report.text.console import put_result

    only_sources(rulebooks, "be compared")
    if every:
        if witness is not None:
            raise click.UsageError("--witness is for two rulebooks, not for --all")
        return _all(rulebooks, patterns, step_s, output_format, output, at)
    if len(rulebooks) != 2:
        raise click.UsageError("name the two rulebooks that are to be compared, or say --all")
    first, second = rulebooks
    found = _difference(first, second, patterns, step_s, at, most)
    if witness is not None:
        _write_witnesses(found, witness)
    put_result(render(found, output_format), output)
    if not found.is_complete:
        return ExitStatus.NOT_ANSWERED
    return ExitStatus.OK if found.is_none else ExitStatus.FOUND


def _difference(
    first: str,
    second: str,
    patterns: tuple[str, ...],
    step_s: Fraction | None,
    at: str,
    most: int,
) -> RulebookDiff:
    from rulec.api.rulebook_questions import compare_rulebooks
    from rulec.report.text.console import print_diagnostics, progress
    from rulec.settings import search_path

    with progress("comparing", None) as tell:
        return compare_rulebooks(
            first, second, search_path(), at, patterns, step_s, print_diagnostics, tell, most
        )


def _all(
    names: tuple[str, ...],
    patterns: tuple[str, ...],
    step_s: Fraction | None,
    output_format: str,
    output: str | None,
    at: str,
) -> int:
    from rulec.analysis.diff.comparison_matrix import comparison_matrix, steps
    from rulec.report.rulebooks.matrix_report import render
    from rulec.report.text.console import print_aside, progress, put_result

    books, failed = _read_all(names, at)
    alone = [] if names else _alone(books)
    books = [book for book in books if book.name not in alone]
    if len(books) < 2:
        print_aside("there are no two rulebooks to compare")
        return ExitStatus.NOT_ANSWERED
    with progress("comparing", steps(books, patterns)) as tell:
        found = comparison_matrix(books, patterns, step_s, tell)
    if alone:
        print_aside(f"left out, for they share no rule with others: {', '.join(alone)}")
    put_result(render(found, output_format), output)
    if failed or not found.is_complete:
        return ExitStatus.NOT_ANSWERED
    return ExitStatus.OK if found.is_uniform else ExitStatus.FOUND


def _read_all(names: tuple[str, ...], at: str) -> tuple[list[Rulebook], bool]:
    """The rulebooks that can be read; was there another one?"""
    from rulec.diagnostics import RulecError
    from rulec.report.text.console import print_diagnostics
    from rulec.rulebook.files.search_path import available_rulebooks
    from rulec.settings import search_path

    folders = search_path()
    wanted = dict.fromkeys(names or available_rulebooks(folders))
    answers = [_read(name, folders, at) for name in wanted]
    for answer in answers:
        if isinstance(answer, RulecError):
            print_diagnostics(answer.diagnostics)
    books = [one for one in answers if not isinstance(one, RulecError)]
    # Treaties before those that build upon them, so that theirs is law A.
    books.sort(key=lambda book: len(book.extends))
    return books, len(books) < len(answers)


def _read(name: str, folders: Sequence[Path], at: str) -> Rulebook | RulecError:
    from rulec.diagnostics import RulecError
    from rulec.rulebook.loader import load_rulebook

    try:
        return load_rulebook(name, folders, at)
    except RulecError as error:
        return error


def _alone(books: list[Rulebook]) -> list[str]:
    """Those that share no rule's name with any other."""
    named = {book.name: {rule.name for rule in book.rules} for book in books}
    return [
        name
        for name, rules in named.items()
        if not any(rules & others for other, others in named.items() if other != name)
    ]


def _write_witnesses(found: RulebookDiff, file: str) -> None:
    from rulec.files import written_whole
    from rulec.report.text.console import print_aside
    from rulec.trace.formats.json_lines import write_traces

    with written_whole(Path(file)) as stream:
        number = write_traces(found.witnesses, stream)
    print_aside(f"wrote {number:,} {'trace' if number == 1 else 'traces'} to {file}")
