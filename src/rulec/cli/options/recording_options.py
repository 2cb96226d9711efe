"""Arguments for recorded traffic: whose drives, thresholds, assumptions."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import click

from rulec.cli.options.shared_options import combined

if TYPE_CHECKING:
    from rulec.extraction.selection import RequestedDrives
    from rulec.vocabulary import Vocabulary


drives_options = combined(
    [
        click.option(
            "--assume",
            "assumed",
            multiple=True,
            metavar="NAME=VALUE",
            help="In recorded traffic: what holds all along, such as built_up=true.",
        ),
        click.option(
            "--threshold",
            "thresholds",
            multiple=True,
            metavar="NAME=NUMBER",
            help="In recorded traffic: one of the numbers by which words are derived.",
        ),
        click.option(
            "--as-recorded",
            is_flag=True,
            help="In recorded traffic: do not mirror it where the rulebook's traffic keeps to the "
            "other side.",
        ),
    ]
)
"""How the drives of a recording become traces; ``requested_drives`` takes their values."""

egos_option = click.option(
    "--ego",
    "egos",
    multiple=True,
    metavar="ID",
    help="In recorded traffic: only this vehicle's drive.  [default: everybody's]",
)


def given_drives_option(options: Mapping[str, Any]) -> str | None:
    """One of ``drives_options`` that has been given, if any."""
    names = {
        "assumed": "--assume",
        "thresholds": "--threshold",
        "as_recorded": "--as-recorded",
    }
    return next((names[name] for name, value in options.items() if value), None)


def requested_drives(
    egos: tuple[str, ...], options: Mapping[str, Any], vocabulary: Vocabulary | None
) -> RequestedDrives:
    """The drives of these vehicles, with the values of ``drives_options``.

    Raises:
        click.BadParameter: an assumption or a threshold is none.
    """
    # numpy and shapely, 150 ms: only for recordings.
    from rulec.extraction.selection import RequestedDrives, assumption_options, threshold_options

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
