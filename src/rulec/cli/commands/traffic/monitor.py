"""``rulec monitor``: judge a running trace state by state."""

from __future__ import annotations

import json
from fractions import Fraction
from pathlib import Path
from typing import IO, Any

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.exit_status import ExitStatus
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import (
    STANDARD_OUTPUT,
    Output,
    endings_of,
    output_options,
)
from rulec.cli.options.shell_completion import complete_rulebooks
from rulec.cli.options.standard_input import STANDARD_INPUT, standard_input
from rulec.cli.options.verb_class import argument, option, verb
from rulec.cli.output import answer_lines, open_session, print_written
from rulec.diagnostics import RulecError, SourceLocation
from rulec.report.findings.diagnostics_text import Complaints
from rulec.report.text.console import print_remark, print_result
from rulec.vocabulary.vocabulary_model import Vocabulary


def _no_states(_: click.Context, __: click.Parameter, value: str) -> str:
    if value == STANDARD_INPUT:
        raise click.BadParameter("the states come on standard input; give the rulebook as a file")
    if shared.stands_for_several(value):
        raise click.UsageError("a monitor goes by one rulebook, and this may be several")
    return value


@verb
def command(
    *,
    rulebook: str = argument(callback=_no_states, shell_complete=complete_rulebooks),
    step_s: Fraction | None = shared.step_option(
        "The time step between states, in s: a decimal, or a fraction such as 1/3. It matters only "
        "for rules with bounds in seconds.  [default: that of their examples, or of --restore]",
    ),
    restore: str | None = option(
        "--restore",
        metavar="FILE",
        type=click.Path(dir_okay=False, allow_dash=True),
        help="Resume the monitor saved in FILE; `-` reads it from the first line of standard "
        "input, before the states.",
    ),
    save: str | None = option(
        "--save",
        metavar="FILE",
        type=click.Path(dir_okay=False, allow_dash=True),
        help="Save the monitor to FILE when it ends, however it ends.",
    ),
    to: Output = output_options(
        {**endings_of("text"), "json": (".jsonl", ".ndjson", ".json")},
        "the verdicts, one line per state",
    ),
    at: str = shared.at_option,
) -> int:
    """Judge states from standard input, one JSON object per line, as they arrive.

    Immediately prints one line per state with the verdict of RULEBOOK on the trace so far:
    satisfied or violated for good, satisfied so far, or pending. A line that cannot be judged is
    reported and otherwise ignored.

    Exit status: 0 every hard rule is satisfied if the trace ends here, 1 some are violated, 2 a
    state could not be judged, or none arrived. With --save the trace is taken to continue, so
    pending rules do not count as violated.
    """
    is_shown = save == STANDARD_OUTPUT
    if is_shown and not to.is_file:
        raise click.UsageError("standard output takes one answer: give -o FILE, or --save FILE.")
    given = standard_input()
    saved = _saved(restore, given)
    step_s = step_s or lazy.monitor_sources.step_of(saved)
    rules = open_session(at).compile_rulebook(rulebook, step_s=step_s)
    if restore is None:
        monitor = lazy.RunningMonitor(rules, step_s)
    else:
        place = "standard input" if restore == STANDARD_INPUT else restore
        monitor = lazy.RunningMonitor.restore(rules, saved, SourceLocation(place))
    complaints, refused = Complaints(), False
    form = lazy.running_verdicts.as_json if to.form == "json" else lazy.running_verdicts.as_text
    file = None if save is None or is_shown else Path(save)
    with lazy.monitor_sources.saved_at_the_end(monitor, file), answer_lines(to) as write:
        for live in lazy.read_live(given, "standard input", _object_type(rules.vocabulary)):
            result = lazy.monitor_sources.answer(monitor, live)
            if isinstance(result, RulecError):
                refused = True
                complaints.add(result)
                if to.form == "json":
                    write(lazy.running_verdicts.refused_as_json(result))
            else:
                write(form(result))
        complaints.close()
    if is_shown:
        print_result(json.dumps(monitor.snapshot()), "json")
    else:
        print_written(to.path, to)
    if restore is None and save is None and monitor.so_far.state < 0 and not refused:
        print_remark("rulec: no state came on standard input: nothing was judged")
        return ExitStatus.NOT_ANSWERED
    violated = {"violated"} if save is not None else {"violated", "pending"}
    return ExitStatus.after(answered=not refused, failed=monitor.so_far.best in violated)


def _object_type(vocabulary: Vocabulary) -> str:
    """A type of objects for examples in messages; empty if the vocabulary has none."""
    types = vocabulary.types
    return "vehicle" if "vehicle" in types else next(iter(types), "")


def _saved(restore: str | None, given: IO[bytes]) -> Any:
    """The content of a saved monitor's file, or the first line of standard input, or None."""
    if restore is None:
        return None
    if restore == STANDARD_INPUT:
        line = given.readline(lazy.LONGEST_LINE_BYTES + 1)
        return lazy.monitor_sources.saved_from(line, "standard input")
    return lazy.monitor_sources.read_saved(Path(restore))
