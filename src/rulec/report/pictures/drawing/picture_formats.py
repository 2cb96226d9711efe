"""A drawing as the bytes of an SVG, PNG, PDF or HTML file."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Literal

from rulec.diagnostics import SourceLocation
from rulec.diagnostics.code import missing_package
from rulec.files.text_templates import filled
from rulec.report.pictures.drawing import canvas
from rulec.report.pictures.drawing.canvas import Area, LabelText, Mark, Picture, Point, Polyline
from rulec.report.pictures.drawing.picture_messages import PNG_UNAVAILABLE
from rulec.report.pictures.drawing.styles import STYLES, Theme, as_css
from rulec.report.text.html_page import policy
from rulec.report.text.terminal_text import visible

Format = Literal["svg", "png", "pdf", "html"]


@dataclass(frozen=True, slots=True)
class Drawing:
    """Titled pictures, one for each moment, with a legend of their colours.

    ``page`` makes the HTML page in a theme, if it differs from these pictures.
    """

    title: str
    pictures: Sequence[Picture]
    legend: Picture | None = None
    page: Callable[[Theme], str] | None = None


def as_bytes(drawing: Drawing, form: str, file: str, theme: Theme = "auto") -> bytes:
    """The content of the file; PNG and PDF are light if the theme is ``auto``.

    Raises RulecError: R0707 if a PNG or PDF cannot be made.
    """
    if form not in ("svg", "png", "pdf", "html"):
        raise ValueError(f'the form is "svg", "png", "pdf" or "html", not {form!r}')
    if form == "html":
        return (drawing.page(theme) if drawing.page else _as_page(drawing)).encode()
    width = max(picture.width for picture in drawing.pictures)
    lines = canvas.paragraph(
        drawing.title, (canvas.MARGIN, canvas.MARGIN), width - 2 * canvas.MARGIN, "strong"
    )
    head = Picture(
        drawing.title, width, canvas.MARGIN + len(lines) * canvas.LINE_HEIGHT, tuple(lines)
    )
    below = [drawing.legend] if drawing.legend else []
    whole = canvas.stacked(drawing.title, [head, *drawing.pictures, *below])
    if form == "svg":
        return f"{as_svg(whole, theme)}\n".encode()
    try:
        # matplotlib is installed on request, and takes 0.3 s.
        from rulec.report.pictures.drawing.matplotlib_file import as_printed
    except ImportError:
        raise missing_package(
            PNG_UNAVAILABLE,
            form.upper(),
            "matplotlib",
            "pictures",
            SourceLocation(file),
            otherwise="write SVG or HTML",
        ) from None
    return as_printed(whole, form, file, dark=theme == "dark")


def _as_page(drawing: Drawing) -> str:
    """A self-contained page, which is complete without its script."""
    below = [drawing.legend] if drawing.legend else []
    last = len(drawing.pictures) - 1
    here = Path(__file__)
    css, script = (here.with_name(x).read_text("utf-8") for x in ("page.css", "slider.js"))
    style = f"\n{as_css(_styles([*drawing.pictures, *below]))}\n{css}"
    scripts = [f"\n{script}"] if last > 0 else []
    places = {
        "title": escape(visible(drawing.title)),
        "policy": policy([style], scripts),
        "style": style,
        "slider": filled(here.with_name("slider.html"), {"last": last}) if last > 0 else (),
        "frames": map(_figure, drawing.pictures),
        "legend": [f"<aside>\n{_inline_svg(legend)}\n</aside>" for legend in below],
        "scripts": [f"<script>{script}</script>" for script in scripts],
    }
    return filled(here.with_name("page.html"), places)


def _figure(picture: Picture) -> str:
    name = escape(visible(picture.title), quote=True)
    drawn = _inline_svg(picture)
    return f'<figure data-title="{name}" tabindex="0">\n{drawn}\n</figure>'


def as_svg(picture: Picture, theme: Theme = "auto") -> str:
    """The content of an SVG file."""
    return _inline_svg(picture, f"<style>{style_of(picture, theme)}</style>\n")


def style_of(picture: Picture, theme: Theme) -> str:
    """The text of the style element in an SVG file."""
    return f"\n{as_css(_styles([picture]), theme)}\n"


def _styles(pictures: Iterable[Picture]) -> set[str]:
    return {"ground", *(mark.style for picture in pictures for mark in picture.marks)}


def _inline_svg(picture: Picture, style: str = "") -> str:
    size = f'width="{picture.width:.0f}" height="{picture.height:.0f}"'
    box = f'viewBox="0 0 {picture.width:.0f} {picture.height:.0f}"'
    title = escape(visible(picture.title))
    return "\n".join(
        [
            f'<svg xmlns="http://www.w3.org/2000/svg" {size} {box} role="img">',
            f'<title>{title}</title>\n{style}<rect class="ground" {size}/>',
            *(text for mark in picture.marks for text in _drawn(mark)),
            "</svg>",
        ]
    )


def _drawn(mark: Mark) -> Iterator[str]:
    match mark:
        case Area(rings, style, tip):
            path = " ".join(f"M{_through(ring)}Z" for ring in rings)
            yield f'<path class="{style}" fill-rule="evenodd" d="{path}"{_closed("path", tip)}'
        case Polyline(points, style, tip):
            shape = f'class="{style}" points="{_through(points)}"'
            yield f"<polyline {shape}{_closed('polyline', tip)}"
        case LabelText(text, (x, y), anchor, style, turned):
            turn = f' transform="rotate(-90 {x:.1f} {y:.1f})"' if turned else ""
            place = f'x="{x:.1f}" y="{y + 4:.1f}" text-anchor="{anchor}"{turn}'
            if STYLES[style].halo:
                # A separate text: many viewers do not support the order of painting fill and
                # stroke.
                halo = f'class="{style} halo" aria-hidden="true"'
                yield f"<text {halo} {place}>{escape(visible(text))}</text>"
            yield f'<text class="{style}" {place}>{escape(visible(text))}</text>'


def _through(points: tuple[Point, ...]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _closed(element: str, tip: str) -> str:
    return f"><title>{escape(visible(tip))}</title></{element}>" if tip else "/>"
