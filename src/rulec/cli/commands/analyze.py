"""``rulec analyze``: what the automata of rules tell about rulebooks."""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import click

from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.shared_options import at_option, findings_options, only_sources
from rulec.cli.options.shell_completion import complete_rulebooks

if TYPE_CHECKING:
    from rulec.diagnostics import Diagnostic, RulecError


@click.command()
@click.argument(
    "rulebooks", nargs=-1, required=True, metavar="RULEBOOK...", shell_complete=complete_rulebooks
)
@findings_options
@at_option
def command(rulebooks: tuple[str, ...], output_format: str, fail_on: str, at: str) -> int:
    """Find out what is odd in RULEBOOKs (names, or paths of sources) by their automata.

    That is: rules that nothing can violate or keep, that others imply, or that wait for what never
    happens; hard rules that cannot both be kept; and rules weaker than those of the rulebook that
    is extended. With traces that show it.

    Exit status: 0 no mistakes, 1 there are some, 2 a question could not be answered.
    """
    from rulec.analysis.lint.finding_messages import NOT_DECIDED
    from rulec.diagnostics import RulecError
    from rulec.report.findings.finding_formats import render
    from rulec.report.text.console import print_diagnostics, print_result, wants_color

    only_sources(rulebooks, "be analyzed")
    diagnostics: list[Diagnostic] = []
    unread: list[Diagnostic] = []
    for answer in (_findings(rulebook, at) for rulebook in dict.fromkeys(rulebooks)):
        if isinstance(answer, RulecError):
            unread += answer.diagnostics
        else:
            diagnostics += answer
    diagnostics = list(dict.fromkeys(diagnostics))
    text = render(diagnostics, output_format, color=wants_color(sys.stdout), complete=not unread)
    if text:
        print_result(text)
    elif output_format == "full" and not unread:
        number = len(rulebooks)
        print_result(f"{number:,} {'rulebook' if number == 1 else 'rulebooks'}, nothing found")
    print_diagnostics(unread)
    if unread or any(diagnostic.code == NOT_DECIDED.code for diagnostic in diagnostics):
        return ExitStatus.NOT_ANSWERED
    fatal = any(fail_on in ("warning", diagnostic.severity) for diagnostic in diagnostics)
    return ExitStatus.FOUND if fatal else ExitStatus.OK


def _findings(rulebook: str, at: str) -> tuple[Diagnostic, ...] | RulecError:
    """What is found in a rulebook, or why it cannot be looked at."""
    from rulec.api.rulebook_questions import analyze_rulebook
    from rulec.diagnostics import RulecError
    from rulec.report.text.console import progress
    from rulec.settings import search_path

    try:
        with progress(f"analyzing {rulebook}", None) as tell:
            return analyze_rulebook(rulebook, search_path(), at, tell)
    except RulecError as error:
        return error
