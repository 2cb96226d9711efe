"""What newcomers get wrong, and the way out that they are shown."""

import json
import sys
from importlib import metadata

import pytest

from rulec.cli.main import main
from rulec.diagnostics.install_command import install_command


def said(capsys, *arguments):
    status = main(list(arguments))
    captured = capsys.readouterr()
    return status, captured.out + captured.err


@pytest.mark.parametrize(
    ("rules", "way_out"),
    [
        (
            "use road\nhard rule r (v: vehicle) { require never standing(v) }",
            "it is defined in the rulebook `schemas`: `extends schemas`, or copy it",
        ),
        (
            "use paper\nhard rule r { require always speed < 50 km/h }",
            "it is a word of the vocabulary `road`: `use road`",
        ),
        (
            "signal p\nhard rule keep right { require always p }",
            "a name is one word: `keep_right`",
        ),
        ("extends germany", "did you mean `de` (Germany)?"),
    ],
)
def test_in_a_rulebook(rules, way_out, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.rules").write_text(f"rulebook mine\n{rules}\n")
    status, text = said(capsys, "check", "./mine.rules")
    assert (status, text.count("  = help: ")) == (1, 1)
    assert f"  = help: {way_out}\n" in text


@pytest.mark.parametrize(
    ("arguments", "way_out"),
    [
        (["show", "germany"], "  = help: did you mean `de` (Germany)?"),
        (["verify", "x"], "  = help: `rulec list rulebooks` shows which there are, such as `de`"),
        (["explain", "speed"], "it is a word of the vocabulary `road`"),
        (["new", "Belgium 2"], "  = help: such as `belgium_2`"),
        (
            ["maneuvers", "s1", "-r", "esterle2019", "--step", "0.307692"],
            "a step of 0.25 s or 0.4 s",
        ),
    ],
)
def test_in_a_command(arguments, way_out, capsys):
    status, text = said(capsys, *arguments)
    assert status == 2
    assert way_out in text


def test_a_trace_in_the_words_of_another_vocabulary(tmp_path, capsys):
    trace = tmp_path / "t.jsonl"
    trace.write_text(
        json.dumps({"states": [{"position": {"v": "b"}}], "objects": {"v": "vehicle"}})
    )
    status, text = said(capsys, "verify", str(trace), "-r", "un-r79")
    assert status == 2
    assert "it is a word of the vocabulary `paper`: judge by a rulebook that uses that" in text


@pytest.mark.parametrize(
    ("origin", "has_pip", "command"),
    [
        (None, True, "PYTHON -m pip install 'rulec[rates]'"),
        (None, False, "uv pip install --python PYTHON 'rulec[rates]'"),
        (
            {"url": "file:///a%20b/rulec", "dir_info": {"editable": True}},
            True,
            "PYTHON -m pip install -e '/a b/rulec[rates]'",
        ),
        (
            {"url": "file:///tmp/rulec-1.whl", "archive_info": {}},
            True,
            "PYTHON -m pip install '/tmp/rulec-1.whl[rates]'",
        ),
        ({"url": "https://example.com/rulec"}, True, "PYTHON -m pip install 'rulec[rates]'"),
    ],
)
def test_an_extra_is_installed_where_rulec_runs(origin, has_pip, command, monkeypatch):
    class Installed:
        def read_text(self, name):
            return None if origin is None else json.dumps(origin)

    monkeypatch.setattr(metadata, "distribution", lambda name: Installed())
    monkeypatch.setattr("importlib.util.find_spec", lambda name: object() if has_pip else None)
    monkeypatch.setattr(sys, "executable", "PYTHON")
    install_command.cache_clear()
    try:
        assert install_command("rates") == command
    finally:
        install_command.cache_clear()
