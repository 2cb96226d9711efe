"""``rulec new`` as its user meets it."""

from datetime import date

import pytest

from rulec.cli.main import main
from rulec.rulebook.reading.rulebook_reader import load_rulebook
from rulec.rulebook.template import new_rulebook


def test_what_it_writes_checks_tests_and_compiles(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "atlantis"]) == 0
    assert capsys.readouterr().out == "wrote atlantis.rules; next: rulec test ./atlantis.rules\n"
    assert main(["check", "./atlantis.rules", "--fail-on", "warning"]) == 0
    assert main(["test", "./atlantis.rules"]) == 0
    assert "3 examples passed" in capsys.readouterr().out
    assert main(["compile", "./atlantis.rules", "-o", "out"]) == 0
    assert main(["maneuvers", "s1", "--rulebook", "./atlantis.rules"]) == 0


def test_a_folder_is_made(tmp_path, capsys):
    assert main(["new", "atlantis", "-o", str(tmp_path / "law" / "at")]) == 0
    assert (tmp_path / "law" / "at" / "atlantis.rules").exists()
    assert f"rulec test {tmp_path}/law/at/atlantis.rules" in capsys.readouterr().out


def test_a_file_that_is_there_stays(tmp_path, capsys):
    file = tmp_path / "atlantis.rules"
    file.write_text("mine")
    assert main(["new", "atlantis", "-o", str(tmp_path)]) == 2
    assert "the file is there already" in capsys.readouterr().err
    assert file.read_text() == "mine"


@pytest.mark.parametrize("name", ["two words", "1st", "", "../up", "a--b", "x\ny"])
def test_a_name_that_no_rulebook_can_have(name, tmp_path, capsys):
    assert main(["new", name, "-o", str(tmp_path / "out")]) == 2
    assert "error[R0738]" in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_the_law_is_that_of_today():
    assert "as of 2026-11-20" in new_rulebook("a", date(2026, 11, 20))


def test_a_rulebook_upon_another_one(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "atlantis", "--extends", "esterle2019"]) == 0
    assert main(["check", "./atlantis.rules", "--fail-on", "warning"]) == 0
    assert main(["test", "./atlantis.rules"]) == 0
    text = (tmp_path / "atlantis.rules").read_text()
    assert "#   other: R1, R2, R3\n" in text
    # Every line of a kind that it proposes can be taken as it is.
    proposals = [line[2:] for line in text.splitlines() if " rule R1" in line]
    assert [line.split()[0] for line in proposals] == ["override", "drop", "soften"]
    for proposal in proposals:
        (tmp_path / "atlantis.rules").write_text(f"{text}{proposal}\n")
        status = main(["test", "./atlantis.rules"])
        # R1 is told to be soft or gone, and stays as it is with another article.
        assert status == 0, proposal
    capsys.readouterr()


def test_a_rulebook_upon_a_treaty_is_short(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "atlantis", "--extends", "vienna"]) == 0
    lines = (tmp_path / "atlantis.rules").read_text().splitlines()
    assert len(lines) <= 80
    told = '# set strict_crossings = off cite "…"  # Art. 11(9): no overtaking at crossings at all'
    assert told in lines
    # Numbers by which a schema is tuned are no law.
    assert not any("standstill_memory" in line for line in lines)
    named = " ".join(line.lstrip("# ") for line in lines).replace(",", " ").split()
    assert {rule.name for rule in load_rulebook("vienna").rules} <= {*named}


def test_a_base_beside_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "base"]) == 0
    assert main(["new", "upon", "--extends", "base"]) == 0
    assert "# traffic left" in (tmp_path / "upon.rules").read_text()
    assert main(["test", "./upon.rules"]) == 0


def test_a_base_that_is_not_there(tmp_path, capsys):
    assert main(["new", "atlantis", "--extends", "esterle209", "-o", str(tmp_path)]) == 2
    assert "did you mean `esterle2019`?" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_base_by_its_path(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "upon", "--extends", "./base.rules"]) == 2
    assert "--extends takes a name, such as `base`" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_name_with_the_end_of_its_file(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    assert main(["new", "atlantis.rules"]) == 0
    assert capsys.readouterr().out.startswith("wrote atlantis.rules;")
    assert "rulebook atlantis\n" in (tmp_path / "atlantis.rules").read_text()


def test_what_can_be_set_of_a_base(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "above.rules").write_text(
        "rulebook above\nuse road\noption strict = off  # Art. 3\n"
        "param pace : speed = 7 km/h in force until 2000-01-01\n"
        "# How fast one walks.\n"
        "param pace : speed = 8 km/h in force from 2000-01-02\n"
        "param room : length = 1 m if built_up else 2 m\n"
        "hard rule A { require never (strict and speed > pace) }\n"
    )
    (tmp_path / "base.rules").write_text("rulebook base\nextends above\nset strict = on\n")
    assert main(["new", "upon", "--extends", "base"]) == 0
    text = (tmp_path / "upon.rules").read_text()
    lines = [line for line in text.splitlines() if line.startswith("# set")]
    assert lines == ['# set strict = on cite "…"  # Art. 3']
    (tmp_path / "upon.rules").write_text(text.replace("# set", "set"))
    assert main(["check", "./upon.rules"]) == 0
