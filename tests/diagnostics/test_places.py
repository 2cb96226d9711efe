"""Where a refusal is about a place in a file, it says so; what has none is listed here."""

import ast
import io
from pathlib import Path

import pytest

from rulec.cli.main import main
from rulec.diagnostics import Diagnostic, RulecError, SourceLocation
from rulec.diagnostics.fault_messages import contained

SOURCES = Path(__file__).parents[2] / "src" / "rulec"

ARGUMENT = "what was given in a command or a call, which the message quotes"
VARIABLE = "an environment variable, which the message names"
MISSING = "a program or a package of this machine"
PYTHON = "a value in Python"
TABLE = "a table in memory, of which the message has the row or the trace"
LATER = "whoever reads the file says its place"

WITHOUT = {
    # Codes
    "BAD_CANDIDATES": PYTHON,
    "CUT_DRIVE": TABLE,
    "ENGINE_MISSING": MISSING,
    "MONITOR_COMPILER_FAILED": MISSING,
    "AUTOMATON_TOO_LARGE": "a compiled file does not say where its rules are written",
    "MONITOR_DIFFERS": LATER,
    "NAME_NOT_FOUND": ARGUMENT,
    "NET_MISSING": TABLE,
    "NOTHING_TO_RUN": ARGUMENT,
    "NOT_A_PATH": PYTHON,
    "NOT_A_RECORDING": TABLE,
    "NOT_BUILT": PYTHON,
    "NOT_COMPILED": ARGUMENT,
    "NO_COMPILER": VARIABLE,
    "NO_LIMIT": ARGUMENT,
    "NO_MONITOR_COMPILER": MISSING,
    "NO_MONITOR_IN_C": LATER,
    "NO_NAME": ARGUMENT,
    "NO_START_CELL": LATER,
    "NO_TRAJECTORY": ARGUMENT,
    "SPOT_MISSING": MISSING,
    "SPOT_NOT_CONFINED": MISSING,
    "TOO_MANY_MANEUVERS": LATER,
    "UNFITTING_BOUNDS": ARGUMENT,
    "UNFITTING_HORIZON": LATER,
    "UNFITTING_PAST": ARGUMENT,
    "UNFITTING_VALUE": ARGUMENT,
    "UNKNOWN_PARTITION": ARGUMENT,
    "UNKNOWN_SCENARIO": ARGUMENT,
    # Limits
    "CHOICES": LATER,
    "MEMORY": ARGUMENT,
    "SECONDS": ARGUMENT,
}


def without_a_place():
    """The names of codes and limits of which a message is made without a place."""
    for file in SOURCES.rglob("*.py"):
        for node in ast.walk(ast.parse(file.read_text(encoding="utf-8"))):
            match node:
                case ast.Call(
                    func=ast.Attribute(value=ast.Name(name), attr="at" | "error" | "exceeded"),
                    args=[ast.Constant(value=None), *_],
                ):
                    yield name
                case ast.Call(
                    func=ast.Attribute(value=ast.Name(name), attr="within"),
                    args=[_, ast.Constant(value=None), *_],
                ):
                    yield name


def test_what_has_no_place_is_known():
    assert {*without_a_place()} == WITHOUT.keys()


SCENARIO = """horizon_s = 3
step_s = 1
[road]
s = [0, 60]
lanes = [-2, 2]
[ego]
s = 5
d = 0
[[obstacle]]
id = "1"
type = "vehicle"
length = 4
width = 2
s = 9
d = 0
speed = -8
"""
BOOK = """rulebook book
type car
signal near(a: car, b: car) default false
hard rule gap (a: car, b: car) { require always not near(a, b) }
"""
STATES = b'{"objects": {"a": "car", "b": "car"}, "state": {}}\n'
IN_FILES = {
    "a horizon": ("maneuvers s.toml -r esterle2019 --horizon 3.3", "R0606", "s.toml"),
    "a partition": (
        "maneuvers s.toml -r esterle2019 --partition fine",
        "R0405",
        "esterle2019",
    ),
    "a start": ("maneuvers s.toml -r esterle2019", "R0607", "s.toml"),
    "a start, drawn": ("draw graph s.toml -o g.svg", "R0607", "s.toml"),
    "a start, as traces": ("traces s.toml -o -", "R0607", "s.toml"),
    "a start, as envelopes": ("envelopes s.toml -r esterle2019 -o -", "R0607", "s.toml"),
    "a monitor in C": ("compile book.rules --emit c --objects bus=1 -o c", "R0750", "book.rules"),
    "choices": ("--limit choices=1 monitor ./book.rules", "R0718", "standard input:1"),
}


@pytest.mark.parametrize("what", IN_FILES)
def test_where_it_is_known_it_is_told(what, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name, text in {"s.toml": SCENARIO, "book.rules": BOOK}.items():
        (tmp_path / name).write_text(text)
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(STATES)))
    words, code, place = IN_FILES[what]
    assert main(words.split()) == 2
    said = capsys.readouterr().err
    (told,) = [part for part in said.split("\n\n") if f"[{code}]" in part]
    (at,) = [line.split("--> ")[1] for line in told.splitlines() if "--> " in line]
    assert at.rpartition("/")[2].startswith(place)


def test_a_place_is_given_to_what_has_none():
    own, other = SourceLocation("own"), SourceLocation("other")
    with pytest.raises(RulecError) as caught, contained(place=other):
        raise RulecError([Diagnostic("R0000", "a", own), Diagnostic("R0000", "b")])
    assert [one.place for one in caught.value.diagnostics] == [own, other]
