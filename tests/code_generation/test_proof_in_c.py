"""The proof of a monitor in C: what is right passes, and every planted fault is found."""

import ctypes
import faulthandler
import os
import re
import resource
import shutil

import pytest

import rulec
from rulec.cli.main import main
from rulec.code_generation.c_files import c_source
from rulec.code_generation.compiled_c.c_library import CLibrary
from rulec.code_generation.monitor_layout import monitor_layout
from rulec.code_generation.proof import monitor_proof
from rulec.code_generation.proof.monitor_proof import proof_of
from rulec.diagnostics import RulecError
from support.builders.monitored_books import NARROW, SINCE

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
FAULTS = {
    "a threshold that is passed a little later": (r"(floors_\d+\[1u\] = \{0x1\.)4", r"\g<1>5"),
    "a threshold in another unit": (r"(floors_\d+\[1u\] = \{)(0x1\.4[^}]*)", r"\g<1>3.6 * \2"),
    "at least for more than": (r"value >= floors", "value > floors"),
    "one object less": (r"(counts_\d+\[1u\] = \{)2u", r"\g<1>1u"),
    "sides changed": (r"narrow_order\((in->\w+), (in->\w+),", r"narrow_order(\2, \1,"),
    "values in another order": (r"(digits_\d+\[3u\] = \{)0u, 1u, 1u", r"\g<1>1u, 0u, 1u"),
    "unknown for false": (
        r"KNOWN\(value\) : NARROW_FROM_TO\(0u, 1u\)",
        "KNOWN(1u) : NARROW_KNOWN(0u)",
    ),
    "a soft rule that is hard": (r"1u, 0u, 0u\},\n\};", "1u, 1u, 0u},\n};"),
    "violated for good by who has left": (
        r"best >= NARROW_PENDING\)\)",
        "best > NARROW_VIOLATED))",
    ),
    "a seat for two": (r"state->stays\[seat\] = stays \? 1u : 0u", "state->stays[seat] = 1u"),
    "only one of several states": (r"found \+= narrow_is_set[^;]*;", "found = 1u;"),
}


@pytest.fixture(scope="module")
def layout():
    return monitor_layout(rulec.compile_rulebook(rulec.parse_rulebook(NARROW), step_s=1), {})


def differs(layout, source):
    return differs_in(CLibrary(layout, source, optimised=False))


def differs_in(library):
    return [text for part in proof_of(library, 2000) for text in part.differs]


def test_what_is_generated_is_right(layout):
    library = CLibrary(layout)
    parts = list(proof_of(library, 60))
    assert [part.differs for part in parts] == [()] * 7
    _, *parts = parts
    machines = [rule.machine for rule in layout.rulebook.rules]
    assert parts[0].n == sum(len(machine.letters) for machine in machines)
    assert parts[1].n == sum(len(own.successors) * len(own.successors[0]) for own in machines)


COUNTING = """\
rulebook counting
type thing
type car is thing
signal near(o: thing)
fact count o: car (near(o)) <= 2
hard rule alone (t: thing, c: car) {
  require always (count o: car (count r: thing (r != o and near(r)) < 1) >= 2
    implies near(t) or near(c))
}
"""


def test_random_drives_go_on_where_words_are_constant():
    """Both monitors take every state: Python's would refuse one in which a constant changes."""
    text = """
    rulebook lorries
    type car
    size is one of small, large default small
    constant size
    signal loaded(c: car), red, goes default false
    constant loaded
    quantity mass in t default 1
    constant mass
    hard rule stops { require always (red and large and mass > 3 t implies not goes) }
    hard rule waits (c: car) { require always (loaded(c) implies eventually goes) }
    """
    compiled = rulec.compile_rulebook(rulec.parse_rulebook(text), step_s=1)
    parts = list(proof_of(CLibrary(monitor_layout(compiled, {"car": 4})), 400))
    assert [(part.n, part.differs) for part in parts if "which all is known" in part.subject] == [
        (400, ())
    ]
    assert [text for part in parts for text in part.differs] == []


def test_facts_that_count_and_counts_of_counts_are_no_fault():
    """C does not look at the facts; where not all is known it tells more of such a count."""
    compiled = rulec.compile_rulebook(rulec.parse_rulebook(COUNTING), step_s=1)
    assert differs_in(CLibrary(monitor_layout(compiled, {}), optimised=False)) == []


NOTHING_TOLD = """\
rulebook nothing_told
type car
signal p, near(c: car), beside(c: car, d: car) default false
mono is one of only default only
hard rule c { require always (p or count c: car (near(c)) >= 0) }
hard rule d (v: car) { require always (near(v) or count x: car (x = v and near(x)) < 0) }
hard rule e (v: car) { require always (p or -count x: car (beside(v, x)) <= 2) }
hard rule f (v: car, w: car) { require always (p or -count x: car (beside(v, x) or near(w)) <= 2) }
hard rule g (v: car) {
  require always (p or count x: car (near(x) or -count y: car (beside(v, y)) <= 2) >= 1)
}
hard rule uint8_max { require always (p or count x: car (only and near(x)) >= 1) }
"""


def test_a_read_that_tells_nothing_apart_needs_no_table():
    """``RULE_C`` besides is no name that a monitor may have."""
    compiled = rulec.compile_rulebook(rulec.parse_rulebook(NOTHING_TOLD), step_s=1)
    assert differs_in(CLibrary(monitor_layout(compiled, {}), optimised=False)) == []


QUICK = ["at least for more than", "a seat for two"]
LATER = [pytest.param(fault, marks=pytest.mark.long) for fault in FAULTS if fault not in QUICK]


@pytest.mark.parametrize("fault", [*QUICK, *LATER])
def test_a_planted_fault_is_found(layout, fault):
    pattern, instead = FAULTS[fault]
    source = c_source(layout)
    faulty, n = re.subn(pattern, instead, source, count=1)
    assert n == 1
    assert faulty != source
    assert differs(layout, faulty)


def test_a_past_that_is_taken_for_known_is_found():
    compiled = rulec.compile_rulebook(rulec.parse_rulebook(SINCE), step_s=1)
    one_seat = monitor_layout(compiled, {"car": 1})
    assert differs_in(CLibrary(one_seat, optimised=False)) == []
    source = c_source(one_seat)
    faulty = source.replace("= state->left_out[type];", "= 0u;")
    assert faulty != source
    assert differs(one_seat, faulty)


def with_open_tables(layout):
    """A library whose tables can be written, by name."""
    source = c_source(layout)
    for name in ("cells", "entries"):
        pattern = rf"static const (uint16_t narrow_{name}\[)"
        source, n = re.subn(pattern, r"static \1", source)
        assert n == 1
        source += f"void *narrow_open_{name}(void);\n"
        source += f"void *narrow_open_{name}(void) {{ return narrow_{name}; }}\n"
    return CLibrary(layout, source, optimised=False)


def open_table(library, name):
    """The bytes of a table as far as it is read."""
    layout = library.layout
    ask = library.call(f"open_{name}")
    ask.restype = ctypes.c_void_p
    n = sum(len(getattr(own, name)) for own in layout.rules)
    return (ctypes.c_uint8 * (2 * n)).from_address(ask())


def found_by_a_process(library, change):
    """Whether the proof finds a fault, or does not end: cells may lead round in a circle."""
    process = os.fork()
    if process == 0:
        faulthandler.disable()  # what a fault does to memory is of no interest
        resource.setrlimit(resource.RLIMIT_CPU, (2, 2))
        try:
            change()
            found = any(text for part in proof_of(library, 2000) for text in part.differs)
            os._exit(1 if found else 0)
        except BaseException:
            os._exit(2)
    _, status = os.waitpid(process, 0)
    assert status != 2 << 8, "the proof itself has failed"
    return status != 0


@pytest.mark.parametrize("every", [100, pytest.param(1, marks=pytest.mark.long)])
@pytest.mark.parametrize("name", ["entries", "cells"])
def test_one_bit_in_a_table_is_found(layout, name, every):
    library = with_open_tables(layout)
    table = open_table(library, name)
    missed = []
    for place in range(0, len(table) * 8, every):

        def change(place=place):
            table[place // 8] ^= 1 << place % 8

        if not found_by_a_process(library, change):
            missed.append(place)
    assert missed == []
    assert not differs_in(library)


def test_a_report_stands_beside_what_is_written(tmp_path, capsys):
    arguments = ["compile", "esterle2019", "--emit", "c", "--prove", "-o", str(tmp_path)]
    assert main(arguments) == 0
    report = (tmp_path / "esterle2019_proof.txt").read_text()
    assert "20 letters" in report
    assert report.count(": 0 differ\n") == 7


@pytest.mark.parametrize("seats", ["vehicle=1", "obstacle=1"])
def test_few_seats_are_proved_on_drives_that_fit(seats, tmp_path):
    """Beyond them the monitor says less than Python's, as it should."""
    arguments = ["compile", "esterle2019", "--emit", "c", "--prove", "-o", str(tmp_path)]
    assert main([*arguments, "--objects", seats]) == 0
    report = (tmp_path / "esterle2019_proof.txt").read_text()
    assert report.count(": 0 differ\n") == 7


def test_what_differs_is_not_written(tmp_path, monkeypatch):
    part = monitor_proof.ProofPart("steps", 3, ("rule R1, pair of state and class 2",))
    monkeypatch.setattr(monitor_proof, "proof_of", lambda *_: iter([part]))
    with pytest.raises(RulecError) as caught:
        rulec.write_monitor("esterle2019", tmp_path, prove=True)
    (diagnostic,) = caught.value.diagnostics
    assert (diagnostic.code, "class 2" in diagnostic.message) == ("R0753", True)
    assert list(tmp_path.iterdir()) == []
