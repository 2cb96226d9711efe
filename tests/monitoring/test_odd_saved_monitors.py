"""Saved monitors in which one value is odd: refused, or no other monitor."""

import json
from fractions import Fraction

import pytest

from rulec.api.named_monitor import Monitor
from rulec.diagnostics import RulecError
from rulec.monitoring.online import monitor_sources
from support.builders.rulebooks import Q, always, book, compile_here, eventually, near, rule
from support.generators.odd_documents import ODD_VALUES, places_in, with_value

RULES = compile_here(book(rule("a", always(near("x")), "x: thing"), rule("b", eventually(Q))))


@pytest.fixture(scope="module")
def saved():
    monitor = Monitor(RULES, 0.5)
    monitor.step({"place": {"t": "far"}, "q": False}, {"t": "thing"})
    return json.loads(json.dumps(monitor.snapshot()))


def refused(call):
    """The codes with which a call is refused, and what it gives if it is not."""
    try:
        return set(), call()
    except RulecError as error:
        return {problem.code for problem in error.diagnostics}, None


@pytest.mark.parametrize("name", ODD_VALUES)
def test_an_odd_value_anywhere_is_refused_or_means_nothing_else(name, saved, tmp_path):
    file = tmp_path / "monitor.json"
    for place in places_in(saved):
        data = with_value(saved, place, ODD_VALUES[name])
        codes, monitor = refused(lambda data=data: Monitor.restore(RULES, data))
        assert codes == {"R0510"} or monitor.snapshot() in (saved, data)
        assert monitor_sources.step_of(data) in (Fraction(1, 2), None)
        file.write_text(json.dumps(data))
        codes, read = refused(lambda: monitor_sources.read_saved(file))
        assert codes == {"R0510"} or read == data
