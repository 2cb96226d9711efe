"""Colours: what has to be told apart can be, by colour-blind eyes too, in light and dark.

Simulation of colour vision deficiency after Machado, Oliveira and Fernandes (2009), severity 1;
differences in CIELAB (1976), contrast as in WCAG 2.
"""

import numpy as np
import pytest

from rulec.report.pictures.drawing.styles import DARK, LIGHT, STYLES

SEEN = {
    "all colours": np.eye(3),
    "protanopia": np.array(
        [
            [0.152286, 1.052583, -0.204868],
            [0.114503, 0.786281, 0.099216],
            [-0.003882, -0.048116, 1.051998],
        ]
    ),
    "deuteranopia": np.array(
        [
            [0.367322, 0.860646, -0.227968],
            [0.280085, 0.672501, 0.047413],
            [-0.011820, 0.042940, 0.968881],
        ]
    ),
}

# Of linear sRGB, D65
TO_XYZ = np.array(
    [
        [0.4124564, 0.3575761, 0.1804375],
        [0.2126729, 0.7151522, 0.0721750],
        [0.0193339, 0.1191920, 0.9503041],
    ]
)


def linear(colour):
    parts = np.array([int(colour[i : i + 2], 16) / 255 for i in (1, 3, 5)])
    return np.where(parts <= 0.04045, parts / 12.92, ((parts + 0.055) / 1.055) ** 2.4)


def lab(rgb):
    ratio = TO_XYZ @ np.clip(rgb, 0, 1) / (TO_XYZ @ np.ones(3))
    f = np.where(ratio > 216 / 24389, np.cbrt(ratio), (24389 / 27 * ratio + 16) / 116)
    return np.array([116 * f[1] - 16, 500 * (f[0] - f[1]), 200 * (f[1] - f[2])])


def difference(one, other, eyes):
    return np.linalg.norm(lab(SEEN[eyes] @ linear(one)) - lab(SEEN[eyes] @ linear(other)))


def contrast(one, other):
    low, high = sorted(float((TO_XYZ @ linear(colour))[1]) for colour in (one, other))
    return (high + 0.05) / (low + 0.05)


def test_the_measures():
    """Black and white are 21 to 1; red and green come close to deuteranopes, blue does not."""
    assert contrast("#000000", "#ffffff") == pytest.approx(21, abs=0.01)
    assert difference("#ffffff", "#000000", "all colours") == pytest.approx(100, abs=0.01)
    red, green, blue = "#c04040", "#6b7a1c", "#2050c0"
    assert difference(red, green, "deuteranopia") < difference(red, green, "all colours") / 2
    assert difference(red, blue, "deuteranopia") > 50


@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
@pytest.mark.parametrize("eyes", SEEN)
def test_verdicts_are_told_apart(colours, eyes):
    assert difference(colours["satisfying"], colours["rejected"], eyes) > 60
    for fill in ("chosen", "swept", "crossing", "taken"):
        assert difference(colours["cell"], colours[fill], eyes) > 8
    assert difference(colours["chosen"], colours["swept"], eyes) > 20


@pytest.mark.parametrize("colours", [LIGHT, DARK], ids=["light", "dark"])
def test_lines_and_words_stand_out(colours):
    for line in ("satisfying", "rejected", "faint"):
        assert contrast(colours[line], colours["ground"]) >= 3
    fills = {style.fill for style in STYLES.values() if style.fill} - {"ink", "faint"}
    for fill in fills:
        assert contrast(colours["ink"], colours[fill]) >= 4.5, fill
    assert contrast(colours["faint"], colours["ground"]) >= 4.5


def test_dashes_say_what_colours_say():
    dashes = {STYLES[name].dash for name in ("satisfying", "rejected", "unused")}
    assert len(dashes) == 3


def test_both_palettes_have_every_colour():
    used = {name for style in STYLES.values() for name in (style.fill, style.stroke) if name}
    assert set(LIGHT) == set(DARK) == used
