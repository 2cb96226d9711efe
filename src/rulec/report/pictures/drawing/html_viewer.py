"""Pictures as one self-contained HTML page, complete without its script."""

from __future__ import annotations

from collections.abc import Sequence
from html import escape
from pathlib import Path

from rulec.report.findings.source_excerpt import visible
from rulec.report.pictures.drawing.marks import Picture
from rulec.report.pictures.drawing.styles import as_css
from rulec.report.pictures.drawing.svg import as_inline_svg, styles_of

# The page may show itself and fetch nothing.
_POLICY = "default-src 'none'; style-src 'unsafe-inline'; script-src 'unsafe-inline'"


def as_page(title: str, pictures: Sequence[Picture], legend: Picture | None) -> str:
    """Write the page, with a slider for several pictures."""
    told = escape(visible(title))
    used = styles_of([*pictures, *([legend] if legend is not None else [])])
    frames = "\n".join(_figure(picture) for picture in pictures)
    parts = [
        f'<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n<title>{told}</title>',
        f'<meta http-equiv="Content-Security-Policy" content="{_POLICY}">',
        '<meta name="viewport" content="width=device-width, initial-scale=1">',
        '<meta name="color-scheme" content="light dark">',
        f"<style>\n{as_css(used)}\n{_beside('page.css')}</style>\n</head>",
        f"<body>\n<main>\n<h1>{told}</h1>",
    ]
    if len(pictures) > 1:
        parts.append(_SLIDER.format(last=len(pictures) - 1))
    parts.append(f'<div id="frames">\n{frames}\n</div>')
    if legend is not None:
        parts.append(f"<aside>\n{as_inline_svg(legend)}\n</aside>")
    if len(pictures) > 1:
        parts.append(f"<script>\n{_beside('slider.js')}</script>")
    return "\n".join([*parts, "</main>\n</body>\n</html>\n"])


_SLIDER = """\
<form id="time" hidden>
<label for="slider">Time</label>
<input id="slider" type="range" min="0" max="{last}" value="0" step="1">
<output id="shown" for="slider"></output>
<label><input id="all" type="checkbox"> all at once</label>
</form>"""


def _beside(name: str) -> str:
    return Path(__file__).with_name(name).read_text(encoding="utf-8")


def _figure(picture: Picture) -> str:
    name = escape(visible(picture.title), quote=True)
    drawn = as_inline_svg(picture)
    return f'<figure data-title="{name}" tabindex="0">\n{drawn}\n</figure>'
