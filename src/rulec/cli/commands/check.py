"""``rulec check``: all that is to say about rulebooks and vocabularies, and nothing written."""

from __future__ import annotations

import sys

import click

from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.shared_options import at_option, findings_options
from rulec.cli.options.shell_completion import complete_sources


@click.command()
@click.argument(
    "sources", nargs=-1, required=True, metavar="FILE|NAME...", shell_complete=complete_sources
)
@findings_options
@click.option(
    "--no-cache",
    is_flag=True,
    help="Check anew also what has not changed since the last time.",
)
@at_option
def command(
    sources: tuple[str, ...], output_format: str, fail_on: str, at: str, no_cache: bool
) -> int:
    """Check rulebooks and vocabularies, and write nothing.

    Each is a name, a file, a folder (all .rules files in it), or `-` for standard input.

    Exit status: 0 no mistakes, 1 there are some, 2 a file could not be read.
    """
    from rulec.files import MAX_SOURCE_BYTES
    from rulec.report.findings.finding_formats import render
    from rulec.report.text.console import print_diagnostics, print_result, wants_color
    from rulec.rulebook.batch.batch_check import check
    from rulec.settings import search_path

    def standard_input() -> bytes:
        return sys.stdin.buffer.read(MAX_SOURCE_BYTES + 1)

    done = check(sources, standard_input, search_path(), at, recalls=not no_cache)
    color = wants_color(sys.stdout)
    text = render(done.findings, output_format, color=color, complete=not done.unread)
    if text:
        print_result(text)
    elif output_format == "full" and not done.unread:
        number = len(done.files)
        print_result(f"{number:,} {'file' if number == 1 else 'files'} checked, nothing found")
    print_diagnostics(done.unread)
    if done.unread:
        return ExitStatus.NOT_ANSWERED
    result = any(fail_on in ("warning", finding.severity) for finding in done.findings)
    return ExitStatus.FOUND if result else ExitStatus.OK
