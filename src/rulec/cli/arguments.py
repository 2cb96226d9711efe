"""Arguments that several verbs share, with the same words everywhere."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable
from fractions import Fraction
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar

import click
from click.shell_completion import CompletionItem

from rulec.diagnostics import RulecError
from rulec.report.formats import FORMATS

if TYPE_CHECKING:
    from rulec.scenario import Choice

Decorated = TypeVar("Decorated", bound=Callable[..., Any])

RULEBOOK_HELP = "A rulebook: its name, its source (.rules) or a compiled one (.json)."


def complete_rulebooks(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Names of rulebooks, and files."""
    from rulec.rulebook.finding import available_rulebooks

    return _named(available_rulebooks(_folders()), incomplete)


def complete_sources(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Names of rulebooks and vocabularies, and files."""
    from rulec.rulebook.finding import available_rulebooks, available_vocabularies

    vocabularies = (path.stem for path in available_vocabularies(_folders()))
    return _named([*available_rulebooks(_folders()), *vocabularies], incomplete)


def complete_rules(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Names of the rules of the rulebook that has been named before, with what they say."""
    from rulec.automata.compiled_file import read_compiled
    from rulec.rulebook.loader import load_rulebook

    reference = str(ctx.params.get("rulebook"))
    try:
        compiled = Path(reference).suffix == ".json"
        rules = (
            read_compiled(Path(reference)).rules
            if compiled
            else load_rulebook(reference, _folders()).rules
        )
    except RulecError:
        return []
    return [
        CompletionItem(rule.name, help=rule.says or None)
        for rule in rules
        if rule.name.startswith(incomplete)
    ]


def complete_scenarios(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Names of scenarios, and files."""
    from rulec.scenario import available_scenarios

    return _named(available_scenarios(), incomplete)


def complete_codes(
    ctx: click.Context, param: click.Parameter, incomplete: str
) -> list[CompletionItem]:
    """Codes of messages, with what they are about."""
    from rulec.diagnostics.codes import CODES

    return [
        CompletionItem(code, help=title)
        for code, title in CODES.items()
        if code.startswith(incomplete.upper())
    ]


def _folders() -> tuple[Path, ...]:
    """The project's own folders; while a command is typed nobody wants to hear of mistakes."""
    from rulec.settings import search_path

    try:
        return search_path()
    except RulecError:
        return ()


def _named(names: Iterable[str], incomplete: str) -> list[CompletionItem]:
    fitting = [CompletionItem(name) for name in names if name.startswith(incomplete)]
    # The first has the shell offer files as well, whose paths begin so.
    return [CompletionItem(incomplete, type="file"), *fitting]


_WEIGHT = re.compile(r"[01]|0?\.[0-9]{1,9}")
_SECONDS = re.compile(r"[0-9]{1,9}(?:\.[0-9]{1,17}|/[0-9]{1,9})?")


def seconds(
    context: click.Context, parameter: click.Parameter, value: str | None
) -> Fraction | None:
    """A step, as an option gives it."""
    if value is None:
        return None
    try:
        step = Fraction(value) if _SECONDS.fullmatch(value) else Fraction(0)
    except ZeroDivisionError:
        step = Fraction(0)
    if not step:
        raise click.BadParameter("it has to be a number above 0, such as 0.5 or 1/3")
    return step


def rulebook_option(function: Decorated) -> Decorated:
    """``--rulebook R``, required."""
    option = click.option(
        "-r",
        "--rulebook",
        required=True,
        metavar="R",
        help=RULEBOOK_HELP,
        shell_complete=complete_rulebooks,
    )
    return option(function)


def _day(context: click.Context, parameter: click.Parameter, value: str) -> str:
    """A date in ISO form; empty if none is given."""
    if not value:
        return ""
    from rulec.syntax.literals import why_not_a_day

    wrong = why_not_a_day(value)
    if wrong:
        raise click.BadParameter(f"`{value}` is no date: {wrong}")
    return value


def only_sources(rulebooks: Iterable[str], done: str) -> None:
    """Compiled rulebooks do not say enough to be ``done``, such as ``"be audited"``.

    Raises:
        click.UsageError: one of these is compiled.
    """
    compiled = next((one for one in rulebooks if one.endswith(".json")), None)
    if compiled is not None:
        raise click.UsageError(f"`{compiled}` is compiled and cannot {done}; give its source")


def output_option(function: Decorated) -> Decorated:
    """``--output FILE``, required."""
    option = click.option(
        "-o",
        "--output",
        required=True,
        metavar="FILE",
        type=click.Path(dir_okay=False, path_type=Path, allow_dash=True),
        help="The file to write; `-` is standard output.",
    )
    return option(function)


def at_option(function: Decorated) -> Decorated:
    """``--at DATE``: the day whose law it is."""
    option = click.option(
        "--at",
        default="",
        callback=_day,
        metavar="DATE",
        help="The day whose law it is: rules and parameters that were not in force then are left "
        "out.  [default: that of the rulebook's `law` line, else today]",
    )
    return option(function)


def findings_options(function: Decorated) -> Decorated:
    """``--output-format`` of findings, and ``--fail-on``: which of them make the exit status 1."""
    for decorate in (
        click.option(
            "--fail-on",
            type=click.Choice(["error", "warning"]),
            default="error",
            show_default=True,
            help="What makes the exit status 1.",
        ),
        click.option(
            "--output-format",
            type=click.Choice(FORMATS),
            default="full",
            show_default=True,
            help="Text with the lines in question, a line each, JSON, GitHub annotations, "
            "SARIF 2.1.0.",
        ),
    ):
        function = decorate(function)
    return function


def json_option(function: Decorated) -> Decorated:
    """``--json``: output for machines."""
    return click.option("--json", "json_output", is_flag=True, help="Print JSON.")(function)


def traces_format_option(function: Decorated) -> Decorated:
    """``--format``: that of files of traces."""
    return click.option(
        "--format",
        "form",
        type=click.Choice(["jsonl", "csv", "parquet"]),
        help="The format of the traces.  [default: what the file's name ends with, else jsonl]",
    )(function)


def net_option(function: Decorated) -> Decorated:
    """``--net FILE``: the roads of SUMO's floating-car data."""
    return click.option(
        "--net",
        type=click.Path(dir_okay=False, path_type=Path),
        metavar="FILE",
        help="For SUMO's floating-car data: the net.  [default: the one they name, or the only one "
        "ending in .net.xml beside them]",
    )(function)


def _prediction(
    context: click.Context, parameter: click.Parameter, value: str
) -> str | dict[str, Fraction]:
    """A kind of prediction, or several with their probabilities."""
    from rulec.scenario.alternatives import adds_up
    from rulec.scenario.recorded.choice import PREDICTIONS

    known = " or ".join(f"`{kind}`" for kind in PREDICTIONS)
    if value in PREDICTIONS:
        return value
    found: dict[str, Fraction] = {}
    for part in value.split(","):
        kind, _, weight = (one.strip() for one in part.partition("="))
        if kind not in PREDICTIONS or kind in found:
            raise click.BadParameter(f"it has to be {known}, or each of them once with a weight")
        found[kind] = Fraction(weight) if _WEIGHT.fullmatch(weight) else Fraction(0)
        if not found[kind]:
            raise click.BadParameter(f"`{part}` has to end in a weight above 0, such as `=0.7`")
    if not adds_up(sum(found.values(), Fraction(0))):
        raise click.BadParameter("the weights have to add up to 1")
    return found


def _scene_options(function: Decorated) -> Decorated:
    """What can be chosen about a recorded scene; the keywords are those of ``Choice``."""
    for decorate in (
        net_option,
        click.option(
            "--congested-below",
            "congested_below_kmh",
            type=click.FloatRange(min=0),
            default=30.0,
            show_default=True,
            metavar="KMH",
            help="In a recorded scene: traffic counts as congested below this median speed.",
        ),
        click.option(
            "--ego-width",
            "ego_width_m",
            type=click.FloatRange(min=0, max=100),
            metavar="M",
            help="In a recorded scene: how wide ego is, in m, which counts with `--extent body`.  "
            "[default: as wide as the vehicle that it is, if any; else a point]",
        ),
        click.option(
            "--prediction",
            callback=_prediction,
            default="recorded",
            show_default=True,
            metavar="KIND",
            help="In a recorded scene: others move as `recorded`, or with `constant` acceleration, "
            "or do the one or the other, as in `recorded=0.7,constant=0.3`.",
        ),
        click.option(
            "--reference",
            metavar="LANELET",
            help="In a recorded scene: the lanelet whose middle is the line along the road.  "
            "[default: the one ego is on]",
        ),
        click.option(
            "--at-time",
            "at_s",
            type=float,
            metavar="S",
            help="In a recorded scene: the moment to start from, in s.  [default: that of the "
            "planning problem, or the vehicle's first]",
        ),
        click.option(
            "--ego",
            metavar="ID",
            help="In a recorded scene: the planning problem or the vehicle that is ego.  "
            "[default: the first planning problem]",
        ),
    ):
        function = decorate(function)
    return function


def chosen(options: dict[str, Any]) -> Choice:
    """The choice that ``graph_options`` say, taken out of all options."""
    from rulec.scenario.recorded.choice import Choice

    return Choice(**{field: options.pop(field) for field in Choice.__dataclass_fields__})


def graph_options(function: Decorated) -> Decorated:
    """The scenario, and how it is cut into cells: step, horizon, partition, adjacency.

    Also what can be chosen about a recorded scene, which ``chosen`` takes out again.
    """
    function = _scene_options(function)
    for decorate in (
        click.option(
            "--adjacency",
            type=click.Choice(["touch", "edge", "forward"]),
            default="touch",
            show_default=True,
            help="Which cells are neighbours: those that meet in a point, along a border, "
            "or along a border and not only behind.",
        ),
        click.option(
            "--extent",
            type=click.Choice(["lane", "body"]),
            default="lane",
            show_default=True,
            help="How wide obstacles are: all of the lanes that they touch, or what they sweep, "
            "and half of ego's width to either side.",
        ),
        click.option(
            "--partition",
            type=click.Choice(["paper", "fine"]),
            help="Four regions around an obstacle, or eight.  [default: what the rulebook reads; "
            "paper without one]",
        ),
        click.option(
            "--horizon", "horizon_s", type=float, metavar="T", help="How far to look ahead, in s."
        ),
        click.option(
            "--step", "step_s", type=float, metavar="S", help="The planning interval, in s."
        ),
        click.argument("scenario", shell_complete=complete_scenarios),
    ):
        function = decorate(function)
    return function
