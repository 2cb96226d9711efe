"""Every explanation's bad example gets its code and no other; the mended one gets none."""

import io
import json
import os
import re
import shlex
import subprocess
import sys

import pytest

import rulec
from rulec import compile_rulebook, find_maneuvers
from rulec.book_tests.example_coverage import uncovered_verdicts
from rulec.cli.main import main
from rulec.diagnostics import RulecError
from rulec.monitoring.batch.by_states import verify_or_reason
from rulec.partition import navigation_graph
from rulec.report.findings.code_registry import all_codes
from rulec.resources import codes_page
from rulec.rulebook.loader import diagnose, parse_rulebook
from rulec.scenario.scenario_files import read_scenario
from rulec.trace.formats.trace_files import read_traces

CODE = re.compile(r"\[(R\d{4})\]")


def checked(text, folder):
    return diagnose("example.rules", text.encode()).findings


def compiled(text, folder):
    path = folder / "example.rules"
    path.write_text(text, encoding="utf-8")
    warnings = []
    compile_rulebook(path, warn=warnings.extend)
    return warnings


def run_on_examples(text, folder):
    path = folder / "example.rules"
    path.write_text(text, encoding="utf-8")
    run = rulec.test(path)
    assert all(one.passed for one in run.outcomes)
    return [*run.warnings, *uncovered_verdicts(run)]


def analyzed(text, folder):
    path = folder / "example.rules"
    path.write_text(text, encoding="utf-8")
    return rulec.analyze(path)


def judged_on_a_graph(text, folder):
    find_maneuvers("s1", parse_rulebook(text))
    return ()


def judged(text, folder):
    path = folder / "traces.jsonl"
    path.write_text(text, encoding="utf-8")
    rules = compile_rulebook("esterle2019")
    answers = [verify_or_reason(item, rules) for item in read_traces(path)]
    return [one for answer in answers for one in getattr(answer, "error", NOTHING).diagnostics]


def cut_into_cells(text, folder):
    path = folder / "example.toml"
    path.write_text(text, encoding="utf-8")
    navigation_graph(read_scenario(path))
    return ()


def run_as_python(text, folder):
    exec(compile(text, "example", "exec"), {})
    return ()


CODES = all_codes()
NOTHING = RulecError(())
RUN = {
    "rules": checked,
    "compiled": compiled,
    "analyzed": analyzed,
    "examples": run_on_examples,
    "maneuvers": judged_on_a_graph,
    "trace": judged,
    "scenario": cut_into_cells,
    "python": run_as_python,
}


PLAIN = re.compile(r"^(rulec [^|&;$`<>\n]*?)(?: < ([\w.]+))?( > log)?$", re.MULTILINE)
"""A line that needs no shell: arguments, perhaps a file for standard input, perhaps a log."""


def ran(text, folder, monkeypatch, capsys):
    """The codes in what the command lines print, and the last one's exit status.

    Lines that are rulec alone need no process of their own; all others are a shell's, and all of
    them where the shell changes its folder or has jobs.
    """
    if "&\n" in text or re.search(r"^cd ", text, re.MULTILINE):
        return shell(text, folder)
    empty = folder / f"run{len(list(folder.iterdir()))}"
    empty.mkdir()
    codes, status, done = [], 0, 0
    for line in (*PLAIN.finditer(text), None):
        before = text[done : line.start() if line else None]
        if before.strip():
            found, status = shell(before, folder, empty)
            codes += found
        if line:
            done = line.end()
            with monkeypatch.context() as patch:
                patch.chdir(empty)
                if line[2]:
                    given = io.BytesIO((empty / line[2]).read_bytes())
                    patch.setattr("sys.stdin", io.TextIOWrapper(given))
                status = main(shlex.split(line[1])[1:])
            out, err = capsys.readouterr()
            codes += CODE.findall(err if line[3] else out + err)
    return codes, status


def shell(text, folder, empty=None):
    """The same by a shell, in a folder that is empty unless another one is given."""
    place = folder / "bin"
    place.mkdir(exist_ok=True)
    program = place / "rulec"
    program.write_text(f'#!/bin/sh\nexec "{sys.executable}" -m rulec "$@"\n')
    program.chmod(0o755)
    if empty is None:
        empty = folder / f"run{len(list(folder.iterdir()))}"
        empty.mkdir()
    done = subprocess.run(
        ["sh", "-c", text],
        cwd=empty,
        capture_output=True,
        check=False,
        env={
            **os.environ,
            "PATH": f"{place}:{os.environ['PATH']}",
            "PYTHONPATH": os.pathsep.join(filter(None, sys.path)),
        },
    )
    return CODE.findall((done.stdout + done.stderr).decode()), done.returncode


def codes_of(kind, text, folder):
    try:
        found = RUN[kind](text, folder)
    except RulecError as error:
        found = error.diagnostics
    return [one.code for one in found]


WITH_EXAMPLES = [code for code, one in CODES.items() if one.kind != "circumstance"]
COMMANDS = [code for code in WITH_EXAMPLES if CODES[code].kind == "command"]


@pytest.mark.parametrize("code", [code for code in WITH_EXAMPLES if code not in COMMANDS])
def test_the_bad_example_gets_the_code_and_the_mended_one_none(code, tmp_path):
    about = CODES[code]
    assert set(codes_of(about.kind, about.bad, tmp_path)) == {code}
    assert codes_of(about.kind, about.good, tmp_path) == []


@pytest.mark.parametrize("code", COMMANDS)
def test_the_bad_commands_get_the_code_and_their_status_and_the_mended_ones_none(
    code, tmp_path, monkeypatch, capsys
):
    about = CODES[code]
    codes, status = ran(about.bad, tmp_path, monkeypatch, capsys)
    assert (set(codes), status in {1, 2}) == ({code}, True)
    assert ran(about.good, tmp_path, monkeypatch, capsys) == ([], 0)


def test_only_what_no_input_makes_has_no_example():
    without = [code for code in CODES if code not in WITH_EXAMPLES]
    # Spot, cryptography, confinement, a scene, compilers, processes, fleets, SciPy, the system,
    # another release, faults of rulec
    compilers = ["R0751", "R0752", "R0753"]
    spot, fleets = ["R0402", "R0403"], ["R0709", "R0710", "R0711", "R0712", "R0713"]
    process = ["R0414", "R0415", "R0416", "R0417", "R0418", "R0708"]
    extras = ["R0760"]
    others, faults = ["R0717", "R0723", "R0725"], ["R0790"]
    assert without == [*spot, *process, *fleets, *others, *compilers, *extras, *faults]


def test_traces_are_lines():
    for one in CODES.values():
        if one.kind == "trace":
            assert [bool(json.loads(text)) for text in (one.bad, one.good)] == [True, True]


def test_codes_stand_in_their_stage_and_in_order():
    _, *stages = re.split(r"^## R0", codes_page().read_text(encoding="utf-8"), flags=re.MULTILINE)
    for number, section in enumerate(stages, 1):
        codes = re.findall(r"^### (R\d{4})", section, re.MULTILINE)
        assert section.startswith(f"{number}: ")
        assert codes
        assert all(code.startswith(f"R0{number}") for code in codes)
    assert list(CODES) == sorted(CODES)


@pytest.mark.parametrize("code", CODES)
def test_an_explanation_is_written_for_people(code):
    about = CODES[code]
    assert about.title[0].islower() or about.title.startswith("Spot")
    assert about.why[0].isupper()
    assert about.why.endswith(".")
    assert about.bad != about.good or about.kind == "circumstance"
