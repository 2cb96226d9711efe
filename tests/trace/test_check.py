"""What every trace has to be, read or made by hand."""

import math

import pytest

from rulec.diagnostics import RulecError, SourceLocation
from rulec.trace import Trace
from rulec.trace.trace_model import check_trace

PLACE = SourceLocation("t.jsonl", 3)
OBJECTS = {"v1": "vehicle"}


@pytest.mark.parametrize(
    ("trace", "code", "words"),
    [
        (Trace("t", 1.0, {}, (), {}, PLACE), "R0506", "no states"),
        (Trace("t", 0.0, {}, ({},), {}, PLACE), "R0501", "`step_s` is 0;"),
        (Trace("t", -1.0, {}, ({},), {}, PLACE), "R0501", "`step_s` is -1;"),
        (Trace("t", math.nan, {}, ({},), {}, PLACE), "R0501", "`step_s` is nan;"),
        (Trace("t", math.inf, {}, ({},), {}, PLACE), "R0501", "`step_s` is inf;"),
        (Trace("t", 1.0, {}, ({}, None), {}, PLACE), "R0501", "state 1"),
        (Trace("t", 1.0, OBJECTS, ({},), {"v2": (0, 0)}, PLACE), "R0505", "`v2`"),
        (Trace("t", 1.0, OBJECTS, ({},), {"v1": (0, 1)}, PLACE), "R0505", "states 0 to 0"),
        (Trace("t", 1.0, OBJECTS, ({},), {"v1": (-1, 0)}, PLACE), "R0505", "states -1 to 0"),
        (Trace("t", 1.0, OBJECTS, ({}, {}), {"v1": (1, 0)}, PLACE), "R0505", "states 1 to 0"),
    ],
)
def test_what_is_no_trace(trace, code, words):
    with pytest.raises(RulecError) as caught:
        check_trace(trace)
    (diagnostic,) = caught.value.diagnostics
    assert (diagnostic.code, diagnostic.place) == (code, PLACE)
    assert words in diagnostic.message


def test_what_is_one():
    check_trace(Trace("t", 0.1, OBJECTS, ({}, {}), {"v1": (1, 1)}))
