"""``rulec compile``: a rulebook into automata files."""

from __future__ import annotations

from fractions import Fraction
from pathlib import Path

import click

from rulec.cli.options.shared_options import at_option, seconds
from rulec.cli.options.shell_completion import complete_rulebooks
from rulec.report.text.console import print_diagnostics, print_result


@click.command()
@click.argument("rulebook", shell_complete=complete_rulebooks)
@click.option(
    "--step",
    "step_s",
    callback=seconds,
    metavar="S",
    help="The step of the traces to be judged, in s: a decimal, or a fraction such as 1/3. It "
    "matters to rules with bounds in seconds.  [default: that of their examples]",
)
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="DIR",
    help="The folder for the files, made if need be.",
)
@at_option
def command(rulebook: str, output: str, step_s: Fraction | None, at: str) -> None:
    """Compile RULEBOOK: a name, or the path of a source.

    Writes RULE.hoa for every rule, in the Hanoi Omega-Automata format, and one compiled rulebook
    RULEBOOK.json, which every other command takes in place of the source and which runs without
    Spot. Each file appears whole or not at all.
    """
    from rulec.api.workflow import compile_rulebook
    from rulec.automata.bundle.bundle_file import write_compiled
    from rulec.settings import search_path

    if not output:
        raise click.UsageError("--output names no folder. For this one, write `-o .`")
    compiled = compile_rulebook(rulebook, search_path(), print_diagnostics, step_s, at)
    for path in write_compiled(compiled, Path(output)):
        print_result(f"wrote {path}")
