"""``rulec audit``: what rulebooks rest on."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from rulec.analysis.audit.audit_kinds import KINDS
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.shared_options import at_option, only_sources
from rulec.cli.options.shell_completion import complete_rulebooks

if TYPE_CHECKING:
    from rulec.analysis.audit.rulebook_audit import Audit

FORMATS = ("text", "markdown", "json")


@click.command()
@click.argument(
    "rulebooks", nargs=-1, required=True, metavar="RULEBOOK...", shell_complete=complete_rulebooks
)
@click.option(
    "--output-format",
    type=click.Choice(FORMATS),
    default="text",
    show_default=True,
    help="Text, tables in Markdown, or JSON.",
)
@click.option(
    "--fail-on",
    "fatal",
    type=click.Choice([*KINDS, "any"]),
    multiple=True,
    metavar="KIND",
    help="A kind of finding that makes the exit status 1; may be given several times, `any` is "
    "every kind. With --compare only new findings count.",
)
@click.option("--examples", "run", is_flag=True, help="Run the examples, and name those that fail.")
@click.option(
    "--compare",
    metavar="OLD",
    shell_complete=complete_rulebooks,
    help="Say what has changed since an older audit (.json), or against another rulebook.",
)
@at_option
def command(
    rulebooks: tuple[str, ...],
    output_format: str,
    fatal: tuple[str, ...],
    run: bool,
    compare: str | None,
    at: str,
) -> int:
    """Say what every RULEBOOK (a name, or the path of a source) rests on.

    That is: rules that cite no provision, that lack examples or were never verified, what is soft,
    dropped, left out or in force for a time only, the provisions covered, and words in no rule.

    Exit status: 0 done, 1 --fail-on says so, 2 a rulebook could not be read.
    """
    from rulec.analysis.audit.rulebook_audit import compare_audits
    from rulec.report.rulebooks.audit_report import render
    from rulec.report.text.console import page_width, print_result

    only_sources(rulebooks, "be audited")
    older = None if compare is None else _older(compare, run, at)
    audits = [done for one in rulebooks if (done := _audit_or_say(one, run, at)) is not None]
    against = {} if older is None else compare_audits(audits, older)
    if audits or output_format == "json":
        print_result(render(audits, against, output_format, page_width()))
    if len(audits) < len(rulebooks):
        return ExitStatus.NOT_ANSWERED
    found = [
        one
        for each in audits
        for one in (each.findings if older is None else against[each.rulebook].appeared)
    ]
    failed = any("any" in fatal or one.kind in fatal for one in found)
    return ExitStatus.FOUND if failed else ExitStatus.OK


def _audit(rulebook: str, run: bool, at: str) -> Audit:
    """The audit, after its warnings."""
    from rulec.api.rulebook_questions import audit_rulebook
    from rulec.report.text.console import print_diagnostics
    from rulec.settings import search_path

    return audit_rulebook(rulebook, search_path(), at, print_diagnostics, run=run)


def _audit_or_say(rulebook: str, run: bool, at: str) -> Audit | None:
    """The audit; None, after its mistakes, if the rulebook has any."""
    from rulec.diagnostics import RulecError
    from rulec.report.text.console import print_diagnostics

    try:
        return _audit(rulebook, run, at)
    except RulecError as error:
        print_diagnostics(error.diagnostics)
        return None


def _older(reference: str, run: bool, at: str) -> tuple[Audit, ...]:
    if Path(reference).suffix == ".json":
        from rulec.analysis.audit.saved_audit import read_audits

        return read_audits(Path(reference))
    return (_audit(reference, run, at),)
