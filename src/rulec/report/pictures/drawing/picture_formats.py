"""A drawing as the bytes of an SVG, PNG or HTML file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Literal, cast, get_args

from rulec.report.pictures.drawing.canvas import LINE_HEIGHT, MARGIN, Picture, paragraph, stacked
from rulec.report.pictures.drawing.png import as_png
from rulec.report.pictures.drawing.styles import as_css
from rulec.report.pictures.drawing.svg import as_inline_svg, as_svg, styles_of
from rulec.report.text.terminal_text import visible

Format = Literal["svg", "png", "html"]

# The page may show itself and fetch nothing.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'"

_SLIDER = """\
<form id="time" hidden>
<label for="slider">Time</label>
<input id="slider" type="range" min="0" max="{last}" value="0" step="1">
<output id="shown" for="slider"></output>
<label><input id="all" type="checkbox"> all at once</label>
</form>"""


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
        return _as_page(drawing).encode()
    width = max(picture.width for picture in drawing.pictures)
    lines = paragraph(drawing.title, (MARGIN, MARGIN), width - 2 * MARGIN, "strong")
    head = Picture(drawing.title, width, MARGIN + len(lines) * LINE_HEIGHT, tuple(lines))
    below = [drawing.legend] if drawing.legend else []
    whole = stacked(drawing.title, [head, *drawing.pictures, *below])
    return as_png(whole, file) if form == "png" else f"{as_svg(whole)}\n".encode()


def _as_page(drawing: Drawing) -> str:
    """One self-contained page, complete without its script."""
    title = escape(visible(drawing.title))
    below = [drawing.legend] if drawing.legend else []
    frames = "\n".join(_figure(picture) for picture in drawing.pictures)
    parts = [
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">',
        f"<title>{title}</title>",
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        '<meta name="color-scheme" content="light dark">',
        f"<style>\n{as_css(styles_of([*drawing.pictures, *below]))}\n{_beside('page.css')}</style>",
        f"</head>\n<body>\n<main>\n<h1>{title}</h1>",
    ]
    last = len(drawing.pictures) - 1
    parts += [_SLIDER.format(last=last)] if last > 0 else []
    parts.append(f'<div id="frames">\n{frames}\n</div>')
    parts += [f"<aside>\n{as_inline_svg(legend)}\n</aside>" for legend in below]
    parts += [f"<script>\n{_beside('slider.js')}</script>"] if last > 0 else []
    return "\n".join([*parts, "</main>\n</body>\n</html>\n"])


def _beside(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def _figure(picture: Picture) -> str:
    name = escape(visible(picture.title), quote=True)
    drawn = as_inline_svg(picture)
    return f'<figure data-title="{name}" tabindex="0">\n{drawn}\n</figure>'
