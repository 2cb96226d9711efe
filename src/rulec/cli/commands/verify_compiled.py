"""``rulec verify-compiled``: whether compiled tables do what their formulas say."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.output import errors_told, put_answer
from rulec.cli.standard_input import read_as_file

if TYPE_CHECKING:
    from rulec.validation.file_proof import RuleProof


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...", callback=read_as_file)
@output_options(endings_of("text", "json"), "what is proved")
def command(files: tuple[str, ...], to: Output) -> int:
    """Prove that every table of compiled rulebooks does what its formula says.

    Each table is held against a machine that is made of the formula anew, on all words, by a
    program that shares nothing with the compiler; nothing is taken from an earlier run.

    Exit status: 0 all rules are proved, 1 some are not, 2 a file could not be read.
    """
    # Compiled files and the checker, 60 ms: not for --help.
    from rulec.automata.bundle.bundle_proof import proofs_of_file
    from rulec.report.rulebooks.proof_report import render

    proofs: list[tuple[str, list[RuleProof]]] = []
    for name in files:
        with errors_told():
            proofs.append((name, proofs_of_file(Path(name))))
    if proofs or to.form == "json":
        put_answer(render(proofs, to.form), to)
    return ExitStatus.after(
        answered=len(proofs) == len(files),
        failed=any(proof.because for _, of_file in proofs for proof in of_file),
    )
