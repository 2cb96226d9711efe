"""``rulec fmt``: rulebooks and vocabularies in their canonical form."""

from __future__ import annotations

import sys
from collections.abc import Sequence

import click

from rulec.cli.exit_status import ExitStatus
from rulec.cli.options.shared_options import verbose_option
from rulec.cli.options.standard_input import standard_input
from rulec.cli.options.verb_class import argument, option, verb
from rulec.cli.output import print_left_alone
from rulec.files.read_files import MAX_SOURCE_BYTES
from rulec.report.findings.diagnostics_text import print_diagnostics
from rulec.report.text.console import print_line, print_remark, print_result
from rulec.report.text.terminal_text import counted
from rulec.report.text.text_diff import as_diff, for_terminal
from rulec.rulebook.batch.batch_format import Formatted, format_files, formatted, replace_files
from rulec.settings import exclusion, search_path


@verb
def command(
    *,
    paths: tuple[str, ...] = argument(
        nargs=-1, metavar="[PATH]...", type=click.Path(allow_dash=True)
    ),
    check: bool = option(
        "--check", is_flag=True, help="Write nothing; name the files that would change."
    ),
    diff: bool = option("--diff", is_flag=True, help="Write nothing; print what would change."),
    verbose: bool = verbose_option,
) -> int:
    """Format rulebooks and vocabularies in place.

    Each PATH is a file, a pattern or a folder (its sources at any depth, except what git ignores,
    rulec.toml excludes, or belongs to a Python environment); the default is the working folder. `-`
    formats standard input to standard output.

    A file with syntax errors is left unchanged, and the errors are shown. Only the layout is
    checked; misspelt names are found by `rulec check`. Formatting never changes the meaning or the
    comments of a file.

    Exit status: 0 done, 1 --check or --diff found something to change, 2 a file could not be
    formatted.
    """
    writes = not (check or diff)
    if "-" in paths:
        if len(paths) > 1:
            raise click.UsageError("`-` is standard input and cannot be combined with files")
        file = formatted("standard input", None, standard_input().read(MAX_SOURCE_BYTES + 1))
        if writes:
            # Written as bytes: the terminal's encoding might change the text.
            sys.stdout.buffer.write(file.after)
            return ExitStatus.OK
        _show([file] if file.changed else [], diff=diff)
        return ExitStatus.after(failed=file.changed)
    done = format_files(paths or ["."], search_path(), exclusion())
    files, refused = done.files, done.refused
    changed = [file for file in files if file.changed]
    in_form = len(files) - len(changed)
    if writes:
        unwritten = replace_files(changed)
        named = {diagnostic.place.file for diagnostic in unwritten if diagnostic.place is not None}
        changed = [file for file in changed if file.name not in named]
        refused = (*refused, *unwritten)
    else:
        _show(changed, diff=diff)
    print_diagnostics(refused)
    parts = []
    if changed:
        parts.append(f"{counted(len(changed), 'file')} {'changed' if writes else 'would change'}")
    if in_form:
        parts.append(f"{counted(in_form, 'file')} already formatted")
    if parts:
        print_remark(", ".join(parts))
    print_left_alone(done.left_alone, verbose=verbose)
    return ExitStatus.after(answered=not refused, failed=bool(changed) and not writes)


def _show(changed: Sequence[Formatted], *, diff: bool) -> None:
    for file in changed:
        if not diff:
            print_line(f"would change {file.name}")
            continue
        text = as_diff(file.name, file.before.decode(), file.after.decode())
        if sys.stdout.isatty():
            print_result(for_terminal(text))
        else:
            sys.stdout.buffer.write(text.encode())
