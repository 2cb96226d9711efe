"""What the pictures of ``rulec draw`` have in common: where they go, and in which format."""

from __future__ import annotations

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from rulec.cli.options.shared_options import Decorated, output_option

if TYPE_CHECKING:
    from rulec.report.pictures.drawing.picture_formats import Drawing


def picture_options(function: Decorated) -> Decorated:
    """``--output FILE`` and ``--format`` of pictures."""
    for decorate in (
        click.option(
            "--format",
            "form",
            type=click.Choice(["svg", "png", "html"]),
            help="The format of the picture.  [default: what the file's name ends with, else svg]",
        ),
        output_option,
    ):
        function = decorate(function)
    return function


def write(drawing: Drawing, output: Path, form: str | None) -> None:
    """Write a picture in this format, else in the one that the file's name says."""
    from rulec.files import written_whole
    from rulec.report.pictures.drawing.picture_formats import as_bytes, format_of
    from rulec.report.text.console import print_result

    data = as_bytes(drawing, form or format_of(str(output)), str(output))
    if str(output) == "-":
        sys.stdout.buffer.write(data)
        return
    with written_whole(output) as stream:
        stream.write(data)
    print_result(f"wrote {output}")
