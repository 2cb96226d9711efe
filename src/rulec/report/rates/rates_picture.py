"""A forest plot of rates: a row per rule, with a mark for its rate and lines for its intervals.

Lewis and Clarke, "Forest plots: trying to see the wood and the trees" (2001). The axis is
logarithmic, since rates differ by orders of magnitude; 0 is to the left of it.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from math import ceil, floor, log10

from rulec.rates.exact_intervals import Interval
from rulec.rates.rule_rates import RATES, Rate, RuleRates, ViolationRates
from rulec.report.pictures.drawing.canvas import (
    CHARACTER,
    MARGIN,
    WIDTH,
    LabelText,
    Mark,
    Picture,
    Polyline,
    centred,
    filled,
    text_width,
)
from rulec.report.pictures.drawing.picture_formats import Drawing
from rulec.report.rates.rates_table import group_title, number
from rulec.report.text.terminal_text import clipped

PER = {"per_hour": "per hour", "per_1000_km": "per 1000 km", "per_opportunity": "per opportunity"}
"""The rates that a picture can show -> their names."""

_ROW = 34.0
_BESIDE = 5.0
"""Distance of the outer intervals from the middle of a row."""
_HEAD = 30.0
_FOOT = 26.0
_LONGEST_NAME = 380.0
_TO_ZERO = 28.0
"""Distance of 0 to the left of the lowest power of ten."""
_MOST_DECADES = 6


def rates_drawing(rates: ViolationRates, per: str) -> Drawing:
    """The forest plot of one rate (a name in ``PER``); its title explains what is shown."""
    assert per in RATES, "there are three rates"
    shown = [
        (rule, rate)
        for rule in rates.rules
        if (rate := getattr(rule, per)) is not None and rule.perhaps_opportunities
    ]
    books = ", ".join(by.rulebook for by in rates.judged_by)
    percent = f"{100 * rates.confidence:g} %"
    title = (
        f"Violations {PER[per]} by {books}: {rates.drives:,} drives; {percent} intervals, "
        "above for independent opportunities, in the middle over drives, below for independent "
        "drives of any kind; two boxes: the least and the most"
    )
    return Drawing(title, [_forest(title, rates, shown)], None)


def _forest(title: str, rates: ViolationRates, shown: Sequence[tuple[RuleRates, Rate]]) -> Picture:
    height = _HEAD + _ROW * max(len(shown), 1) + _FOOT
    names = [_name(rule, rates) for rule, _ in shown]
    left = MARGIN + min(text_width(names), _LONGEST_NAME) + MARGIN + _TO_ZERO
    values = [value for _, rate in shown for value in _values(rate) if value > 0]
    if not values:
        nothing = LabelText("no rule was put to the test", (MARGIN, _HEAD))
        return Picture(title, WIDTH, height, (nothing,))
    low, high = _decades(values)
    scale = (WIDTH - 2 * MARGIN - left) / (high - low)

    def across(value: float) -> float:
        if value <= 0:
            return left - _TO_ZERO
        return left + scale * (min(max(log10(value), low), high) - low)

    bottom = height - _FOOT
    marks: list[Mark] = []
    for value in (0.0, *(10.0**decade for decade in range(low, high + 1))):
        x = across(value)
        marks.append(Polyline(((x, _HEAD / 2), (x, bottom)), "unsaid"))
        marks.append(LabelText(f"{value:g}", (x, bottom + _FOOT / 2), "middle", "faint"))
    for place, ((_, rate), name) in enumerate(zip(shown, names, strict=True)):
        y = _HEAD + _ROW * (place + 0.5)
        marks.append(LabelText(clipped(name, int(_LONGEST_NAME / CHARACTER)), (MARGIN, y)))
        marks += _row(rate, y, across)
    return Picture(title, WIDTH, height, tuple(marks))


def _row(rate: Rate, y: float, place: Callable[[float], float]) -> Iterator[Mark]:
    yield from _bar(rate.exact, y - _BESIDE, "satisfying", place, "independent opportunities")
    if rate.bootstrap is not None:
        yield from _bar(rate.bootstrap, y, "rejected", place, "over drives")
    yield from _bar(
        rate.clustered, y + _BESIDE, "accepted", place, "independent drives of any kind"
    )
    for value in {rate.least, rate.most}:
        tip = f"{number(rate.least)} to {number(rate.most)}"
        yield filled(centred((place(value), y), 3.0, 8.0), "own", tip)


def _bar(
    interval: Interval, y: float, style: str, place: Callable[[float], float], title: str
) -> Iterator[Mark]:
    low, high = interval
    tip = f"{title}: {number(low)} to {number(high)}"
    yield Polyline(((place(low), y), (place(high), y)), style, tip)
    for end in (low, high):
        yield Polyline(((place(end), y - 3), (place(end), y + 3)), style)


def _values(rate: Rate) -> Iterator[float]:
    yield from (rate.least, rate.most, *rate.exact, *rate.clustered, *(rate.bootstrap or ()))


def _decades(values: Sequence[float]) -> tuple[int, int]:
    high = max(ceil(log10(max(values))), floor(log10(max(values))) + 1)
    return max(floor(log10(min(values))), high - _MOST_DECADES), high


def _name(rule: RuleRates, rates: ViolationRates) -> str:
    group = group_title(rule.group, rates.by)
    return f"{rule.rule} ({group})" if group else rule.rule
