"""``rulec compile``: a rulebook into automata files."""

from __future__ import annotations

from pathlib import Path

import click

from rulec.cli.arguments import complete_rulebooks
from rulec.report.console import print_diagnostics, print_result


@click.command()
@click.argument("rulebook", shell_complete=complete_rulebooks)
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="DIR",
    help="The folder for the files, made if need be.",
)
def command(rulebook: str, output: str) -> None:
    """Compile RULEBOOK: a name, or the path of a source.

    Writes RULE.hoa for every rule, in the Hanoi Omega-Automata format, and one compiled rulebook
    RULEBOOK.json, which every other command takes in place of the source and which runs without
    Spot. Each file appears whole or not at all.
    """
    from rulec.automata.compiled_file import write_compiled
    from rulec.settings import search_path
    from rulec.workflow import compile_rulebook

    if not output:
        raise click.UsageError("--output names no folder. For this one, write `-o .`")
    for path in write_compiled(
        compile_rulebook(rulebook, search_path(), print_diagnostics), Path(output)
    ):
        print_result(f"wrote {path}")
