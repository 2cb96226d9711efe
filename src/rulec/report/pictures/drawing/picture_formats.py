"""A drawing as the bytes of an SVG, PNG or HTML file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from textwrap import wrap
from typing import Literal, cast, get_args

from rulec.report.pictures.drawing.html_viewer import as_page
from rulec.report.pictures.drawing.marks import LINE_HEIGHT, MARGIN, LabelText, Picture, stacked
from rulec.report.pictures.drawing.png import as_png
from rulec.report.pictures.drawing.svg import as_svg
from rulec.report.pictures.drawing.text_metrics import CHARACTER

Format = Literal["svg", "png", "html"]


@dataclass(frozen=True, slots=True)
class Drawing:
    """Titled pictures, one for each moment, with a legend of their colours."""

    title: str
    pictures: Sequence[Picture]
    legend: Picture | None = None


def format_of(file: str) -> Format:
    """The format that a file's name asks for."""
    ending = Path(file).suffix.lower().lstrip(".")
    return cast("Format", ending) if ending in get_args(Format) else "svg"


def as_bytes(drawing: Drawing, form: str, file: str) -> bytes:
    """The file's content.

    Raises:
        RulecError: R0707 if a PNG cannot be made.
    """
    if form == "html":
        return as_page(drawing.title, drawing.pictures, drawing.legend).encode()
    width = max(picture.width for picture in drawing.pictures)
    lines = wrap(drawing.title, int((width - 2 * MARGIN) / CHARACTER))
    words = tuple(
        LabelText(line, (MARGIN, MARGIN + n * LINE_HEIGHT), style="strong")
        for n, line in enumerate(lines)
    )
    head = Picture(drawing.title, width, MARGIN + len(lines) * LINE_HEIGHT, words)
    below = [drawing.legend] if drawing.legend else []
    whole = stacked(drawing.title, [head, *drawing.pictures, *below])
    if form == "png":
        return as_png(whole, file)
    return f"{as_svg(whole)}\n".encode()
