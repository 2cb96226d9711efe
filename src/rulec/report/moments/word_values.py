"""The values of a word in a drive, by time, as far as they are known."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from rulec.extraction.moment_search import DriveMoments
from rulec.monitoring.implied_values import with_derived_values
from rulec.monitoring.moments.formula_moments import Moment
from rulec.monitoring.state_view import value_in
from rulec.monitoring.told_names import untold_names, with_untold
from rulec.monitoring.uncertainty.suppositions import spelled_out
from rulec.report.json_document import as_line
from rulec.report.moments.moment_rows import MomentLine, rows
from rulec.report.text.terminal_text import broken, counted, visible
from rulec.rulebook.query_model import FormulaQuery
from rulec.trace import Trace
from rulec.trace.trace_arrays import TraceArrays
from rulec.vocabulary import Declaration, Enumeration, Quantity
from rulec.vocabulary.partial_values import UNKNOWN, Interval, OneOf
from rulec.vocabulary.vocabulary_model import choices


@dataclass(frozen=True, slots=True)
class ValueSpan(Moment):
    """States in which a word has a ``value`` for some objects, as text.

    Numbers, which change from state to state, are one span as long as they are known.
    """

    value: str = ""


def word_spans(trace: Trace | TraceArrays, query: FormulaQuery, name: str) -> list[Moment]:
    """The values of a word in a checked trace, for one choice of objects after the other."""
    trace = trace.trace() if isinstance(trace, TraceArrays) else trace
    vocabulary = with_untold(query.vocabulary, untold_names(query.vocabulary, trace.told))
    trace = with_derived_values(spelled_out(trace, vocabulary), vocabulary)
    declared, end = vocabulary.declarations[name], len(trace.states) - 1
    spans: list[Moment] = []
    for items in choices(declared.parameters, trace.objects, vocabulary, f"`{name}`"):
        there = [trace.present.get(item, (0, end)) for item in items]
        at, last = max([0, *(own[0] for own in there)]), min([end, *(own[1] for own in there)])
        values = [value_in(x, name, items, declared) for x in trace.states[at : last + 1]]
        objects = {f"{name} of": ", ".join(items)} if items else {}
        for _, group in groupby(values, key=lambda value: _kind_of(value, declared)):
            own = [*group]
            text = _text_of(own, declared)
            spans.append(ValueSpan(objects, at, at + len(own) - 1, "surely", text))
            at += len(own)
    return spans


def _kind_of(value: Any, declared: Declaration) -> object:
    """What is the same for values that are said together."""
    is_known = value is not None and value is not UNKNOWN
    return is_known if isinstance(declared, Quantity) else value if is_known else UNKNOWN


def _text_of(values: Sequence[Any], declared: Declaration) -> str:
    """The text of equal values, or of the range of numbers."""
    value = values[0]
    if value is None or value is UNKNOWN:
        return "not known"
    if isinstance(declared, Quantity):
        ends = [(x.low, x.high) if isinstance(x, Interval) else (x, x) for x in values]
        low, high = min(own[0] for own in ends), max(own[1] for own in ends)
        wide = max(own[1] - own[0] for own in ends)
        known = f", each known within {wide:.4g} {declared.unit}" if wide else ""
        return f"{_range(f'{low:.6g}', f'{high:.6g}')} {declared.unit}{known}"
    if isinstance(value, OneOf):
        return " or ".join(sorted(value.values))
    return str(value) if isinstance(declared, Enumeration) else "yes" if value else "no"


def _range(low: str, high: str) -> str:
    return low if low == high else f"{low} to {high}"


class ValueLine(MomentLine, frozen=True, kw_only=True):
    """The ``value`` of a word from one time to another, for some ``objects`` of a drive."""

    value: str


def json_lines(drive: DriveMoments) -> Iterator[str]:
    """A line of JSON for each span."""
    for row, span in zip(rows(drive), drive.moments, strict=True):
        assert isinstance(span, ValueSpan), "a value has been looked for"
        yield as_line(ValueLine(**{**row, "objects": dict(span.objects), "value": span.value}))


def lines(drive: DriveMoments, name: str, width: int) -> Iterator[str]:
    """The drive, then a line for each span; objects with the usual value alone are counted."""
    yield visible(f"{name} in the drive of {drive.vehicle}, {drive.recording or drive.file}")
    spans = [span for span in drive.moments if isinstance(span, ValueSpan)]
    groups = [[*own] for _, own in groupby(spans, key=lambda span: span.objects)]
    alone = [own[0].value for own in groups if len(own) == 1]
    usual = max(dict.fromkeys(alone), key=alone.count) if len(alone) > 1 else None
    for span in (x for own in groups if len(own) > 1 or own[0].value != usual for x in own):
        about = "".join(f"{word} {item}: " for word, item in span.objects.items())
        when = _range(*(f"{drive.time_s(state):g}" for state in (span.first, span.last))) + " s"
        yield from broken(visible(f"  {about}{when}: {span.value}"), width, later="    ")
    if usual is not None:
        yield f"  {usual} for {counted(alone.count(usual), 'other')}, as long as they are there"
