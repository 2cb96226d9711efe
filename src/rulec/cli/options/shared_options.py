"""Options and arguments that several verbs share, with the same texts everywhere."""

from __future__ import annotations

import os
import re
from collections.abc import Callable, Sequence
from dataclasses import replace
from fnmatch import fnmatchcase
from fractions import Fraction
from glob import has_magic
from math import isfinite
from pathlib import Path
from typing import Any

import click
from click.core import ParameterSource

from rulec.batch.jobs import Jobs, chosen_jobs
from rulec.cache.keeping import keeping
from rulec.cli import lazy_imports as lazy
from rulec.cli.options.output_options import RenamedOption, endings_of, output_options
from rulec.cli.options.shell_completion import complete_rulebooks
from rulec.cli.options.standard_input import read_as_file
from rulec.cli.options.verb_class import Decorated, argument, option
from rulec.diagnostics import did_you_mean
from rulec.report.findings.finding_formats import FORMATS
from rulec.rulebook.files.search_path import available_rulebooks
from rulec.settings import search_path

RULEBOOK_HELP = (
    "The rulebook: its name, its source (.rules) or its compiled form (.json); `-` is standard "
    "input."
)

MOST_JOBS = 256

_SECONDS = re.compile(r"[0-9]{1,9}(?:\.[0-9]{1,17}|/(?!0+$)[0-9]{1,9})?")


def choice_option(
    name: str, choices: Sequence[str], help_text: str, former: Sequence[str] = ()
) -> Any:
    """An option with one of several words, of which the first is the default."""
    return option(
        name,
        cls=RenamedOption,
        former=former,
        type=click.Choice(choices),
        default=choices[0],
        show_default=True,
        help=help_text,
    )


def number_option(
    name: str, help_text: str, least: int = 0, most: int | None = None, **settings: Any
) -> Any:
    """An option for an integer from ``least`` to ``most``, with further settings of click."""
    kind = click.IntRange(least, most)
    settings = {"metavar": "N", "cls": RenamedOption, **settings}
    return option(name, type=kind, show_default=True, help=help_text, **settings)


def beside(context: click.Context, parameter: click.Parameter, value: str | None) -> Path | None:
    """The path of a file that is read besides the main ones."""
    return None if value is None else Path(read_as_file(context, parameter, value, ending=""))


def finite(_: click.Context, parameter: click.Parameter, value: float | None) -> float | None:
    """Refuse infinity and NaN for an option: click accepts NaN in every range."""
    if value is not None and not isfinite(value):
        raise click.BadParameter(f"it has to be a number, not `{value}`", param=parameter)
    return value


def _seconds(
    context: click.Context, parameter: click.Parameter, value: str | None
) -> Fraction | None:
    if value is None:
        return None
    step = Fraction(value) if _SECONDS.fullmatch(value) else Fraction(0)
    if "," in value and _SECONDS.fullmatch(value.replace(",", ".")):
        raise click.BadParameter(f"decimals have a point: {value.replace(',', '.')}")
    if not step:
        raise click.BadParameter(
            "it has to be a number above 0, in seconds, without a unit and without an exponent, "
            "such as 0.5 or 1/3"
        )
    return step


def _day(context: click.Context, parameter: click.Parameter, value: str) -> str:
    """A date in ISO form; empty if none is given."""
    if not value:
        return ""
    wrong = lazy.why_not_a_day(value)
    if wrong:
        options = [option for param in context.command.params for option in param.opts]
        if _SECONDS.fullmatch(value) and "--at-time" in options:
            wrong = f"for a moment in seconds there is `--at-time {value}`"
        raise click.BadParameter(f"`{value}` is no date: {wrong}")
    return value


rulebook_argument = argument(callback=read_as_file, shell_complete=complete_rulebooks)


def rulebooks_argument(metavar: str = "RULEBOOK...", *, required: bool = True) -> Any:
    """The argument ``RULEBOOK...``."""
    return argument(
        nargs=-1,
        required=required,
        metavar=metavar,
        callback=read_as_file,
        shell_complete=complete_rulebooks,
    )


def rulebooks_option(help_text: str) -> Any:
    """``--rulebook R``, repeatable."""
    return _rulebook_option(help_text, required=True, callback=read_as_file)


def rulebook_option(why_one: str, help_text: str = RULEBOOK_HELP, *, required: bool = True) -> Any:
    """``--rulebook R``; for several or a folder the error says ``why_one`` is required."""

    def only(context: click.Context, parameter: click.Parameter, values: tuple[str, ...]) -> Any:
        several = len(values) > 1 or any(stands_for_several(value) for value in values)
        if several and not context.resilient_parsing:
            raise click.UsageError(f"{why_one}; give each rulebook a call of its own", context)
        return read_as_file(context, parameter, values[0]) if values else None

    return _rulebook_option(help_text, required=required, callback=only)


def stands_for_several(reference: str) -> bool:
    """Whether a reference is a folder or pattern, not the name of a rulebook or file."""
    if "/" not in reference and os.path.isdir(reference):  # noqa: PTH112
        return reference not in available_rulebooks(search_path())
    return os.path.isdir(reference) or (has_magic(reference) and not os.path.lexists(reference))  # noqa: PTH112 - Path raises on a null character


def _rulebook_option(help_text: str, **settings: Any) -> Any:
    return option(
        "-r",
        "--rulebook",
        multiple=True,
        metavar="R",
        help=help_text,
        shell_complete=complete_rulebooks,
        **settings,
    )


def step_option(help_text: str) -> Any:
    """The option ``--step S``, read exactly, with the verb's own help text."""
    return option("--step", callback=_seconds, metavar="S", help=help_text)


def rules_option(help_text: str, former: Sequence[str] = ()) -> Any:
    """``--rule PATTERN``, repeatable, which formerly had the names ``former``."""
    return option(
        "--rule",
        cls=RenamedOption,
        former=former,
        multiple=True,
        metavar="PATTERN",
        help=f"{help_text}; `*` and `?` are wildcards. May be given several times.",
    )


def topic_option(help_text: str) -> Any:
    """``--topic TOPIC``."""
    return option(
        "--topic",
        metavar="TOPIC",
        help=f"{help_text}: a topic of the rulebook, a part of its title, or a group of topics, "
        "such as overtaking.",
    )


end_option = option(
    "--end",
    type=click.Choice(["cut", "complete"]),
    help="Whether traces are cut out of a longer drive or complete when they end.  [default: what "
    "each trace says, else cut if it states its step in seconds, else complete]",
)


def _jobs(context: click.Context, parameter: click.Parameter, value: str | None) -> Jobs:
    if value is None:
        return chosen_jobs(None)
    number = int(value) if re.fullmatch(r"[0-9]{1,9}", value) else MOST_JOBS + 1
    if number <= MOST_JOBS:
        return chosen_jobs(number)
    wanted = f"has to be a whole number from 0 to {MOST_JOBS}; 0 is one for each processor"
    if is_from(context, "jobs", ParameterSource.ENVIRONMENT):
        raise click.UsageError(f"RULEC_JOBS is `{value}`, and {wanted}.")
    raise click.BadParameter(f"it {wanted}")


def is_from(context: click.Context, field: str, source: ParameterSource) -> bool:
    """Whether the value of a parameter comes from this source, such as the command line."""
    return context.get_parameter_source(field) is source


def jobs_option(task: str) -> Any:
    """``-j N``, read as Jobs."""
    return option(
        "-j",
        "--jobs",
        callback=_jobs,
        envvar="RULEC_JOBS",
        metavar="N",
        help=f"{task}; 0 means one per processor.  [default: RULEC_JOBS, else one per processor "
        "where that pays off]",
    )


at_option = option(
    "--at",
    default="",
    callback=_day,
    metavar="DATE",
    help="Apply the law of this day: rules and parameters not in force then are left out.  "
    "[default: the day in the rulebook's `law` line, else today]",
)


def _without_cache(context: click.Context, _: click.Parameter, value: bool) -> None:
    if value:
        context.with_resource(keeping(on=False))


_no_cache_option = click.option(
    "--no-cache",
    is_flag=True,
    expose_value=False,
    callback=_without_cache,
    help="Do not reuse earlier answers; compute everything again.",
)


def no_cache_and(make: Any) -> Any:
    """``--no-cache``, which has no parameter, and then another option."""

    def both(name: str) -> Callable[[Decorated], Decorated]:
        return lambda function: _no_cache_option(make(name)(function))

    return both


verbose_option = option(
    "-v", "--verbose", is_flag=True, help="Name each file and folder that is skipped, and why."
)

findings_option = output_options(
    endings_of(*FORMATS),
    "the findings: text that quotes the source lines, one line each, JSON, GitHub annotations, or "
    "SARIF 2.1.0",
)

fail_on_option = choice_option(
    "--fail-on", ["error", "warning"], "The least severe finding that makes the exit status 1."
)


def refuse_unmatched(
    patterns: Sequence[str], books: Sequence[lazy.Rulebook] | Sequence[lazy.CompiledRulebook]
) -> None:
    """Refuse a pattern that matches no rule: nothing to report would look like nothing found.

    Raises click.BadParameter.
    """
    known = {rule.name for book in books for rule in book.rules}
    for pattern in patterns:
        if not any(fnmatchcase(name, pattern) for name in known):
            near = did_you_mean(pattern, known)
            whose = (
                f"{books[0].name} has no" if len(books) == 1 else "none of these rulebooks has a"
            )
            raise click.BadParameter(
                f"{whose} rule like `{pattern}`{near and f'; {near}'}", param_hint="--rule"
            )


def rules_on_topic(books: Sequence[lazy.Rulebook], topic: str) -> tuple[lazy.Rulebook, ...]:
    """The rulebooks with only their rules on a topic. Raises click.BadParameter: there is none."""
    try:
        chosen = lazy.on_topic(books, topic)
    except LookupError as problem:
        raise click.BadParameter(str(problem.args[0]), param_hint="--topic") from None
    if not any(book.rules for book in chosen):
        names = ", ".join(book.name for book in books)
        raise click.BadParameter(f"{names}: no rule is on `{topic}`", param_hint="--topic")
    return chosen


def with_rules_like(rules: lazy.CompiledRulebook, patterns: Sequence[str]) -> lazy.CompiledRulebook:
    """A compiled rulebook with only the rules that match one of the patterns, if there are any."""
    if not patterns:
        return rules
    kept = [
        rule for rule in rules.rules if any(fnmatchcase(rule.name, pattern) for pattern in patterns)
    ]
    return replace(rules, rules=tuple(kept))
