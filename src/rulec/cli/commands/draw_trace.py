"""``rulec draw trace``: a trace as a picture."""

from __future__ import annotations

from dataclasses import replace
from fnmatch import fnmatchcase
from pathlib import Path
from typing import TYPE_CHECKING

import click

import rulec
from rulec.cli.options.picture_options import picture_options, write
from rulec.cli.options.shared_options import at_option, rulebook_option, rules_option
from rulec.cli.project import read_machines
from rulec.diagnostics import RulecError, named

if TYPE_CHECKING:
    from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
    from rulec.trace import Trace


@click.command()
@click.argument("file")
@rulebook_option()
@click.option(
    "--trace", "wanted", metavar="ID", help="Draw the trace with this id.  [default: the first]"
)
@rules_option(
    "Only what rules like PATTERN read; `*` and `?` are wild. May be given several times."
)
@click.option(
    "--object",
    "objects",
    multiple=True,
    metavar="ID",
    help="Of the objects only this one. May be given several times.",
)
@at_option
@picture_options
def trace(
    file: str,
    rulebook: str,
    wanted: str | None,
    patterns: tuple[str, ...],
    objects: tuple[str, ...],
    at: str,
    output: Path,
    form: str | None,
) -> None:
    """Draw a trace of FILE (JSON Lines, CSV or Parquet): what a rulebook reads in it, over time.

    Violations are marked where they are decided, with the rule and its article.
    """
    # Verdicts and pictures, 150 ms: not for --help.
    from rulec.api.pictures import trace_drawing
    from rulec.monitoring.verify import rulebook_for_trace

    rules = read_machines(rulebook, at)
    chosen = _trace(file, wanted)
    for item in objects:
        if item not in chosen.objects:
            raise click.UsageError(
                f"trace `{chosen.id}` has no object `{item}`; it has {named(list(chosen.objects))}."
            )
    used = _only(rulebook_for_trace(chosen, rules), patterns)
    write(trace_drawing(chosen, used, objects, patterns), output, form)


def _trace(file: str, wanted: str | None) -> Trace:
    """The wanted trace. Raises RulecError for an unreadable one up to it."""
    names: list[str] = []
    for trace_ in rulec.read_traces(file):
        if isinstance(trace_, RulecError):
            raise trace_
        if wanted in (None, trace_.id):
            return trace_
        names.append(trace_.id)
    some = ", ".join(f"`{name}`" for name in names[:5]) + (", …" if len(names) > 5 else "")
    raise click.UsageError(f"`{file}` has no trace `{wanted}`; it has {some}.")


def _only(rules: CompiledRulebook, patterns: tuple[str, ...]) -> CompiledRulebook:
    """The rulebook restricted to rules that match a pattern, if any."""
    kept = tuple(
        rule
        for rule in rules.rules
        if not patterns or any(fnmatchcase(rule.name, pattern) for pattern in patterns)
    )
    if not kept:
        raise click.UsageError(
            f"{rules.name} has no rule like {' or '.join(f'`{pattern}`' for pattern in patterns)}."
        )
    return replace(rules, rules=kept)
