"""A picture as PNG or PDF.

The only module that imports matplotlib, which is installed on request.
"""

from __future__ import annotations

import io
import warnings
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import PathPatch
from matplotlib.path import Path
from matplotlib.patheffects import withStroke

from rulec.diagnostics import SourceLocation
from rulec.report.pictures.drawing.canvas import Area, LabelText, Mark, Picture, Point, Polyline
from rulec.report.pictures.drawing.picture_messages import PNG_UNAVAILABLE
from rulec.report.pictures.drawing.styles import DARK, LIGHT, STYLES
from rulec.report.text.terminal_text import visible

DOTS_PER_PX = 2
"""Enough for printing."""

MOST_DOTS = 30_000
"""A picture larger in either direction is drawn with one dot per px, or not at all."""

_POINTS = 72 / 96
"""One px in points, matplotlib's unit for widths and font sizes."""


_METADATA: Mapping[str, Mapping[str, None]] = {
    "png": {"Software": None},
    "pdf": {"Creator": None, "Producer": None, "CreationDate": None},
}

_ALIGNMENTS = {"start": "left", "middle": "center", "end": "right"}


def as_printed(picture: Picture, form: str, file: str, *, dark: bool = False) -> bytes:
    """The picture on a light or dark ground.

    Raises RulecError: R0707 if the picture is too large.
    """
    largest = max(picture.width, picture.height)
    if largest > MOST_DOTS:
        message = (
            f"the picture is {largest:,.0f} px long; as {form.upper()} it may have {MOST_DOTS:,}"
        )
        way_out = "write SVG or HTML, or draw fewer layers"
        raise PNG_UNAVAILABLE.error(SourceLocation(file), message, help=way_out)
    dots = DOTS_PER_PX if largest * DOTS_PER_PX <= MOST_DOTS else 1
    colours = DARK if dark else LIGHT
    size = picture.width / 96, picture.height / 96
    figure = Figure(size, 96 * dots, facecolor=colours["ground"])
    axes = figure.add_axes((0, 0, 1, 1))
    axes.set_axis_off()
    axes.set_xlim(0, picture.width)
    axes.set_ylim(picture.height, 0)
    for order, mark in enumerate(picture.marks):
        _draw(axes, mark, order, colours)
    stream = io.BytesIO()
    FigureCanvasAgg(figure)
    with warnings.catch_warnings():
        # A character that the font lacks is drawn as a box; the warning would help no user.
        warnings.filterwarnings("ignore", "Glyph .* missing", UserWarning)
        # No metadata that differ between runs.
        figure.savefig(stream, format=form, metadata=_METADATA[form])
    return stream.getvalue()


def _draw(axes: Any, mark: Mark, order: int, colours: Mapping[str, str]) -> None:
    style = STYLES[mark.style]
    stroke = colours[style.stroke] if style.stroke else "none"
    width = style.width * _POINTS
    dash = (0, tuple(length * _POINTS for length in style.dash)) if style.dash else "solid"
    match mark:
        case Area(rings):
            turned_rings = [_turning(ring, left=n == 0) for n, ring in enumerate(rings)]
            paths = [Path([*ring, ring[0]], closed=True) for ring in turned_rings]
            path = Path.make_compound_path(*paths)
            fill = colours[style.fill] if style.fill else "none"
            axes.add_patch(
                PathPatch(path, fc=fill, ec=stroke, lw=width, ls=dash, zorder=order, clip_on=False)
            )
        case Polyline(points):
            xs, ys = zip(*points, strict=True)
            axes.add_line(Line2D(xs, ys, color=stroke, lw=width, ls=dash, zorder=order))
        case LabelText(text, (x, y), anchor, _, turned):
            around = [withStroke(linewidth=width, foreground=stroke)] if style.halo else None
            axes.text(
                x,
                y,
                visible(text).replace("$", r"\$"),
                color=colours[style.fill],
                size=12 * _POINTS,
                family="DejaVu Sans Mono",
                weight="bold" if style.bold else "normal",
                ha="center" if turned else _ALIGNMENTS[anchor],
                va="center",
                rotation=90 if turned else 0,
                zorder=order,
                path_effects=around,
            )


def _turning(ring: Sequence[Point], *, left: bool) -> Sequence[Point]:
    """A ring oriented to the left or right, as matplotlib needs it for filling."""
    area = sum(x0 * y1 - x1 * y0 for (x0, y0), (x1, y1) in pairwise([*ring, ring[0]]))
    return ring if (area > 0) == left else ring[::-1]
