"""``rulec compile`` as its user meets it."""

import json
import os
from fractions import Fraction
from pathlib import Path

import pytest

from rulec import Monitor, RulecError, compile_rulebook
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


def test_an_heir_of_another_step_is_compiled_for_one_step(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    soon = "require always (p implies eventually[<= {} s] q)"
    Path("base.rules").write_text(
        f"rulebook base\nsignal p, q\nhard rule r {{ {soon.format(2)} }}\n"
    )
    Path("heir.rules").write_text(
        f"rulebook heir\nextends base\nstep 0.5 s\nhard rule s {{ {soon.format(1)} }}\n"
    )
    for emit in ("automata", "c", "ltl"):
        assert main(["compile", "./heir.rules", "--emit", emit, "-o", emit]) == 0
    said = "for states 0.5 s apart, as 2 rules have bounds in seconds; `--step` says else\n"
    assert capsys.readouterr().err.count(said) == 2
    assert "STEP_S (0.5)" in Path("c/heir.h").read_text()
    # Within 2 s is within four states, within 1 s within two.
    assert Path("ltl/heir.csv").read_text().count("X ") == 4 + 2
    states = [{"p": number == 0, "q": number == 3} for number in range(5)]
    Path("t.jsonl").write_text(json.dumps({"id": "t", "step_s": 0.5, "states": states}))
    assert main(["verify", "t.jsonl", "-r", "automata/heir.json", "--explain", "0"]) == 1
    assert "hard rule s:" in (out := capsys.readouterr().out)
    assert "hard rule r:" not in out
    assert Monitor(compile_rulebook("./heir.rules")).step_s == Fraction(1, 2)


@pytest.mark.parametrize(
    ("options", "why"),
    [
        (["--prove"], "--prove is about monitors in C and Rust: add `--emit c`"),
        (["--emit", "ltl", "--objects", "vehicle=4"], "--objects is about monitors in C and Rust"),
        (["--emit", "c", "--no-certificate"], "--no-certificate is about the compiled rulebook"),
    ],
)
def test_an_option_without_effect_is_refused(options, why, tmp_path, capsys):
    assert main(["compile", "esterle2019", "-o", str(tmp_path / "out"), *options]) == 2
    assert why in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_automata_that_are_not_of_the_rulebook_are_named(tmp_path, capsys):
    (tmp_path / "R0.hoa").write_text("of a rule that there was\n")
    assert main(["compile", "esterle2019", "-o", str(tmp_path)]) == 0
    said = f"in {tmp_path} stay automata of another rulebook or from before: `R0.hoa`\n"
    assert capsys.readouterr().err == said
    assert (tmp_path / "R0.hoa").exists()


def test_automata_of_another_rulebook_that_are_replaced_are_named(tmp_path, capsys):
    for name, sign in (("one", "p"), ("two", "not p")):
        (tmp_path / f"{name}.rules").write_text(
            f"rulebook {name}\nsignal p\nhard rule r {{ require always {sign} }}\n"
        )
    build = tmp_path / "build"

    def said(name):
        assert main(["compile", str(tmp_path / f"{name}.rules"), "-o", str(build)]) == 0
        return capsys.readouterr().err

    assert said("one") == said("one") == ""
    replaced = f"in {build} automata of another rulebook (`one.rules`) were replaced: `r.hoa`; "
    assert said("two") == f"{replaced}give each rulebook a folder of its own\n"


@pytest.mark.parametrize(
    ("emit", "replaced"),
    [
        ("automata", "automata of another rulebook or from before: `r1.hoa`"),
        ("automata", "files of another rulebook (`one.rules`) were replaced: `same.json`; "),
        ("c", "files of another rulebook (`one.rules`) were replaced: `same.c`; "),
        ("rust", "files of another rulebook (`one.rules`) were replaced: `src/lib.rs`; "),
        ("ros2", "files of another rulebook (`one.rules`) were replaced: `src/same.c`; "),
        ("ltl", "files of another rulebook (`one.rules`) were replaced: `same.propositions.json`"),
    ],
)
def test_files_of_another_rulebook_of_the_same_name_are_not_replaced_silently(
    emit, replaced, tmp_path, capsys
):
    for number, name in enumerate(("one", "two"), 1):
        (tmp_path / f"{name}.rules").write_text(
            f"rulebook same\nsignal p default false\nhard rule r{number} {{ require never p }}\n"
        )
    command = "compile", "--emit", emit, "-o", str(tmp_path / "build")
    for name in ("one", "one"):
        assert main([*command, str(tmp_path / f"{name}.rules")]) == 0
        assert capsys.readouterr().err == ""
    assert main([*command, str(tmp_path / "two.rules")]) == 0
    assert replaced in capsys.readouterr().err


@pytest.mark.parametrize(
    ("emit", "file"), [("c", "Makefile"), ("c", "CMakeLists.txt"), ("rust", "src/lib.rs")]
)
def test_build_files_of_others_stay(emit, file, tmp_path, capsys):
    own = tmp_path / file
    command = ["compile", "esterle2019", "--emit", emit, "-o", str(tmp_path)]
    assert main(command) == 0
    assert main(command) == 0
    capsys.readouterr()
    # Another monitor's, and one that rulec has not written
    for content in (own.read_text().replace("esterle2019", "other"), "all: mine\n"):
        own.write_text(content)
        assert main(command) == 2
        assert "error[R0755]: the file is there already, and was" in capsys.readouterr().err
        assert own.read_text() == content


def test_a_compiled_rulebook_is_refused_for_another_day(tmp_path, capsys):
    (tmp_path / "d.rules").write_text(
        "rulebook d\nsignal p\nhard rule r { require always p in force until 2021-12-31 }\n"
        "hard rule s { require always p }\n"
    )
    build = ["compile", str(tmp_path / "d.rules"), "--at", "2020-01-01", "-o", str(tmp_path)]
    assert main(build) == 0
    file = str(tmp_path / "d.json")
    for command in (["show", file], ["compile", file, "--emit", "c", "-o", str(tmp_path / "c")]):
        assert main([*command, "--at", "2020-01-01"]) == 0
        assert main(command) == 0
        assert main([*command, "--at", "2024-01-01"]) == 2
        assert "for the law of 2020-01-01, not of 2024-01-01" in capsys.readouterr().err
    with pytest.raises(RulecError, match="R0419"):
        compile_rulebook(file, at="2024-01-01")


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
        ("notes/law", "a part of its path before a `/` is a file", "name another folder"),
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
    assert "for a recording, every fifth state may be enough\n" in err


@pytest.mark.parametrize(
    ("arguments", "read"),
    [
        (["a.json", "-o", "."], "a.json"),
        (["./a.json", "-o", "."], "a.json"),
        (["a.json", "-o", "../here"], "a.json"),
        (["a/a.json", "b.json", "-o", "."], "a/a.json"),
    ],
)
def test_a_compiled_rulebook_is_not_written_over_itself(
    arguments, read, tmp_path, monkeypatch, capsys
):
    """An answer never replaces a file that is read, however that is named."""
    (tmp_path / "here" / "a").mkdir(parents=True)
    monkeypatch.chdir(tmp_path / "here")
    for name in "ab":
        Path(f"{name}.rules").write_text(
            f"rulebook {name}\nsignal p default false\nhard rule r {{ require never p }}\n"
        )
        assert main(["compile", f"{name}.rules", "-o", "."]) == 0
    Path("a/a.json").write_bytes(Path("a.json").read_bytes())
    kept = Path(read).stat()
    capsys.readouterr()
    assert main(["compile", *arguments]) == 2
    assert "error[R0735]" in capsys.readouterr().err
    after = Path(read).stat()
    assert (after.st_ino, after.st_mtime_ns) == (kept.st_ino, kept.st_mtime_ns)
    # Whatever else is written replaces none.
    assert main(["compile", "a.json", "--emit", "c", "-o", "."]) == 0
    assert main(["compile", "a.json", "b.json", "-o", "elsewhere"]) == 0
