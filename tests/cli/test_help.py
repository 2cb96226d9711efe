"""``rulec`` alone, ``rulec help``, ``rulec help --man`` and colour on demand."""

import os
import re

import pytest

from rulec.cli.main import main
from rulec.cli.verb_table import COMMANDS, VERB_GROUPS


def run(capsys, *arguments):
    status = main(list(arguments))
    return status, *capsys.readouterr()


def test_without_a_verb_there_is_help_in_groups(capsys):
    status, out, err = run(capsys)
    assert (status, err) == (0, "")
    assert out == run(capsys, "--help")[1] == run(capsys, "help")[1]
    shown = [out.index(f"{title}:") for title in VERB_GROUPS]
    assert shown == sorted(shown)
    for (title, verbs), start, end in zip(
        VERB_GROUPS.items(), shown, [*shown[1:], len(out)], strict=True
    ):
        assert re.findall(r"^  (\S+) ", out[start:end], re.M)[: len(verbs)] == [*verbs], title


@pytest.mark.parametrize("words", [["verify"], ["draw"], ["draw", "drive"]])
def test_help_of_a_verb_is_what_the_verb_says(words, capsys):
    status, out, _ = run(capsys, "help", *words)
    assert status == 0
    assert out == run(capsys, *words, "--help")[1]


def test_a_group_alone_shows_its_help(capsys):
    assert run(capsys, "draw") == run(capsys, "help", "draw")


@pytest.mark.parametrize(
    ("words", "way_out"),
    [
        (["chekc"], "did you mean `check`?"),
        (["draw", "drvie"], "did you mean `drive`?"),
        (["qqqq"], "`rulec help` lists them"),
        (["r0207"], "`rulec explain r0207` explains it"),
        (["zebra"], "`rulec explain zebra` explains it"),
        (["schemas_of_all"], "`rulec help` lists them"),
    ],
)
def test_help_of_what_is_not_there(words, way_out, capsys):
    status, out, err = run(capsys, "help", *words)
    assert (status, out) == (2, "")
    assert err.splitlines()[0] == f"error: there is no command `{words[-1]}`; {way_out}"


def test_the_short_option_for_the_version(capsys):
    assert run(capsys, "-V") == run(capsys, "--version")


def test_misuse_looks_like_other_mistakes(capsys):
    status, out, err = run(capsys, "explain", "R9999x")
    assert (status, out) == (2, "")
    first, usage, way_out = err.splitlines()
    assert first.startswith("error: there is no code and no word `R9999x`")
    assert usage == "  = usage: rulec explain [OPTIONS] [CODE|WORD]... [FILE]..."
    assert way_out == "  = help: `rulec help explain` says more"


def test_the_manual_page_has_every_verb_and_option(capsys):
    status, page, _ = run(capsys, "help", "--man")
    assert status == 0
    assert page.startswith('.TH RULEC 1 "" "rulec ')
    for verb in COMMANDS:
        assert f'.SS "rulec {verb} '.replace("-", r"\-") in page
    assert r".B \-\-fail\-on\-empty" in page
    assert '.SS "rulec draw drive ' in page
    # Nothing but requests begins with a full stop, and what looks like one is made harmless.
    assert {line.split()[0] for line in page.splitlines() if line.startswith(".")} == {
        *(".TH", ".SH", ".SS", ".B", ".TP", ".PP", ".nf", ".fi")
    }


def test_the_manual_page_as_a_file(tmp_path, capsys):
    assert run(capsys, "help", "--man", "-o", str(tmp_path / "rulec.1"))[0] == 0
    assert (tmp_path / "rulec.1").read_text() == run(capsys, "help", "--man")[1]


@pytest.mark.parametrize(
    "arguments", [["--color", "always", "check"], ["check", "--color", "always"]]
)
def test_colour_in_a_pipe_where_it_is_asked_for(arguments, capsys, monkeypatch):
    monkeypatch.setenv("NO_COLOR", "1")
    plain = run(capsys, "check", "nothing_such")[2]
    assert "\x1b" not in plain
    colored = run(capsys, *arguments, "nothing_such")[2]
    assert re.sub("\x1b\\[[0-9;]*m", "", colored) == plain != colored
    # It was for that command alone.
    assert (os.environ["NO_COLOR"], os.environ.get("FORCE_COLOR")) == ("1", None)


def test_what_is_said_last_counts_and_the_environment_is_asked_without_it(capsys, monkeypatch):
    monkeypatch.delenv("NO_COLOR", raising=False)
    monkeypatch.setenv("FORCE_COLOR", "1")
    assert "\x1b" in run(capsys, "check", "nothing_such")[2]
    for choice in ("never", "auto"):
        assert (
            "\x1b"
            not in run(capsys, "--color", "always", "check", "nothing_such", "--color", choice)[2]
        )
