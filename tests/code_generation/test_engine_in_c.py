"""`verify --engine c` finds what Python's engines find, and says who judged."""

import errno
import json
import shutil
from dataclasses import replace
from fractions import Fraction
from pathlib import Path

import pytest
from hypothesis import Phase, given, settings

import rulec
from rulec.cli.main import main
from rulec.files.written_files import temporary_files
from support.builders.rulebooks import compile_here
from support.generators.blurred_traces import blurred
from support.generators.random_rulebooks import rulebook
from support.generators.random_traces import traces
from support.generators.seeds import seeds

needs_a_compiler = pytest.mark.skipif(shutil.which("cc") is None, reason="there is no C compiler")
TRACE = {
    "id": "t",
    "step_s": 1,
    "objects": {"a": "vehicle", "b": "vehicle"},
    "states": [{"position": {"a": at, "b": "b"}} for at in "brf"],
}


def answer(one):
    return (one.trace, one.error.diagnostics[0].code) if hasattr(one, "error") else one


@needs_a_compiler
@given(seeds)
@settings(phases=[Phase.generate], max_examples=max(1, settings().max_examples // 50))
def test_what_python_finds(chance):
    step_s = chance.choice([Fraction(1), Fraction(1, 2)])
    book = rulebook(chance, step_s)
    compiled = compile_here(book, step_s)
    given = list(traces(chance, step_s))
    names = {name for trace in given for state in trace.states for name in state}
    given += [blurred(chance, trace, names, most=3) for trace in given[:2]]
    given.append(replace(given[0], ends="cut"))
    ours = list(rulec.verify_many(given, compiled))
    theirs = list(rulec.verify_many(given, compiled, engine="c"))
    assert list(map(answer, theirs)) == list(map(answer, ours))
    assert getattr(theirs[-1], "engine", "python") == "python"


@pytest.fixture
def files(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    unknown = json.loads(json.dumps(TRACE))
    unknown["states"][1]["position"]["a"] = None
    lines = [TRACE, unknown | {"id": "u"}]
    (tmp_path / "t.jsonl").write_text("\n".join(map(json.dumps, lines)), encoding="utf-8")
    return ["verify", "t.jsonl", "-r", "esterle2019"]


@needs_a_compiler
def test_it_says_which_engine_judged(files, capsys):
    assert main([*files, "--engine", "c", "--json"]) == 1
    found = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert [one["engine"] for one in found] == ["c", "python"]
    assert main([*files, "--json"]) == 1
    usual = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    assert usual == [{k: v for k, v in one.items() if k != "engine"} for one in found]
    assert main([*files, "--engine", "c"]) == 1
    assert "engine: 1 judged in C, compiled by " in capsys.readouterr().out


@pytest.mark.parametrize(("command", "code"), [("no-such-compiler", "R0751"), ("false", "R0752")])
def test_it_takes_no_other_engine_in_silence(files, command, code, capsys, monkeypatch):
    monkeypatch.setenv("CC", command)
    assert main([*files, "--engine", "c"]) == 2
    shown = capsys.readouterr()
    assert f"error[{code}]" in shown.err
    assert "violated" not in shown.out.replace("0 violated", "")


def test_a_full_temporary_folder_is_named(files, capsys, monkeypatch, tmp_path):
    """It is not standard output that is full."""

    def full(*_):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(Path, "write_text", full)
    assert main([*files, "--engine", "c"]) == 2
    shown = capsys.readouterr().err
    assert "error[R0723]: temporary files cannot be written to this folder: no space" in shown
    assert str(tmp_path) in shown
    assert "`TMPDIR`" in shown


@pytest.mark.parametrize(
    ("problem", "is_ours"),
    [
        (OSError(errno.ENOSPC, "No space left on device"), True),
        (OSError(errno.EDQUOT, "Disk quota exceeded"), True),
        (FileNotFoundError(errno.ENOENT, "No usable temporary directory found"), True),
        (OSError(errno.ENOSPC, "No space left on device", "/tmp/rulec-abc"), True),
        (OSError(errno.ENOENT, "No such file or directory", "cc"), False),
        (OSError(errno.EAGAIN, "Resource temporarily unavailable"), False),
    ],
)
def test_only_what_is_about_temporary_files_is_said_of_them(problem, is_ours):
    with pytest.raises(rulec.RulecError if is_ours else OSError) as caught, temporary_files():
        raise problem
    assert (caught.value is problem) is not is_ours


@needs_a_compiler
def test_too_many_objects_are_refused():
    names = [f"v{n}" for n in range(4097)]
    states = ({"position": dict.fromkeys(names, "b")},)
    crowd = rulec.Trace("t", 1, dict.fromkeys(names, "vehicle"), states)
    (found,) = rulec.verify_many([crowd], "esterle2019", engine="c")
    (diagnostic,) = found.error.diagnostics
    assert (diagnostic.code, 'engine="python"' in diagnostic.help) == ("R0750", True)


def test_it_is_for_traces(tmp_path, capsys):
    assert main(["verify", "docs/samples", "-r", "esterle2019", "--engine", "c"]) == 2
    assert "--engine c is for traces" in capsys.readouterr().err


@needs_a_compiler
def test_a_step_that_fits_no_bound_is_left_to_python():
    book = rulec.parse_rulebook(
        "rulebook a signal p default false hard rule r { require always eventually[<= 1 s] p }"
    )
    traces = [rulec.Trace("t", step, {}, ({"p": True},)) for step in (0.5, 0.3)]
    assert [one.engine for one in rulec.verify_many(traces, book, engine="c")] == ["c", "python"]
