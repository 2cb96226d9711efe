"""Arguments for what is recorded: whose drives, by which thresholds, on which assumptions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import click

from rulec.cli.options.shared_options import Decorated

if TYPE_CHECKING:
    from rulec.extraction.selection.requested import RequestedDrives
    from rulec.vocabulary import Vocabulary


def drives_options(function: Decorated) -> Decorated:
    """What can be chosen about the drives of a recording; ``wanted`` takes them."""
    for decorate in (
        click.option(
            "--as-recorded",
            is_flag=True,
            help="In recorded traffic: do not mirror it where the rulebook's traffic keeps to the "
            "other side.",
        ),
        click.option(
            "--threshold",
            "thresholds",
            multiple=True,
            metavar="NAME=NUMBER",
            help="In recorded traffic: one of the numbers by which words are derived.",
        ),
        click.option(
            "--assume",
            "assumed",
            multiple=True,
            metavar="NAME=VALUE",
            help="In recorded traffic: what holds all along, such as built_up=true.",
        ),
    ):
        function = decorate(function)
    return function


def egos_option(function: Decorated) -> Decorated:
    """``--ego``, any number of them."""
    return click.option(
        "--ego",
        "egos",
        multiple=True,
        metavar="ID",
        help="In recorded traffic: only this vehicle's drive.  [default: everybody's]",
    )(function)


def given(options: Mapping[str, Any]) -> str | None:
    """One of the options that somebody has given, if any."""
    names = {
        "assumed": "--assume",
        "thresholds": "--threshold",
        "as_recorded": "--as-recorded",
    }
    return next((names[name] for name, value in options.items() if value), None)


def wanted(
    egos: tuple[str, ...], options: Mapping[str, Any], vocabulary: Vocabulary | None
) -> RequestedDrives:
    """What the options say.

    Raises:
        click.BadParameter: an assumption or a threshold is none.
    """
    from rulec.extraction.selection.option_values import assumption_options, threshold_options
    from rulec.extraction.selection.requested import RequestedDrives

    if options["assumed"] and vocabulary is None:
        raise click.UsageError("--assume needs a rulebook, in whose words it is: --rulebook R")
    try:
        return RequestedDrives(
            egos,
            threshold_options(options["thresholds"]),
            {} if vocabulary is None else assumption_options(options["assumed"], vocabulary),
            options["as_recorded"],
        )
    except ValueError as problem:
        raise click.UsageError(f"{problem}.") from None
