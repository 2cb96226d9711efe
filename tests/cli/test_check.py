"""``rulec check`` as its user meets it."""

import io
import json
import os
import subprocess
import sys
from hashlib import sha256
from pathlib import Path

import pytest

from rulec.cli.main import main
from rulec.resources import rulebooks_folder

BAD = Path(__file__).resolve().parents[1] / "programs" / "bad"
GOOD = "rulebook good\nuse paper\nhard rule r (v: vehicle) { require always not r(v) }\n"
WRONG = GOOD.replace("vehicle", "vehicel")
ODD = GOOD.replace("(v: vehicle)", "(v: vehicle, w: vehicle)")


@pytest.fixture
def folder(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    return tmp_path


def check(capsys, *arguments):
    status = main(["check", *arguments])
    return status, *capsys.readouterr()


def test_what_is_good(folder, capsys):
    (folder / "good.rules").write_text(GOOD)
    assert check(capsys, "good.rules") == (
        0,
        (
            "1 file checked, no mistakes found; `rulec test` runs the examples\n"
            "rule `r` cites no provision\nrule `r` has no example\n"
        ),
        "",
    )
    assert check(capsys, "esterle2019", "paper") == (
        0,
        "2 files checked, no mistakes found; `rulec test` runs the examples\n",
        "",
    )
    assert list(folder.iterdir()) == [folder / "good.rules"]


def test_what_is_wrong_is_shown_in_its_place(folder, capsys):
    (folder / "wrong.rules").write_text(WRONG)
    status, out, err = check(capsys, "wrong.rules")
    assert (status, err) == (1, "")
    assert out == (
        "error[R0201]: there is no type `vehicel`\n"
        " --> wrong.rules:3:17\n"
        "  |\n"
        "3 | hard rule r (v: vehicel) { require always not r(v) }\n"
        "  |                 ^^^^^^^ expected a type\n"
        "  = help: did you mean `vehicle`?\n"
        "\n"
        "1 error\n"
    )


def test_warnings_fail_only_if_asked_to(folder, capsys):
    (folder / "odd.rules").write_text(ODD)
    status, out, _ = check(capsys, "odd.rules", "--output-format", "concise")
    assert status == 0
    assert out == "odd.rules:3:26: R0207 the formula of `r` says nothing about `w`\n"
    assert check(capsys, "odd.rules", "--fail-on", "warning")[0] == 1


def test_a_folder_stands_for_the_files_in_it_and_below(folder, capsys):
    (folder / "inner" / ".hidden").mkdir(parents=True)
    for path in ("b.rules", "a.rules", "inner/c.rules", "inner/.hidden/d.rules", "e.txt"):
        (folder / path).write_text(WRONG)
    status, out, _ = check(capsys, ".", "a.rules", "--output-format", "concise")
    assert status == 1
    files = [line.partition(":")[0] for line in out.splitlines()]
    assert files == ["a.rules", "b.rules", "inner/c.rules"]


def test_a_vocabulary_that_several_use_is_complained_about_once(folder, capsys):
    (folder / "words.rules").write_text("vocabulary words {\n  signal p q\n}\n")
    for name in ("first", "second"):
        text = f"rulebook {name}\nuse words\nhard rule r {{ require always p }}\n"
        (folder / f"{name}.rules").write_text(text)
    status, out, _ = check(capsys, "first.rules", "second.rules", ".", "--output-format", "concise")
    assert status == 1
    assert [line.split()[:2] for line in out.splitlines()] == [["words.rules:2:12:", "R0104"]]


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["./none.rules"], "no such file"),
        (["esterle2018"], "did you mean `esterle2019`?"),
        (["nothing_like_it"], "available: `"),
        (["empty"], "no rulebook and no vocabulary in this folder"),
        (["a\0b.rules"], "cannot be read"),
        ([""], "there is no rulebook"),
        (["x*.rules"], "no rulebook and no vocabulary is called like that"),
        (["esterle2019", "--output-format", "xml"], "github, sarif"),
    ],
)
def test_what_cannot_be_answered(folder, capsys, arguments, words):
    (folder / "empty").mkdir()
    status, out, err = check(capsys, *arguments)
    assert (status, out) == (2, "")
    assert words in err


def test_a_missing_file_does_not_keep_the_others_from_being_checked(folder, capsys):
    (folder / "wrong.rules").write_text(WRONG)
    status, out, err = check(capsys, "none.rules", "wrong.rules", "--output-format", "concise")
    assert status == 2
    assert out.startswith("wrong.rules:3:17: R0201 ")
    assert "error[R0701]" in err


def test_standard_input_finds_its_vocabulary_in_the_working_directory(folder, capsys, monkeypatch):
    (folder / "mine.rules").write_text("vocabulary mine { signal p }\n")
    text = "rulebook a\nuse mine\nhard rule r { require p and q }\n"
    monkeypatch.setattr("sys.stdin", io.TextIOWrapper(io.BytesIO(text.encode())))
    status, out, _ = check(capsys, "-", "-", "--output-format", "concise")
    assert status == 1
    assert out == "standard input:3:29: R0202 nothing is called `q`\n"


@pytest.mark.parametrize("output_format", ["json", "sarif"])
def test_an_empty_answer_is_an_answer_for_machines(output_format, capsys):
    status, out, _ = check(capsys, "esterle2019", "--output-format", output_format)
    assert status == 0
    found = json.loads(out)
    assert (found if output_format == "json" else found["runs"][0]["results"]) == []


@pytest.mark.parametrize("output_format", ["concise", "github"])
def test_nothing_is_no_line(output_format, capsys):
    assert check(capsys, "esterle2019", "--output-format", output_format) == (0, "", "")


@pytest.mark.parametrize("output_format", ["full", "concise", "json", "github", "sarif"])
def test_all_bad_programs_in_every_format(output_format, capsys):
    status, out, err = check(capsys, str(BAD), "--output-format", output_format)
    assert status == 1
    assert err.startswith("left alone: 2 no rulebook and no vocabulary (")
    assert out.count("R0104") > 20


@pytest.mark.parametrize("arguments", [["list"], ["list", "codes"], ["explain", "--all"]])
def test_light_verbs_import_nothing_heavy(arguments):
    heavy = ["spot", "shapely", "networkx", "numpy", "rich", "rulec.monitoring", "rulec.automata"]
    assert imported(arguments).isdisjoint(heavy)


def test_check_neither_starts_spot_nor_imports_what_it_does_not_need():
    found = imported(["check", "esterle2019", "--no-cache"])
    heavy = ["spot", "shapely", "networkx", "numpy", "rich", "rulec.monitoring", "rulec.automata"]
    # Spot's process is started by rulec.automata alone.
    assert found.isdisjoint([*heavy, "msgspec"])
    assert "rulec.syntax.grammar" in found


def imported(arguments):
    program = (
        "import sys\nfrom rulec.cli.main import main\n"
        f"assert main({arguments!r}) == 0\nprint(*sys.modules, file=sys.stderr)\n"
    )
    done = subprocess.run(
        [sys.executable, "-c", program], capture_output=True, text=True, check=True, env=os.environ
    )
    return set(done.stderr.split())


def test_a_name_that_is_a_file_of_the_working_folder(capsys, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "mine.rules").write_text(
        "rulebook mine\nsignal p\nhard rule r { require always p }\n"
    )
    for verb in ("check", "show"):
        assert main([verb, "mine"]) == 2
        said = "".join(capsys.readouterr())
        assert "  = help: write `./mine.rules` for the file in the working folder\n" in said


def test_fixes_are_written_and_leave_nothing_to_say(capsys, tmp_path):
    path = tmp_path / "reach.rules"
    before = (
        "rulebook reach\nsignal p, q, r default false\n"
        "hard rule a { require p # first\n and q }\n"
        "hard rule b { require not (p or q) }\n"
        "hard rule c { require always (p implies never[<= 3 s] q and r) }\n"
        "hard rule d { require never p then q }\n"
        "hard rule e { require always p and q or never r }\n"
    )
    after = (
        "rulebook reach\nsignal p, q, r default false\n"
        "hard rule a { require always p # first\n and always q }\n"
        "hard rule b { require never (p or q) }\n"
        "hard rule c { require always (p implies never[<= 3 s] (q and r)) }\n"
        "hard rule d { require never (p then q) }\n"
        "hard rule e { require always (p and q) or never r }\n"
    )
    path.write_text(before)
    status, out, _ = check(capsys, str(path), "--output-format", "json")
    assert (status, [one["fix"] is not None for one in json.loads(out)]) == (0, [True] * 6)
    assert path.read_text() == before
    status, out, err = check(capsys, str(path), "--fix")
    assert (status, path.read_text()) == (0, after)
    assert (out, err) == (
        (
            "1 file checked, no mistakes found; `rulec test` runs the examples\n"
            "5 rules cite no provision: `a`, `b`, `c`, `d`, `e`\n"
            "5 rules have no example: `a`, `b`, `c`, `d`, `e`\n"
        ),
        f"6 fixes written to {path}\n",
    )
    assert check(capsys, "-", "--fix")[0] == 2


def test_what_means_nothing_is_left_out(capsys, tmp_path):
    path = tmp_path / "b.rules"
    before = (
        "rulebook b  # a\u202eb\nsignal p, q default false  # rulec: allow R0202 because of it\n"
        "define d = q  # later # rulec: allow R0208, R0207 because it comes\n"
        "hard rule r { require always p }\n"
    )
    path.write_text(before, "utf-8")
    status, out, err = check(capsys, str(path), "--fix")
    # While there are errors, it is not known which warnings there are
    assert (status, err) == (0, f"1 fix written to {path}\n")
    assert out.count("warning[R0219]") == 2
    status, out, err = check(capsys, str(path), "--fix")
    assert err == f"1 fix written to {path}\n"
    assert "there is no warning R0207 on this line" in out
    assert out.count("warning[") == 1
    without = before.replace("\u202e", "").replace("  # rulec: allow R0202 because of it", "")
    assert path.read_text("utf-8") == without


LOCKED = (
    "rulebook mine\nextends esterle2019\nuse paper\nhard rule r { require always not CONGESTED }\n"
)


def test_what_ships_is_locked_by_its_content(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rulec.toml").write_text("")
    (tmp_path / "laws").mkdir()
    (tmp_path / "laws/mine.rules").write_text(LOCKED)
    monkeypatch.chdir("laws")
    assert main(["check", "--lock"]) == 0
    locked = (tmp_path / "rulec.lock").read_text()
    names = [line.split('"')[1] for line in locked.splitlines() if line[0] == '"']
    assert names == ["esterle2019/esterle2019.rules", "vocabulary/paper.rules"]
    source = rulebooks_folder() / "vocabulary/paper.rules"
    assert f'"vocabulary/paper.rules" = "{sha256(source.read_bytes()).hexdigest()}"\n' in locked
    capsys.readouterr()
    assert main(["check"]) == 0
    (tmp_path / "rulec.lock").write_text(locked.replace('= "', '= "0') + '"none.rules" = "1"\n')
    capsys.readouterr()
    assert main(["check", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert [(one["code"], one["message"].split("`")[1]) for one in found] == [
        ("R0725", name) for name in (*names, "none.rules")
    ]


@pytest.mark.parametrize("text", ["de", '"../x" = "1"', "de = 1", '"/etc/passwd" = "1"'])
def test_a_lock_that_is_none(text, tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "rulec.lock").write_text(text)
    assert main(["check", "esterle2019"]) == 2
    assert "error[R0726]" in capsys.readouterr().err
