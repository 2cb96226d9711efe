"""Walking a folder that others wrote: what is taken, left alone, and refused."""

import os
import socket
from pathlib import Path

import pytest

from rulec.cli.main import main
from rulec.files.source_detection import is_foreign
from rulec.rulebook.files.source_walk import sources_below

BOOK = "rulebook a\nsignal p\nhard rule r { require always p }\n"
SECRET = "DEPLOY_KEY=hunter2"


@pytest.fixture
def tree(tmp_path, monkeypatch):
    (tmp_path / "tree").mkdir()
    monkeypatch.chdir(tmp_path / "tree")
    Path("a.rules").write_text(BOOK)
    return tmp_path


def write(path, text=BOOK):
    Path(path).parent.mkdir(parents=True, exist_ok=True)
    Path(path).write_bytes(text if isinstance(text, bytes) else text.encode())


def found():
    walked = sources_below(".")
    left = {one.path: one.why for one in walked.left_alone}
    return [str(path) for path in walked.paths], left, [one.code for one in walked.refused]


def test_folders_without_end_are_left_alone_and_named(tree):
    """Python's own walk takes a call for each level, and as many calls are a mistake of its own."""
    deep = "/".join("d" * 250)
    write(f"{deep}/b.rules")
    write("d/d/c.rules")
    sources, left, refused = found()
    assert (sources, refused) == (["a.rules", "d/d/c.rules"], [])
    assert left == {"/".join("d" * 201): "too deep"}


def test_what_cannot_be_asked_of_a_folder_keeps_nobody_from_the_others(tree):
    """As where one may not enter it; root may, so its whole path is too long for the system."""
    folder = "/".join(["d" * 250] * 8)
    for _ in range(2):
        write(f"{folder}/b.rules")
        os.chdir(folder)
    Path("d" * 60).mkdir()
    os.chdir(tree / "tree")
    assert found()[0][0] == "a.rules"


def test_environments_hidden_folders_and_what_git_ignores_are_left_alone(tree):
    folders = ["venv", "node_modules", "env", ".venv", "out", "kept", "x/site-packages"]
    for folder in folders:
        write(f"{folder}/b.rules")
    write("env/pyvenv.cfg", "")
    write(".gitignore", "/out/\nignored.rules\n")
    write("kept/ignored.rules")
    assert found() == (
        ["a.rules", "kept/b.rules"],
        {
            "env": "an environment",
            "node_modules": "an environment",
            "out": "ignored by git",
            "venv": "an environment",
            "x/site-packages": "an environment",
            "kept/ignored.rules": "ignored by git",
        },
        [],
    )


@pytest.mark.parametrize(
    "text",
    [
        *(
            "package x\nrule y",
            'ACTION=="add"',
            "*filter",
            "# c\nalert tcp",
            "{}",
            b"\xff\xfe\x00h",
        ),
        *("notebook x", "rules:", "'rulebook'", "\x7fELF", "// rulebook", b"\0"),
    ],
)
def test_other_programs_files_are_left_alone(text, tree, capsys):
    write("other.rules", text)
    assert found() == (["a.rules"], {"other.rules": "no rulebook and no vocabulary"}, [])
    assert main(["fmt", "--check"]) == 0
    said = "left alone: 1 no rulebook and no vocabulary (other.rules)\n"
    assert capsys.readouterr().err.endswith(said)
    # Who names it means it.
    assert main(["check", "other.rules"]) == 1
    assert "error[R01" in capsys.readouterr().out


@pytest.mark.parametrize(
    "text",
    [
        *("rulbook a", "ruelbook a", "Rulebook a", "# x\n\n vocabluary w {}", "", "# to do", "\n"),
        *(BOOK.encode("utf-16"), b"\xef\xbb\xbfrulebook a", b"rulebook \xff", "vocabulary"),
    ],
)
def test_what_is_misspelt_or_begun_is_not(text, tree):
    write("b.rules", text)
    assert found() == (["a.rules", "b.rules"], {}, [])


def test_nothing_left_is_not_answered(tree, capsys):
    write("a.rules", "package x")
    for verb in (["check", "."], ["fmt", "--check", "."], ["fmt", "."]):
        assert main(verb) == 2
        err = capsys.readouterr().err
        assert "error[R0733]" in err
        assert "left alone: 1 no rulebook and no vocabulary (a.rules)" in err


def test_each_thing_left_alone_is_named_on_request(tree, capsys):
    for n in range(5):
        write(f"venv{n}/pyvenv.cfg", "")
    assert main(["check", "."]) == 0
    assert "5 an environment (venv0, venv1, venv2, …)" in capsys.readouterr().err
    assert main(["check", ".", "--verbose"]) == 0
    err = capsys.readouterr().err
    assert [f"left alone: venv{n}: an environment" for n in range(5)] == err.splitlines()


def test_links_out_pipes_and_sockets_are_refused_and_the_rest_goes_on(tree, capsys):
    write("../secret", SECRET)
    Path("b.rules").symlink_to("../secret")
    Path("c.rules").symlink_to("a.rules")
    Path("d.rules").symlink_to("/proc/self/environ")
    os.mkfifo("e.rules")
    with socket.socket(socket.AF_UNIX) as listening:
        listening.bind("f.rules")
    Path("inner").symlink_to("..")
    codes = ["R0730", "R0730", "R0731", "R0731"]
    assert found() == (["a.rules", "c.rules"], {"inner": "a link to a folder"}, codes)
    for verb in (["check", "."], ["fmt", "--check", "."], ["fmt", "."]):
        assert main(verb) == 2
        out, err = capsys.readouterr()
        assert [err.count(f"error[{code}]") for code in ("R0730", "R0731")] == [2, 2]
        assert "hunter2" not in out + err
    assert Path("../secret").read_text() == SECRET
    assert main(["list"]) == 0  # neither hangs at the pipe


def test_nothing_is_written_behind_a_link(tree):
    write("../victim.rules", BOOK.replace("\n", "  \n"))
    Path("v.rules").symlink_to("../victim.rules")
    for arguments in (["."], ["v.rules"], ["./v.rules"]):
        assert main(["fmt", *arguments]) == 2
    assert Path("../victim.rules").read_text() != BOOK


@pytest.mark.parametrize("secret", [SECRET, "title hunter2\n", f"{SECRET}\0x", f"{SECRET}\xff"])
def test_no_line_of_a_file_that_is_no_source_is_shown(secret, tree, capsys):
    write("b.rules", secret.encode("latin-1"))
    write("c.rules", "rulebook c\nextends b\n")
    write("d.rules", "rulebook d\nuse b\nhard rule r { require always p }\n")
    arguments = ["./b.rules"], ["./c.rules"], ["./d.rules"]
    for form in ("full", "json", "sarif", "github", "concise"):
        for argument in arguments:
            main(["check", *argument, "--output-format", form])
    for verb in (["fmt"], ["test"], ["show"], ["show", "--tree"], ["show", "--audit"]):
        main([*verb, "./b.rules"])
    out, err = capsys.readouterr()
    assert "hunter2" not in out + err
    assert "b.rules" in out


def test_telling_sources_from_other_files_takes_few_steps():
    assert is_foreign("#" * 60_000 + "\n" + " " * 60_000 + "?")
    assert not is_foreign("# \n" * 20_000)
