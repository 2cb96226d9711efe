"""The way of a trace from `verify` to its verdict, as docs/architecture.md draws it."""

import re
import sys
from itertools import groupby

import rulec
from support.source_modules import PACKAGE

ROOM = PACKAGE / "monitoring" / "batch"


def drawn():
    """The functions on the way, each with its file."""
    text = (PACKAGE.parents[1] / "docs/architecture.md").read_text(encoding="utf-8")
    _, _, table = text.partition("## The way of one trace")
    way, file = [], ""
    for own, name in re.findall(
        r"^\| (?:`(\S+)`[a-z ]*)?\| `(\S+)` \|", table.partition("\n## ")[0], re.M
    ):
        file = own or file
        way.append((file, name))
    return way


def gone(call):
    """The functions of the room that a call passes, each at its first time."""
    passed = {}

    def note(frame, event, _):
        if event == "call" and frame.f_code.co_filename.startswith(str(ROOM)):
            own = frame.f_locals.get("self")
            name = frame.f_code.co_name
            name = name if own is None else f"{type(own).__name__}.{name}"
            passed.setdefault((frame.f_code.co_filename.removeprefix(f"{ROOM}/"), name))

    sys.setprofile(note)
    try:
        call()
    finally:
        sys.setprofile(None)
    return list(passed)


def test_a_trace_goes_the_way_that_is_drawn():
    book = rulec.compile_rulebook("esterle2019")
    states = [{"surface": "R_cw", "position": {"v": "bbfl"[n % 4]}} for n in range(20)]
    trace = rulec.Trace("t", 0.5, {"v": "vehicle"}, tuple(states))
    assert rulec.verify(trace, book).violations
    way = drawn()
    assert [step for step in gone(lambda: rulec.verify(trace, book)) if step in way] == way


def test_the_way_is_short():
    way = drawn()
    visits = [file for file, _ in groupby(file for file, _ in way)]
    assert len(way) <= 14
    assert len({*visits}) <= 6
    assert len(visits) - len({*visits}) <= 3
