"""The proof of a monitor in C: what is right passes, and every planted fault is found."""

import faulthandler
import os
import re
import resource
import shutil
import time

import pytest

import rulec
from rulec.cli.main import main
from rulec.code_generation.c_files import c_source
from rulec.code_generation.compiled_c.c_library import CLibrary
from rulec.code_generation.monitor_layout import monitor_layout
from rulec.code_generation.proof import monitor_proof
from rulec.code_generation.proof.monitor_proof import proof_of
from rulec.diagnostics import RulecError

pytestmark = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")

BOOK = """\
rulebook narrow
type car
signal stop, standing default false
light is one of red, amber, green default green
quantity speed in km/h default 0
quantity limit in km/h default 50
quantity gap(o: car) in m
signal parked(o: car) default false

hard rule stops { require always (stop implies eventually[<= 3 steps] standing) }
hard rule waits { require always (red implies speed <= 5 km/h) }
hard rule crawls { require always (count c: car (parked(c)) >= 2 implies speed < 36 km/h) }
hard rule keeps { require always speed - limit <= 0 km/h }
soft rule keeps_away (c: car) {
  require always (gap(c) < 8.3 m implies next (gap(c) >= 8.3 m or parked(c)))
}
"""
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
    return monitor_layout(rulec.compile_rulebook(rulec.parse_rulebook(BOOK), step_s=1), {})


def differs(layout, source):
    library = CLibrary(layout, source, optimised=False)
    return [text for part in proof_of(library, 200) for text in part.differs]


def test_what_is_generated_is_right(layout):
    library = CLibrary(layout)
    parts = list(proof_of(library, 60))
    assert [part.differs for part in parts] == [()] * 5
    machines = [rule.machine for rule in layout.rulebook.rules]
    assert parts[0].n == sum(len(machine.letters) for machine in machines)
    assert parts[1].n == sum(len(own.successors) * len(own.successors[0]) for own in machines)


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


def numbers_of(source, table):
    """Where the numbers of a table are."""
    start = re.search(rf"narrow_{table}\[\d+u\] = \{{", source).end()
    end = source.index("};", start)
    return [found.span() for found in re.finditer(r"\b\d+(?=u)", source[start:end])], start


def found_by_a_process(layout, source):
    """Whether the proof finds a fault, or does not end: cells may lead round in a circle."""
    process = os.fork()
    if process == 0:
        faulthandler.disable()  # what a fault does to memory is of no interest
        seconds = int(time.process_time()) + 4
        resource.setrlimit(resource.RLIMIT_CPU, (seconds, seconds))
        try:
            os._exit(1 if differs(layout, source) else 0)
        except BaseException:
            os._exit(2)
    _, status = os.waitpid(process, 0)
    assert status != 2 << 8, "the proof itself has failed"
    return status != 0


@pytest.mark.parametrize(
    ("table", "every"),
    [
        ("entries", 200),
        ("cells", 200),
        pytest.param("entries", 1, marks=pytest.mark.long),
        pytest.param("cells", 1, marks=pytest.mark.long),
    ],
)
def test_one_bit_in_a_table_is_found(layout, table, every):
    source = c_source(layout)
    places, start = numbers_of(source, table)
    faults = [(place, bit) for place in places for bit in range(16)][::every]
    missed = []
    for (first, end), bit in faults:
        first, end = first + start, end + start
        number = int(source[first:end]) ^ 1 << bit
        if not found_by_a_process(layout, f"{source[:first]}{number}{source[end:]}"):
            missed.append((source[first:end], bit))
    assert len(faults) > 1
    assert missed == []


def test_a_report_stands_beside_what_is_written(tmp_path, capsys):
    arguments = ["compile", "esterle2019", "--emit", "c", "--prove", "-o", str(tmp_path)]
    assert main(arguments) == 0
    report = (tmp_path / "esterle2019_proof.txt").read_text()
    assert "20 letters" in report
    assert report.count(": 0 differ\n") == 5


def test_what_differs_is_not_written(tmp_path, monkeypatch):
    part = monitor_proof.ProofPart("steps", 3, ("rule R1, pair of state and class 2",))
    monkeypatch.setattr(monitor_proof, "proof_of", lambda *_: iter([part]))
    with pytest.raises(RulecError) as caught:
        rulec.write_monitor("esterle2019", tmp_path, prove=True)
    (diagnostic,) = caught.value.diagnostics
    assert (diagnostic.code, "class 2" in diagnostic.message) == ("R0753", True)
    assert list(tmp_path.iterdir()) == []
