"""``rulec check``: all diagnostics of rulebooks and vocabularies, without any output file."""

from __future__ import annotations

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.options.output_options import Output
from rulec.cli.options.shared_options import (
    at_option,
    fail_on_option,
    findings_option,
    no_cache_and,
    verbose_option,
)
from rulec.cli.options.shell_completion import complete_sources
from rulec.cli.options.standard_input import standard_input
from rulec.cli.options.verb_class import argument, option, verb
from rulec.cli.output import print_findings, print_left_alone, width_of
from rulec.cli.watching import watch as watch_sources
from rulec.cli.watching import watch_option
from rulec.diagnostics import named
from rulec.files.read_files import MAX_SOURCE_BYTES
from rulec.report.text.console import print_remark
from rulec.report.text.terminal_text import broken, counted
from rulec.rulebook.batch.batch_check import Checked, check
from rulec.rulebook.batch.shipped_lock import not_as_locked, write_lock
from rulec.settings import exclusion, search_path


@verb
def command(
    *,
    sources: tuple[str, ...] = argument(
        nargs=-1, metavar="[FILE|NAME]...", shell_complete=complete_sources
    ),
    to: Output = findings_option,
    fail_on: str = fail_on_option,
    fix: bool = no_cache_and(
        option(
            "--fix",
            is_flag=True,
            help="Apply the edits that messages suggest. They may change what rules mean: review "
            "them.",
        )
    ),
    lock: bool = option(
        "--lock",
        is_flag=True,
        help="Record in rulec.lock the hashes of the shipped rulebooks that these build upon; "
        "later checks report any that have changed.",
    ),
    verbose: bool = verbose_option,
    watch: bool = watch_option,
    at: str = at_option,
) -> int:
    """Check rulebooks and vocabularies for mistakes, without changing any file unless asked.

    Each argument is a name, a file, a pattern, a folder (its sources at any depth, except what git
    ignores, rulec.toml excludes, or belongs to a Python environment), or `-` for standard input;
    the default is the working folder. Examples are not run: use `rulec test` for that.

    Exit status: 0 no mistakes found, 1 mistakes found, 2 a file could not be read.
    """
    sources = sources or (".",)
    if fix and "-" in sources:
        raise click.UsageError("`-` is standard input and cannot be written; write it to a file")
    if lock and "-" in sources:
        raise click.UsageError("`-` is standard input; a lock is of files")

    def run() -> int:
        done = _checked(sources, at)
        if fix and any(finding.fix for finding in done.findings):
            number, changed = lazy.write_fixes(done.files, done.findings)
            print_remark(f"{counted(number, 'fix', 'fixes')} written to {', '.join(changed)}")
            done = _checked(sources, at)
        if lock and not done.unread:
            path, number = write_lock(done.files, search_path(), at)
            print_remark(f"rulec: wrote {path}: {counted(number, 'file')} that rulec ships")
        status = print_findings(
            (*done.findings, *not_as_locked()),
            done.unread,
            nothing=_nothing_found(done, width_of(to)),
            to=to,
            fail_on=fail_on,
        )
        print_left_alone(done.left_alone, verbose=verbose)
        return status

    if watch:
        watch_sources(run, sources)
    return run()


def _nothing_found(done: Checked, width: int) -> str:
    files = counted(len(done.files), "file")
    lines = [f"{files} checked, no mistakes found; `rulec test` runs the examples"]
    for rules, lack in ((done.uncited, "cites no provision"), (done.untested, "has no example")):
        if rules:
            many = lack.replace("cites", "cite").replace("has", "have")
            lines.append(
                f"rule {named(rules)} {lack}"
                if len(rules) == 1
                else f"{len(rules)} rules {many}: {named(rules)}"
            )
    return "\n".join(part for line in lines for part in broken(line, width, later="  "))


def _checked(sources: tuple[str, ...], at: str) -> Checked:
    return check(sources, _standard_input, search_path(), at, exclusion())


def _standard_input() -> bytes:
    return standard_input().read(MAX_SOURCE_BYTES + 1)
