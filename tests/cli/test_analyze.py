"""``rulec analyze``."""

import json

import pytest

from rulec.cli.main import main

TWO = """\
rulebook two
signal wet, slow default false
hard rule caution { require always (wet implies next slow) }
hard rule flow { require never (wet and next slow) }
"""

NESTED = """\
rulebook nested
type car
signal near(c: car, d: car) default false
hard rule r { require never (some c: car (some d: car (near(c, d)))) }
"""


@pytest.fixture(autouse=True)
def books(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "two.rules").write_text(TWO)
    (tmp_path / "nested.rules").write_text(NESTED)
    (tmp_path / "one.rules").write_text(TWO[: TWO.index("hard rule flow")])


def test_a_conflict(capsys):
    assert main(["analyze", "./two.rules"]) == 1
    assert (
        capsys.readouterr().out
        == """\
error[R0804]: rules `caution` and `flow` cannot both be kept after some trace; each alone could
 --> two.rules:4:1
  |
3 | hard rule caution { require always (wet implies next slow) }
  | ------------------------------------------------------------ `caution` is here
4 | hard rule flow { require never (wet and next slow) }
  | ^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^^
  = help: give one of them an exception for what another one demands, or make it soft
  = note: after the trace: { wet }

1 error
"""
    )


def test_nothing_found(capsys):
    assert main(["analyze", "./one.rules", "esterle2019"]) == 0
    assert capsys.readouterr().out == "2 rulebooks, nothing found\n"


def test_formats(capsys):
    assert main(["analyze", "./two.rules", "--output-format", "json"]) == 1
    (found,) = json.loads(capsys.readouterr().out)
    assert found["code"] == "R0804"
    assert main(["analyze", "./two.rules", "--output-format", "concise"]) == 1
    assert capsys.readouterr().out.startswith("two.rules:4:1: R0804 rules `caution` and `flow`")


def test_what_is_not_decided_is_not_answered(capsys):
    assert main(["analyze", "./nested.rules"]) == 2
    assert (
        "[R0807]: undecided for rule `r` whether it can be kept and violated"
        in capsys.readouterr().out
    )


def test_warnings_fail_if_asked(tmp_path):
    text = "rulebook idle\nsignal wet\nhard rule r { require always (wet or not wet) }\n"
    (tmp_path / "idle.rules").write_text(text)
    assert main(["analyze", "./idle.rules"]) == 0
    assert main(["analyze", "./idle.rules", "--fail-on", "warning"]) == 1


def test_one_that_cannot_be_read_does_not_stop_the_others(capsys):
    assert main(["analyze", "./none.rules", "./two.rules"]) == 2
    out, err = capsys.readouterr()
    assert "R0804" in out
    assert "none.rules" in err


def test_compiled_rulebooks_do_not_say_enough(capsys):
    assert main(["analyze", "two.json"]) == 2
    assert "give its source" in capsys.readouterr().err
