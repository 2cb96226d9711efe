"""``rulec verify``: traces judged by a rulebook."""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import IO, TYPE_CHECKING

import click

from rulec.cli.arguments import at_option, json_option, rulebook_option, traces_format_option
from rulec.cli.exit_status import ExitStatus

if TYPE_CHECKING:
    from rulec.automata.compiled import CompiledRulebook
    from rulec.diagnostics import RulecError
    from rulec.runtime.verdict import NotJudged, Verdict
    from rulec.runtime.verify import RulebookFor
    from rulec.trace import Trace
    from rulec.trace.formats import Format

    Rules = CompiledRulebook | RulebookFor
    Items = Sequence[Trace | RulecError]
    Answer = tuple[Items, int, Verdict | NotJudged]


@click.command()
@click.argument("files", nargs=-1, required=True, metavar="FILE...")
@rulebook_option
@click.option(
    "--explain",
    "n_explained",
    type=click.IntRange(min=0),
    metavar="N",
    help="Explain the first N violations state by state.  [default: 1; with --json 0]",
)
@traces_format_option
@json_option
@at_option
def command(
    files: tuple[str, ...],
    rulebook: str,
    n_explained: int | None,
    form: Format | None,
    json_output: bool,
    at: str,
) -> int:
    """Judge the traces in FILE..., as JSON Lines, CSV or Parquet; `-` is standard input.

    Prints the violations of every trace and a summary; with --json one line per trace. A trace that
    cannot be judged is reported and does not stop the others.

    Exit status: 0 every hard rule is kept, 1 one is violated, 2 a trace could not be judged.
    """
    from rulec.report import verdicts
    from rulec.report.console import Complaints, print_diagnostics, print_result
    from rulec.runtime.batch.blocks import rulebook_for
    from rulec.runtime.explanation import explain
    from rulec.runtime.verdict import Verdict
    from rulec.settings import search_path
    from rulec.trace import Trace
    from rulec.workflow import machines

    rules = machines(rulebook, search_path(), print_diagnostics, at)
    satisfied = violated = not_judged = 0
    complaints = Complaints()
    to_explain = n_explained if n_explained is not None else 0 if json_output else 1
    for traces, place, answer in _answers(files, form, rules):
        if isinstance(answer, Verdict):
            satisfied += answer.satisfied
            violated += not answer.satisfied
            if not (answer.violations or json_output):
                continue
            used = rulebook_for(traces, place, rules)
            explained = []
            if answer.violations and to_explain:
                chosen = answer.violations[:to_explain]
                to_explain -= len(chosen)
                trace = traces[place]
                explained = [
                    explain(one, trace, used) for one in chosen if isinstance(trace, Trace)
                ]
            as_printed = verdicts.as_json if json_output else verdicts.as_text
            print_result(as_printed(answer, used, explained))
        else:
            not_judged += 1
            complaints.add(answer.error)
            if json_output:
                print_result(verdicts.not_judged_as_json(answer))
    complaints.close()
    if not json_output:
        print_result(verdicts.summary(satisfied, violated, not_judged))
    if not_judged:
        return ExitStatus.NOT_ANSWERED
    return ExitStatus.VIOLATED if violated else ExitStatus.OK


def _answers(files: tuple[str, ...], form: Format | None, rules: Rules) -> Iterator[Answer]:
    """Traces, which of them, and its verdict, or why there is none."""
    from rulec.diagnostics import RulecError
    from rulec.files import opened
    from rulec.runtime.verdict import NotJudged
    from rulec.trace.formats import format_of

    for file in files:
        try:
            if file == "-":
                yield from _judged(sys.stdin.buffer, "standard input", form or "jsonl", None, rules)
                continue
            with opened(Path(file)) as stream:
                about = os.fstat(stream.fileno())
                size = about.st_size if stat.S_ISREG(about.st_mode) else None
                yield from _judged(stream, file, form or format_of(file), size, rules)
        except RulecError as error:
            yield [error], 0, NotJudged(None, error)


def _judged(
    stream: IO[bytes], name: str, form: Format, size: int | None, rules: Rules
) -> Iterator[Answer]:
    from rulec.report.console import progress
    from rulec.runtime.batch.blocks import judge_items
    from rulec.trace.formats import read_chunks

    with progress(f"judging {name}", size) as tell:
        for traces in read_chunks(stream, name, form):
            found, answers = judge_items(traces, rules)
            for place, answer in enumerate(answers):
                yield found, place, answer
            if size is not None:
                tell(stream.tell())
