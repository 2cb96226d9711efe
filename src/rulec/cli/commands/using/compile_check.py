"""``rulec compile --check``: prove that compiled tables do what their formulas say."""

from __future__ import annotations

from pathlib import Path

from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.standard_input import read_as_file
from rulec.cli.options.verb_class import argument, verb
from rulec.cli.output import errors_told, put_answer
from rulec.diagnostics import first_of
from rulec.report.text.console import print_remark

_MOST_NAMED = 6
"""So many of the files passed over are named."""


@verb
def command(
    *,
    files: tuple[str, ...] = argument(
        nargs=-1, required=True, metavar="FILE...", callback=read_as_file
    ),
    to: Output = output_options(endings_of("text", "json"), "the results"),
) -> int:
    """Prove that every table in compiled rulebooks is equivalent to its formula.

    Each table is compared, on all words, to a machine built afresh from the formula by a program
    that shares no code with the compiler; no results of earlier runs are used. A folder stands for
    all compiled rulebooks in it, at any depth, and a pattern such as `*.json` for all files that
    match; other JSON is passed over, and named.

    Exit status: 0 all rules are proved, 1 some are not, 2 a file could not be read.
    """
    proofs: list[tuple[str, list[lazy.RuleProof]]] = []
    found = lazy.compiled_files(files)
    for name in found.paths:
        with errors_told():
            proofs.append((name, lazy.proofs_of_file(Path(name))))
    if found.others:
        names = first_of(found.others, _MOST_NAMED)
        print_remark(f"rulec: passed over, as other JSON: {names}")
    if proofs or to.form == "json":
        put_answer(lazy.proof_report.render(proofs, to.form), to)
    return ExitStatus.after(
        answered=len(proofs) == len(found.paths),
        failed=any(proof.because for _, of_file in proofs for proof in of_file),
    )
