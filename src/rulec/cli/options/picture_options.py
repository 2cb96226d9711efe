"""Arguments of ``rulec draw`` for the output file and its format."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from rulec.cli.options.shared_options import combined, output_option
from rulec.cli.output import output_stream, print_written

if TYPE_CHECKING:
    from rulec.report.pictures.drawing.picture_formats import Drawing

picture_options = combined(
    [
        output_option,
        click.option(
            "--format",
            "form",
            type=click.Choice(["svg", "png", "html"]),
            help="The format of the picture.  [default: what the file's name ends with, else svg]",
        ),
    ]
)


def write(drawing: Drawing, output: Path, form: str | None) -> None:
    """Write a picture in the given format, else the file name's."""
    # Fonts and layout, 5 ms: not for --help.
    from rulec.report.pictures.drawing.picture_formats import as_bytes, format_of

    data = as_bytes(drawing, form or format_of(str(output)), str(output))
    with output_stream(output) as (stream, _):
        stream.write(data)
    print_written(str(output), output)
