"""Styles of marks on light and dark ground.

The two colours of verdicts are blue and vermilion from Okabe and Ito's palette (Color Universal
Design, 2008), lightened for dark ground; dashes repeat their meaning.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Literal

Theme = Literal["auto", "light", "dark"]
"""The ground; ``auto`` follows the reader's preference."""


@dataclass(frozen=True, slots=True)
class Style:
    """Colour names, line width in px, and dashes (on, off) in px.

    A halo separates text from its background.
    """

    fill: str = ""
    stroke: str = ""
    width: float = 1.0
    dash: tuple[float, ...] = ()
    bold: bool = False
    halo: bool = False


STYLES: Mapping[str, Style] = MappingProxyType(
    {
        "ground": Style("ground"),
        "ink": Style("ink"),
        "strong": Style("ink", bold=True),
        "faint": Style("faint"),
        "name": Style("ink", "ground", 3, halo=True),
        "axis": Style(stroke="faint"),
        "lane": Style(stroke="faint", width=0.8, dash=(7, 7)),
        "taken": Style("taken"),
        "cell": Style("cell", "faint"),
        "crossing": Style("crossing", "faint"),
        "chosen": Style("chosen", "satisfying", 3),
        "swept": Style("swept", "rejected", 1, (3, 2)),
        "body": Style("body", "ink"),
        "state": Style("cell", "ink", 1.3),
        "accepted": Style(stroke="ink", width=1.3),
        "ego": Style("ground", "satisfying", 2),
        "goal": Style("", "ink", 1.5, (2, 3)),
        "node": Style("cell", "faint"),
        "satisfying": Style(stroke="satisfying", width=1.3),
        "rejected": Style(stroke="rejected", width=1.3, dash=(6, 4)),
        "unused": Style(stroke="unused", width=0.9, dash=(1, 3)),
        "way": Style(stroke="satisfying", width=5),
        "moment": Style(stroke="rejected", width=1.3, dash=(6, 4)),
        "violation": Style(stroke="rejected", width=5),
        "violated": Style("swept", "rejected", 1.5),
        "off": Style("ground", "faint", 0.8),
        "true": Style("chosen", "satisfying", 0.8),
        **{
            f"word{number}": Style(fill, "faint", 0.8)
            for number, fill in enumerate(
                ("crossing", "value4", "value5", "value6", "value7", "taken")
            )
        },
        "curve": Style(stroke="satisfying", width=1.8),
        "unknown": Style("ground", "faint", 0.8, (2, 2)),
        "hatch": Style(stroke="unsaid", width=1),
        "verge": Style("verge"),
        "road": Style("road", "road", 0.8),
        "footway": Style("footway", "footway", 0.8),
        "zebra": Style("crossing", "faint", 0.8),
        "solid": Style(stroke="paint", width=1.6),
        "broken": Style(stroke="paint", width=1.4, dash=(9, 9)),
        "unsaid": Style(stroke="unsaid", width=0.8),
        "vehicle": Style("vehicle", "ink", 1),
        "against": Style("swept", "rejected", 2),
        "own": Style("chosen", "satisfying", 2),
        "trail": Style(stroke="satisfying", width=1.4, dash=(1, 4)),
        "link": Style(stroke="rejected", width=2),
        "number": Style("ink", "ground", 3, bold=True, halo=True),
        "board": Style("ground", "ink", 1.2),
        "light": Style("ground", "ink", 1),
        "red": Style("red", "ink", 1),
        "yellow": Style("yellow", "ink", 1),
        "green": Style("green", "ink", 1),
    }
)

_ON_LIGHT_AND_DARK = {
    "ground": ("#ffffff", "#16191d"),
    "ink": ("#1b1f24", "#e8eaed"),
    "faint": ("#59636e", "#9aa5b1"),
    "taken": ("#d5dade", "#3a4149"),
    "cell": ("#eef3f7", "#1f262d"),
    "crossing": ("#f6eebc", "#433c14"),
    "chosen": ("#a9d5f2", "#0d4a73"),
    "swept": ("#f9d3b8", "#5a3116"),
    "body": ("#e69f00", "#8a5c00"),
    "satisfying": ("#0072b2", "#6cb8f0"),
    "rejected": ("#d55e00", "#ff9d5c"),
    "unused": ("#8d969f", "#6b747d"),
    "verge": ("#f4f6f3", "#12161a"),
    "road": ("#dfe3e6", "#2a3037"),
    "footway": ("#eae4d8", "#2b2a26"),
    "paint": ("#7b858e", "#87919b"),
    "unsaid": ("#b3bac1", "#4a525a"),
    "vehicle": ("#f7f8f9", "#59636d"),
    "red": ("#ff9a8d", "#a5231a"),
    "yellow": ("#ffd54d", "#7a5c00"),
    "green": ("#7fd6a4", "#0b6b40"),
    "value6": ("#d9d2f0", "#3d3466"),
    "value7": ("#e6d8c3", "#4d3d26"),
    "value4": ("#bfe5d9", "#0c4a3a"),
    "value5": ("#edcfdf", "#5c2f49"),
}

LIGHT = MappingProxyType({name: light for name, (light, _) in _ON_LIGHT_AND_DARK.items()})
DARK = MappingProxyType({name: dark for name, (_, dark) in _ON_LIGHT_AND_DARK.items()})


def as_css(used: Collection[str], theme: Theme = "auto") -> str:
    """CSS classes of the styles; ``auto`` is light, and dark on screens where that is preferred."""
    first = DARK if theme == "dark" else LIGHT
    dark = "\n".join(f"  {rule}" for rule in _rules(used, DARK, shape=False))
    preferred = f"@media screen and (prefers-color-scheme: dark) {{\n{dark}\n}}"
    return "\n".join(
        [
            'text { font: 12px ui-monospace, "DejaVu Sans Mono", Menlo, Consolas, monospace }',
            *_rules(used, first, shape=True),
            *([preferred] if theme == "auto" else []),
        ]
    )


def _rules(used: Collection[str], colours: Mapping[str, str], *, shape: bool) -> list[str]:
    rules = []
    for name, style in STYLES.items():
        if name not in used:
            continue
        parts = [f"fill: {colours[style.fill] if style.fill else 'none'}"]
        line = [f"stroke: {colours[style.stroke]}"] if style.stroke else []
        if shape and style.stroke:
            line.append(f"stroke-width: {style.width:g}")
        if shape and style.dash:
            line.append(f"stroke-dasharray: {' '.join(f'{length:g}' for length in style.dash)}")
        if shape and style.bold:
            parts.append("font-weight: bold")
        rules.append(f".{name} {{ {'; '.join(parts if style.halo else parts + line)} }}")
        if style.halo:
            rules.append(f".{name}.halo {{ {'; '.join([*line, 'stroke-linejoin: round'])} }}")
    return rules
