"""``rulec new``: a rulebook to start from."""

from __future__ import annotations

from pathlib import Path

import click

import rulec
from rulec.cli.options.output_options import refuse_standard_output
from rulec.cli.options.shell_completion import complete_rulebooks
from rulec.cli.options.verb_class import argument, option, verb
from rulec.diagnostics import SourceLocation
from rulec.files.file_messages import UNWRITABLE_FILE
from rulec.files.written_files import make_folder, written_whole
from rulec.report.text.console import print_line, print_remark
from rulec.rulebook.files.search_path import available_rulebooks
from rulec.settings import search_path


@verb
def command(
    *,
    name: str = argument(),
    output: str = option(
        "-o",
        "--output",
        default=".",
        metavar="DIR",
        show_default="the working folder",
        help="The folder for NAME.rules; it is created if necessary.",
    ),
    base: str | None = option(
        "--extends",
        metavar="R",
        help="The name of a rulebook to extend.",
        shell_complete=complete_rulebooks,
    ),
) -> None:
    """Create NAME.rules, a small valid rulebook with examples, as a starting point.

    An existing file is not overwritten.
    """
    refuse_standard_output(output)
    name = name.removesuffix(".rules")
    if base is not None and ("/" in base or base.endswith(".rules")):
        raise click.UsageError(
            f"--extends takes a name, such as `{Path(base).stem}`: a rulebook finds another one "
            "beside itself, on the search path, or among what ships"
        )
    folders = () if base is None else (Path(output), *search_path())
    text = rulec.Session(folders).new_rulebook(name, base)
    if name in available_rulebooks():
        print_remark(
            f"rulec: a `{name}` ships with rulec, too: `{name}` alone is that one, unless "
            "`search_path` in rulec.toml has this folder"
        )
    path = Path(output) / f"{name}.rules"
    if path.exists() or path.is_symlink():
        way_out = "give another name, or another folder with --output"
        raise UNWRITABLE_FILE.error(
            SourceLocation(str(path)), "the file is there already", help=way_out
        )
    make_folder(path.parent)
    with written_whole(path) as stream:
        stream.write(text.encode())
    print_line(f"wrote {path}; next: rulec test {path if '/' in str(path) else f'./{path}'}")
