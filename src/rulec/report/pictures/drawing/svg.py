"""A self-contained SVG picture, light and dark, with tips."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from html import escape

from rulec.report.pictures.drawing.canvas import Area, LabelText, Mark, Picture, Point, Polyline
from rulec.report.pictures.drawing.styles import as_css
from rulec.report.text.terminal_text import visible


def as_svg(picture: Picture) -> str:
    """A file of its own."""
    return as_inline_svg(picture, f"<style>\n{as_css(styles_of([picture]))}\n</style>\n")


def styles_of(pictures: Iterable[Picture]) -> set[str]:
    """The names of the styles that pictures use."""
    return {"ground", *(mark.style for picture in pictures for mark in picture.marks)}


def as_inline_svg(picture: Picture, style: str = "") -> str:
    """A part of a page that has the styles."""
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
            yield f'<text class="{style}" {place}>{escape(visible(text))}</text>'


def _through(points: tuple[Point, ...]) -> str:
    return " ".join(f"{x:.1f},{y:.1f}" for x, y in points)


def _closed(element: str, tip: str) -> str:
    return f"><title>{escape(visible(tip))}</title></{element}>" if tip else "/>"
