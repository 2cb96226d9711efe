"""``rulec compile``: a rulebook into automata files."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from pathlib import Path

import click

from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, refuse_overwriting, refuse_standard_output
from rulec.cli.output import open_session
from rulec.report.text.console import print_line

_WRITTEN = (".hoa", ".json")


@click.command()
@shared.rulebook_argument
@shared.steps_option(
    "The step of the traces to be judged, in s: a decimal, or a fraction such as 1/3; several "
    "times for several steps. It matters to rules with bounds in seconds.  [default: that of "
    "their examples]",
)
@click.option(
    "-o",
    "--output",
    required=True,
    metavar="DIR",
    help="The folder for the files, made if need be.",
)
@shared.at_option
def command(rulebook: str, output: str, steps_s: Sequence[Fraction], at: str) -> None:
    """Compile RULEBOOK: a name, or the path of a source.

    Writes RULE.hoa for every rule, in the Hanoi Omega-Automata format, and one compiled rulebook
    RULEBOOK.json, which every other command takes in place of the source and which runs without
    Spot. Each file appears whole or not at all.
    """
    if not output:
        raise click.UsageError("--output names no folder. For this one, write `-o .`")
    refuse_standard_output(output)
    if "/" in rulebook and Path(rulebook).suffix in _WRITTEN:
        # What is written is called after rules, which are not known yet.
        refuse_overwriting([Output(str(Path(output, Path(rulebook).name)), "")], [rulebook])
    session = open_session(at)
    compiled = session.compile_rulebook(rulebook, step_s=steps_s or None)
    for path in session.write_compiled(compiled, output):
        print_line(f"wrote {path}")
