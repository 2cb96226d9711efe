"""``rulec compile`` as its user meets it."""

import os
from pathlib import Path

import pytest

from rulec.cli.main import main
from support.oracles.installed_spot import spot


def test_files_and_their_contents(tmp_path, capsys):
    folder = tmp_path / "out"
    assert main(["compile", "esterle2019", "-o", str(folder)]) == 0
    names = ["R1.hoa", "R2.hoa", "R3.hoa", "esterle2019.json"]
    assert sorted(path.name for path in folder.iterdir()) == names
    assert capsys.readouterr().out.splitlines() == [f"wrote {folder / name}" for name in names]
    hoa = (folder / "R1.hoa").read_text()
    assert hoa.startswith("HOA: v1\n")
    assert "/* hard rule R1 of esterle2019, Article 11.1, 11.6 */" in hoa
    automaton = spot.automaton(str(folder / "R1.hoa"))
    assert automaton.get_name() == "R1"
    assert {ap.ap_name() for ap in automaton.ap()} == {"CONGESTED", "b(v)", "r(v)", "f(v)"}


def test_a_rulebook_with_mistakes_writes_nothing(tmp_path, capsys):
    source = tmp_path / "bad.rules"
    source.write_text("rulebook bad\nuse paper\nhard rule A { require always CONGSTED }\n")
    assert main(["compile", str(source), "-o", str(tmp_path / "out")]) == 2
    assert not (tmp_path / "out").exists()
    assert "CONGESTED" in capsys.readouterr().err


def test_an_example_that_comes_out_otherwise_is_a_warning(tmp_path, capsys):
    source = tmp_path / "odd.rules"
    source.write_text(
        "rulebook odd\nuse paper\n"
        "hard rule A (v: vehicle) {\n"
        "  require always not r(v)\n"
        "  accept { b(v); l(v) }\n"
        "  accept { b(v); r(v) }\n"
        "  reject { b(v); l(v) }\n"
        "}\n"
    )
    assert main(["compile", str(source), "-o", str(tmp_path / "out")]) == 0
    err = capsys.readouterr().err
    assert "example number 2 of rule `A` says `accept`, but the rule rejects it" in err
    assert "example number 3 of rule `A` says `reject`, but the rule accepts it" in err
    assert "number 1" not in err
    assert err.count("warning[R0406]") == 2


UNTILS = " xor ".join(f"(s{i} until s{i + 1})" for i in range(0, 16, 2))
WIDE = " or ".join(f"s{i}" for i in range(17))  # refused without trying


@pytest.mark.parametrize(
    "formula", [WIDE, pytest.param(UNTILS, marks=pytest.mark.long)], ids=["letters", "time"]
)
def test_a_rule_that_explodes(formula, tmp_path, capsys):
    atoms = ", ".join(f"s{i}" for i in range(17))
    source = tmp_path / "boom.rules"
    source.write_text(f"rulebook boom\nsignal {atoms}\nhard rule Boom {{ require {formula} }}\n")
    assert main(["compile", str(source), "-o", str(tmp_path / "out")]) == 2
    assert not (tmp_path / "out").exists()
    assert "rule `Boom` would be too large" in capsys.readouterr().err


def test_a_folder_is_not_named_as_one_of_its_files(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    for name in ("law.json", "law.c"):
        assert main(["compile", "esterle2019", "-o", name]) == 2
        assert "write `-o law`" in capsys.readouterr().err
    Path("law.json").mkdir()
    assert main(["compile", "esterle2019", "-o", "law.json"]) == 0
    assert [path.name for path in Path().iterdir()] == ["law.json"]


@pytest.mark.parametrize(
    ("folder", "why", "way_out"),
    [
        ("notes", "a file of this name is there, where a folder is wanted", "name another folder"),
        ("notes/law", "what stands before a `/` in its name is a file", "name another folder"),
        ("shut/law", "permission denied", "change its permissions"),
    ],
)
def test_a_folder_that_cannot_be_is_refused_before_anything_is_compiled(
    folder, why, way_out, tmp_path, monkeypatch, capsys
):
    monkeypatch.chdir(tmp_path)
    Path("notes").touch()
    Path("shut").mkdir(0o500)
    # Who may do all things, as in a container, may write there, too.
    monkeypatch.setattr(os, "access", lambda path, _: Path(path) != Path("shut"))
    assert main(["compile", "no_such_book", "-o", folder]) == 2
    err = capsys.readouterr().err
    assert f"error[R0702]: the file cannot be written: {why}" in err
    assert way_out in err
    assert "R0703" not in err
    assert not any(Path("shut").iterdir())


def test_a_rule_that_is_too_large_for_a_step_says_for_which(tmp_path, capsys):
    source = tmp_path / "long.rules"
    source.write_text(
        "rulebook long\nsignal p, q\n"
        "hard rule wait { require always (p implies eventually[<= 200 s] q) }\n"
    )
    assert main(["compile", str(source), "-o", str(tmp_path / "out"), "--step", "0.01"]) == 2
    err = capsys.readouterr().err
    assert "one of its bounds has more than 10,000 steps for steps of 0.01 s\n" in err
    assert "longer steps are fewer: of a recording every fifth state may do\n" in err
