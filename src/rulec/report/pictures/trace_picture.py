"""Picture of a ribbon: values over time, violations at their decisive states."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import groupby

from rulec.automata.bundle.compiled_rulebook import CompiledRulebook
from rulec.report.pictures.drawing import canvas
from rulec.report.pictures.drawing.canvas import LabelText, Mark, Picture, Placing, Polyline
from rulec.report.pictures.picture_captions import ticks
from rulec.report.pictures.trace_ribbon import (
    Ribbon,
    RibbonRow,
    ValueRun,
    extremes,
    in_words,
    value_style,
)
from rulec.report.text.terminal_text import clipped, counted
from rulec.report.verdicts.verdict_report import MOST_VIOLATIONS, in_a_line
from rulec.trace.trace_model import plain_step_s

WIDEST_TITLE = 34

_ROW = 24.0
_TOP = 4.0
_INDENT = 4 * canvas.CHARACTER


@dataclass(frozen=True, slots=True)
class _Axis:
    """The time axis: state -> x coordinate of its left end; states are ``step_s`` apart."""

    left: float
    states: int
    step_s: float

    def x(self, state: float) -> float:
        return self.left + (canvas.WIDTH - canvas.MARGIN - self.left) * state / self.states


def ribbon_picture(ribbon: Ribbon, rules: CompiledRulebook) -> Picture:
    """The picture, with descriptions of the violations below it."""
    trace = ribbon.trace
    titles = [_title(row) for row in ribbon.rows]
    left = canvas.MARGIN + canvas.text_width(titles) + 10
    axis = _Axis(left, len(trace.states), plain_step_s(trace))
    flags, top = _flags(ribbon, axis)
    marks: list[Mark] = []
    labels: list[Mark] = []
    y = top
    for row, title in zip(ribbon.rows, titles, strict=True):
        labels.append(LabelText(title, (left - 10, y + _ROW / 2), "end"))
        for mark in (_segments if row.values else _curve)(row, axis, y):
            (labels if isinstance(mark, LabelText) else marks).append(mark)
        y += _ROW
    marks += [*_violations(ribbon, axis, top), *labels, *flags, *_times(axis, y)]
    explanations, bottom = _explanations(ribbon, rules, y + 2 * canvas.LINE_HEIGHT + 8)
    return Picture(trace.id, canvas.WIDTH, bottom, (*marks, *explanations))


def _explanations(
    ribbon: Ribbon, rules: CompiledRulebook, y: float
) -> tuple[list[LabelText], float]:
    by_name = {rule.name: rule for rule in rules.rules}
    explained: set[str] = set()
    labels: list[LabelText] = []
    step_s = plain_step_s(ribbon.trace)
    for n, violation in enumerate(ribbon.violations[:MOST_VIOLATIONS], 1):
        rule = by_name[violation.rule]
        when = "" if violation.step is None else f", at {violation.step * step_s:g} s"
        lines = [("ink", f"{in_a_line(violation, rule, rules.name)}{when}")]
        lines += [("faint", rule.says)] if rule.name not in explained else []
        explained.add(rule.name)
        labels.append(LabelText(str(n), (canvas.MARGIN, y), style="strong"))
        for style, text in lines:
            at, width = (canvas.MARGIN + _INDENT, y), canvas.TEXT_WIDTH - _INDENT
            paragraph = canvas.paragraph(text, at, width, style)
            labels += paragraph
            y += len(paragraph) * canvas.LINE_HEIGHT
        y += 4
    notes = []
    if len(ribbon.violations) > MOST_VIOLATIONS:
        notes.append(f"and {len(ribbon.violations) - MOST_VIOLATIONS:,} more")
    if ribbon.left_out:
        why = "no violated rule reads" if ribbon.violations else "are all default"
        notes.append(f"without {counted(ribbon.left_out, 'row')} that {why}")
    for note in notes:
        labels.append(LabelText(note, (canvas.MARGIN, y), style="faint"))
        y += canvas.LINE_HEIGHT
    return labels, y


def _flags(ribbon: Ribbon, axis: _Axis) -> tuple[list[LabelText], float]:
    numbered = sorted(
        (ribbon.decisive(violation), n) for n, violation in enumerate(ribbon.violations, 1)
    )
    flags: list[LabelText] = []
    placing = Placing()
    for state, group in groupby(numbered, key=lambda pair: pair[0]):
        numbers = [n for _, n in group]
        text = ", ".join(map(str, numbers[:4])) + (" …" if len(numbers) > 4 else "")
        half = canvas.text_width([text]) / 2
        x = min(max(axis.x(state), canvas.MARGIN + half), canvas.WIDTH - canvas.MARGIN - half)
        levels = (_TOP + level * canvas.LINE_HEIGHT + 8 for level in range(6))
        flags += placing.first_free(LabelText(text, (x, y), "middle", "strong") for y in levels)
    return flags, max((flag.at[1] for flag in flags), default=_TOP) + canvas.LINE_HEIGHT


def _violations(ribbon: Ribbon, axis: _Axis, top: float) -> Iterator[Mark]:
    bottom = top + _ROW * len(ribbon.rows)
    for state in sorted({ribbon.decisive(violation) for violation in ribbon.violations}):
        x = axis.x(state)
        yield Polyline(((x, top - 5), (x, bottom + 4)), "moment")
    for n, violation in enumerate(ribbon.violations, 1):
        x = axis.x(ribbon.decisive(violation))
        about = set(violation.binding.values())
        for place, row in enumerate(ribbon.rows):
            if about & set(row.objects):
                y = top + _ROW * place
                yield Polyline(((x, y), (x, y + _ROW)), "violation", f"{n}: {violation.rule}")


def _segments(row: RibbonRow, axis: _Axis, y: float) -> Iterator[Mark]:
    """A segment for each run of a value, with the value as text if it fits."""
    for run in row.runs:
        if run.value is None:
            yield from _unknown(row, run, axis, y)
            continue
        left, right = axis.x(run.first), axis.x(run.last + 1)
        text = in_words(run.value)
        tip = f"{row.title}: {text}, {_time_span(run, axis)}"
        yield canvas.filled((left, y + 2, right, y + _ROW - 2), value_style(row, run.value), tip)
        if canvas.text_width([text]) + 6 <= right - left:
            yield LabelText(text, ((left + right) / 2, y + _ROW / 2), "middle", "name")


def _time_span(run: ValueRun, axis: _Axis) -> str:
    return f"{run.first * axis.step_s:g} s to {(run.last + 1) * axis.step_s:g} s"


def _unknown(row: RibbonRow, run: ValueRun, axis: _Axis, y: float) -> Iterator[Mark]:
    """A hatched segment; nothing where the object is absent."""
    if not run.unknown:
        return
    left, right = axis.x(run.first), axis.x(run.last + 1)
    box = (left, y + 2, right, y + _ROW - 2)
    yield canvas.filled(box, "unknown", f"{row.title}: unknown, {_time_span(run, axis)}")
    height = box[3] - box[1]
    for n in range(1, int((right - left + height) / 6) + 1):
        foot = left + 6.0 * n
        up = min(foot - left, height)
        down = max(foot - right, 0.0)
        if up > down:
            ends = (foot - down, box[3] - down), (foot - up, box[3] - up)
            yield Polyline(ends, "hatch")


def ribbon_entries(ribbon: Ribbon) -> list[tuple[str, str]]:
    """The styles of a ribbon with their meanings, for the legend."""
    used = {
        value_style(row, run.value): row
        for row in ribbon.rows
        for run in row.runs
        if (row.values and run.value is not None) or run.unknown
    }
    entries = [("true", "true"), ("off", "false"), ("unknown", "unknown")]
    shown = [(style, text) for style, text in entries if style in used]
    words = [style for style in used if style.startswith("word")]
    if words:
        shown.append((words[0], "other colours: a word each"))
    if any(not row.values for row in ribbon.rows):
        shown.append(("curve", "a number, from its least to its greatest value"))
    if ribbon.violations:
        shown.append(("moment", "a violation is decided"))
    return shown


def _curve(row: RibbonRow, axis: _Axis, y: float) -> Iterator[Mark]:
    low, high = extremes(row)
    scale = (_ROW - 8) / (high - low) if high > low else 0.0
    bottom = y + _ROW - 4 if high > low else y + _ROW / 2
    for known, group in groupby(row.runs, key=lambda run: run.value is not None):
        if not known:
            for run in group:
                yield from _unknown(row, run, axis, y)
        else:
            points = [
                (axis.x(state), bottom - (float(run.value or 0) - low) * scale)
                for run in group
                for state in (run.first, run.last + 1)
            ]
            yield Polyline(tuple(points), "curve", row.title)


def _times(axis: _Axis, y: float) -> Iterator[Mark]:
    end = axis.states * axis.step_s
    yield Polyline(((axis.x(0), y + 2), (axis.x(axis.states), y + 2)), "axis")
    for time in ticks(0, end, 10):
        x = axis.x(time / axis.step_s)
        yield Polyline(((x, y + 2), (x, y + 6)), "axis")
        text = f"{time:g} s" if time == 0 else f"{time:g}"
        x = min(x, canvas.WIDTH - canvas.text_width([text]) / 2)
        yield LabelText(text, (x, y + 14), "middle", "faint")


def _title(row: RibbonRow) -> str:
    text = clipped(row.title, WIDEST_TITLE)
    if row.values:
        return text
    low, high = map(in_words, extremes(row))
    error = f" ±{row.error:.2g}" if row.error else ""
    return f"{text}: {low}{error}" if low == high else f"{text}: {low} to {high}{error}"
