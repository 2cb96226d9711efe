"""``rulec rates``: how often rules are violated, with intervals."""

from __future__ import annotations

from functools import partial

import click

from rulec.cli import lazy_imports as lazy
from rulec.cli.options import shared_options as shared
from rulec.cli.options.output_options import Output, endings_of, output_options
from rulec.cli.options.standard_input import not_standard_input
from rulec.cli.options.verb_class import argument, option, verb
from rulec.cli.output import put_answer, put_picture, width_of
from rulec.diagnostics.fault_messages import contained

GROUPS = ("rulebook", "country", "road", "source", "file", "recording")
PER = ("hour", "1000_km", "opportunity")
PICTURES = ("svg", "png", "pdf", "html")


def _confidence(_: click.Context, __: click.Parameter, value: float) -> float:
    if not 0.5 <= value < 1:
        raise click.BadParameter("it is a number from 0.5 to below 1, such as 0.95")
    return value


@verb
def command(
    *,
    files: tuple[str, ...] = argument(
        nargs=-1,
        required=True,
        metavar="FINDINGS...",
        callback=not_standard_input("findings say by their file's name what form they have"),
    ),
    by: tuple[lazy.GroupKey, ...] = option(
        "--by",
        multiple=True,
        type=click.Choice(GROUPS),
        help="Group drives by this. May be given several times.",
    ),
    confidence: float = option(
        "--confidence",
        type=float,
        default=0.95,
        show_default=True,
        callback=_confidence,
        metavar="P",
        help="The confidence level of the intervals.",
    ),
    seed: int = shared.number_option(
        "--seed", "The random seed of the bootstrap over drives.", default=0, most=2**32 - 1
    ),
    per: str = option(
        "--per",
        type=click.Choice(PER),
        default=PER[0],
        show_default=True,
        help="The rate that a picture shows.",
    ),
    to: Output = output_options(
        endings_of("text", "markdown", "csv", "json", *PICTURES), "the rates"
    ),
) -> None:
    """Compute how often rules are violated: per hour, per 1000 km, and per opportunity.

    FINDINGS are files written by `rulec verify --exposure -o FILE` (JSON Lines, CSV or Parquet) or
    folders written by `rulec fleet`. All drives must have been judged in the same way; several
    rulebooks are allowed only with --by rulebook.

    Each rate has three confidence intervals: an exact one for independent opportunities, a
    bootstrap over drives, and one for independent drives of any kind. This needs the extra
    `rates`: in a checkout `.venv/bin/python -m pip install -e '.[rates]'`.
    """
    with contained("no rates"):
        rates = lazy.rates_of_findings(files, by, confidence=confidence, seed=seed)
    if to.form in PICTURES:
        put_picture(lazy.rates_drawing(rates, f"per_{per}"), to)
        return
    renderers = {
        "json": lazy.rates_table.as_json,
        "csv": lazy.rates_table.as_csv,
        "markdown": lazy.rates_table.as_markdown,
    }
    render = renderers.get(to.form, partial(lazy.rates_table.as_text, width=width_of(to)))
    put_answer(render(rates), to)
