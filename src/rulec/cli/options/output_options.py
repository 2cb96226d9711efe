"""Where an answer goes, and in which format: one rule for all verbs.

The ending of the file decides, `--output-format` where it is given, whose short form is `--json`.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any, TypeVar

import click

Decorated = TypeVar("Decorated", bound=Callable[..., Any])

Endings = Mapping[str, Sequence[str]]
"""Name of a format -> how its files end. The first is what is written where nothing says."""


class _Renamed(click.Option):
    """An option whose further names still work, and are no longer shown."""

    def get_help_record(self, ctx: click.Context) -> tuple[str, str] | None:
        shown, self.opts = self.opts, self.opts[:1]
        try:
            return super().get_help_record(ctx)
        finally:
            self.opts = shown


TABLES: Endings = {
    "jsonl": (".jsonl", ".ndjson"),
    "csv": (".csv",),
    "parquet": (".parquet", ".pq"),
}
"""The formats of traces and of tables."""


def input_format_option(
    names: Sequence[str], what: str, former: str = ""
) -> Callable[[Decorated], Decorated]:
    """``--input-format NAME``, which was called ``former``."""
    return click.option(
        *filter(None, ("--input-format", former)),
        "input_format",
        cls=_Renamed,
        metavar="NAME",
        type=click.Choice(names),
        help=f"The format of {what}.",
    )


def output_options(
    endings: Endings,
    what: str,
    *,
    required: bool = False,
    json: bool = False,
    multiple: bool = False,
    former: str = "",
) -> Callable[[Decorated], Decorated]:
    """``-o FILE`` and ``--output-format NAME`` of an answer; with ``json`` also ``--json``.

    ``required``: it goes to a file; standard output has to be asked for. ``multiple``: to several.
    ``former`` is what ``--output-format`` was called.
    """
    default = next(iter(endings))
    options = [
        click.option(
            "-o",
            "--output",
            "outputs" if multiple else "output",
            required=required,
            multiple=multiple,
            metavar="FILE",
            type=click.Path(dir_okay=False, allow_dash=True),
            help=f"Write {what} to FILE, whose ending says the format; `-` is standard output."
            + (" May be given several times." if multiple else "")
            + ("" if required else "  [default: standard output]"),
        ),
        click.option(
            *filter(None, ("--output-format", former)),
            "output_format",
            cls=_Renamed,
            type=click.Choice(list(endings)),
            help=f"The format of {what}.  [default: what FILE ends with; {default} on standard "
            "output]",
        ),
    ]
    if json:
        options.append(
            click.option(
                "--json", "json_output", is_flag=True, help="The same as --output-format json."
            )
        )

    def decorate(function: Decorated) -> Decorated:
        for option in reversed(options):
            function = option(function)
        return function

    return decorate


def chosen_format(
    endings: Endings,
    output: str | Path | None,
    output_format: str | None,
    *,
    json_output: bool = False,
) -> str:
    """The format to write: the one that is named, else that of the file's ending, else the first.

    Raises:
        click.UsageError: a file that ends in none of these, or two formats.
    """
    if json_output and output_format not in (None, "json"):
        raise click.UsageError(f"--json and --output-format {output_format} contradict each other.")
    if json_output:
        return "json"
    if output_format is not None:
        return output_format
    if output is None or str(output) == "-" or _is_device(Path(output)):
        return next(iter(endings))
    name = Path(output).name.lower()
    for form, suffixes in endings.items():
        if any(name.endswith(suffix) for suffix in suffixes):
            return form
    known = ", ".join(suffix for suffixes in endings.values() for suffix in suffixes)
    raise click.UsageError(
        f"`{output}` does not say by its ending what to write. Let it end in one of {known}, or "
        f"name the format: --output-format {next(iter(endings))}"
    )


def _is_device(path: Path) -> bool:
    """True for a pipe or a device such as /dev/null."""
    return path.exists() and not path.is_file() and not path.is_dir()
