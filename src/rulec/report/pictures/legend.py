"""Legend of a picture's styles and words."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from textwrap import wrap

from rulec.report.pictures.drawing.marks import (
    LINE_HEIGHT,
    Area,
    LabelText,
    Mark,
    Picture,
    Polyline,
    rectangle,
)
from rulec.report.pictures.drawing.styles import STYLES
from rulec.report.pictures.drawing.text_metrics import CHARACTER, text_width

_SWATCH = 26.0
_GAP = 22.0


@dataclass(frozen=True, slots=True)
class LegendEntry:
    """A style and what it stands for."""

    style: str
    words: str


def legend(
    entries: Sequence[LegendEntry], words: Sequence[str], width: float, margin: float
) -> Picture:
    """Lay out swatches with their words, then lines of words."""
    marks: list[Mark] = []
    x, y = margin, LINE_HEIGHT
    for entry in entries:
        needed = _SWATCH + 6 + text_width([entry.words])
        if x > margin and x + needed > width - margin:
            x, y = margin, y + LINE_HEIGHT + 2
        marks.append(_swatch(entry.style, x, y))
        marks.append(LabelText(entry.words, (x + _SWATCH + 6, y)))
        x += needed + _GAP
    if entries:
        y += LINE_HEIGHT + 4
    for text in words:
        for line in wrap(text, int((width - 2 * margin) / CHARACTER)):
            marks.append(LabelText(line, (margin, y), style="faint"))
            y += LINE_HEIGHT
    return Picture("", width, y + 2, tuple(marks))


def _swatch(style: str, x: float, y: float) -> Mark:
    if STYLES[style].fill or style == "goal":
        return Area((rectangle(x, y - 6, x + _SWATCH, y + 6),), style)
    return Polyline(((x, y), (x + _SWATCH, y)), style)
